#include "host/io/masks_file.hpp"

#include <algorithm>

namespace pvg {

MasksFile::MasksFile(const std::filesystem::path& path, const Scene& scene, int width, int height)
    : n_pixels_(std::size_t(width) * std::size_t(height)), file_(hdf5::File::create(path)) {
  std::vector<std::string> instances = {"nothing"}, parts = {"nothing"};
  part_of_instance_ = {0};
  for (const Visual& visual : scene.visuals) {
    const std::string part = visual.part.empty() ? "other" : visual.part;
    auto found = std::find(parts.begin(), parts.end(), part);
    if (found == parts.end()) found = parts.insert(parts.end(), part);
    part_of_instance_.push_back(std::uint8_t(found - parts.begin()));
    instances.push_back(visual.name);
  }
  if (parts.size() > 256 || instances.size() > 65536)
    throw UsageError(path.string() + ": a mask has room for 255 parts and 65535 visuals");
  const hdf5::Shape pixels = {std::uint64_t(height), std::uint64_t(width)};
  instance_ = std::make_unique<hdf5::Series<std::uint16_t>>(file_, "/instance", pixels, true);
  part_ = std::make_unique<hdf5::Series<std::uint8_t>>(file_, "/part", pixels, true);
  file_.attribute("/", "schema", std::int64_t(1));
  file_.attribute("/instance", "names", instances);
  file_.attribute("/part", "names", parts);
}

void MasksFile::append(std::span<const std::uint32_t> instance) {
  if (instance.size() != n_pixels_) throw Failure("a mask of another size than its camera's picture was given");
  std::vector<std::uint16_t> ids(instance.begin(), instance.end());
  std::vector<std::uint8_t> parts;
  for (const std::uint32_t id : instance) parts.push_back(part_of_instance_.at(id));
  instance_->append(ids);
  part_->append(parts);
}

void MasksFile::close() {
  instance_.reset();
  part_.reset();
  file_.close();
}

}  // namespace pvg
