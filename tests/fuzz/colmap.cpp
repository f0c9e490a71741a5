// COLMAP's binary model: the first byte is the length of cameras.bin, the rest is images.bin.
#include <algorithm>

#include "host/capture/frames.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  if (size == 0) return 0;
  const std::size_t n_cameras = std::min<std::size_t>(data[0], size - 1);
  input_file("cameras.bin", data + 1, n_cameras);
  const std::filesystem::path images = input_file("images.bin", data + 1 + n_cameras, size - 1 - n_cameras);
  may_refuse([&] { read_capture(images.parent_path()); });
  return 0;
}
