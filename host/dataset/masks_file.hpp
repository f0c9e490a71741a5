// <camera>_masks.h5: what every pixel of every frame sees.
//   /instance [F, H, W]  u16, 0: nothing, i: the attribute `names` [i], one per visual
//   /part     [F, H, W]  u8,  0: nothing, i: the attribute `names` [i], such as "gripper"
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/hdf5/series.hpp"
#include "host/model/scene.hpp"

namespace pvg {

class MasksFile {
 public:
  MasksFile(const std::filesystem::path& path, const Scene& scene, int width, int height);
  // instance: 1 + index of the visual, 0: nothing  [height x width]
  void append(std::span<const std::uint32_t> instance);
  void close();

 private:
  std::vector<std::uint8_t> part_of_instance_;  // [1 + n_visuals]
  std::size_t n_pixels_;
  hdf5::File file_;
  std::unique_ptr<hdf5::Series<std::uint16_t>> instance_;
  std::unique_ptr<hdf5::Series<std::uint8_t>> part_;
};

}  // namespace pvg
