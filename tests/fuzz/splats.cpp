// Gaussian splats.
#include "host/capture/objects/splats.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  const std::filesystem::path file = input_file("input.ply", data, size);
  may_refuse([&] {
    if (is_splat_file(file)) read_splats(file, 1);
  });
  return 0;
}
