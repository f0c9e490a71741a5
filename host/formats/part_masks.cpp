#include "host/formats/part_masks.hpp"

#include <algorithm>

#include "host/base/counted.hpp"
#include "host/hdf5/file.hpp"

namespace pvg {
namespace {

std::uint8_t number_of(const std::vector<std::string>& names, const std::string& part, const std::string& file) {
  const auto found = std::find(names.begin(), names.end(), part);
  if (found != names.end() && found != names.begin()) return std::uint8_t(found - names.begin());
  std::string known;
  for (std::size_t i = 1; i < names.size(); ++i) known += (i > 1 ? ", " : "") + names[i];
  throw UsageError(file + " has no part `" + part + "`; it has: " + known);
}

}  // namespace

std::vector<std::string> named_parts(const std::filesystem::path& path) {
  const hdf5::File file = hdf5::File::open(path);
  if (!file.has("/part")) return {};
  std::vector<std::string> names = file.texts_attribute("/part", "names");
  if (!names.empty()) names.erase(names.begin());  // of what is no part
  return names;
}

PartMasks read_part_masks(const std::filesystem::path& path, const std::string& part) {
  const std::string name = path.string();
  try {
    const hdf5::File file = hdf5::File::open(path);
    if (!file.has("/part")) throw UsageError(name + " has no array /part [frames, height, width] of masks");
    const hdf5::Shape shape = file.shape("/part");
    if (shape.size() != 3 || shape[1] == 0 || shape[2] == 0)
      throw UsageError(name + ": /part must have the shape [frames, height, width]");
    const std::uint8_t number = number_of(file.texts_attribute("/part", "names"), part, name);
    PartMasks masks;
    masks.height = int(shape[1]);
    masks.width = int(shape[2]);
    for (std::uint64_t frame = 0; frame < shape[0]; ++frame) {
      masks.pixels.push_back(file.read_row<std::uint8_t>("/part", frame));
      for (std::uint8_t& pixel : masks.pixels.back()) pixel = pixel == number;
    }
    if (!file.has("/time")) return masks;
    masks.time = file.read<double>("/time").values;
    if (masks.time.size() != masks.pixels.size())
      throw UsageError(name + ": /time has " + counted(masks.time.size(), "number") + " for " +
                       counted(masks.pixels.size(), "mask"));
    return masks;
  } catch (const Failure& failure) {
    throw UsageError(failure.what());
  }
}

}  // namespace pvg
