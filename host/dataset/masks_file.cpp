#include "host/dataset/masks_file.hpp"

#include "host/dataset/truth_file.hpp"

namespace pvg {

MasksFile::MasksFile(const std::filesystem::path& path, const Scene& scene, int width, int height)
    : n_pixels_(std::size_t(width) * std::size_t(height)), file_(hdf5::File::create(path)) {
  const MaskLabels labels = mask_labels(scene, path);
  part_of_instance_ = labels.part_of_instance;
  const hdf5::Shape pixels = {std::uint64_t(height), std::uint64_t(width)};
  instance_ = std::make_unique<hdf5::Series<std::uint16_t>>(file_, "/instance", pixels, true);
  part_ = std::make_unique<hdf5::Series<std::uint8_t>>(file_, "/part", pixels, true);
  file_.attribute("/", "schema", std::int64_t(1));
  file_.attribute("/instance", "names", labels.instances);
  file_.attribute("/part", "names", labels.parts);
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
