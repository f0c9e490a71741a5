// The pixels of one part in the pictures of one camera, read from what masks_file.hpp and truth_file.hpp write, or from
// any HDF5 file with
//   /part [F, H, W]  u8, i: the attribute `names` [i] of /part, such as "gripper"
//   /time [F, s]     if it is there
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pvg {

struct PartMasks {
  int width = 0, height = 0;
  std::vector<double> time;                       // [n_frames, s], empty: the file has none
  std::vector<std::vector<std::uint8_t>> pixels;  // [n_frames][height x width] 1: the part
};

// The parts that the file names; none where it has no such array.
std::vector<std::string> named_parts(const std::filesystem::path& file);

// Throws a UsageError that names the file where it has no such part or its arrays do not fit.
PartMasks read_part_masks(const std::filesystem::path& file, const std::string& part);

}  // namespace pvg
