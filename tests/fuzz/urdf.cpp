// Robots.
#include "host/robot/robot.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  const std::filesystem::path file = input_file("input.urdf", data, size);
  may_refuse([&] { load_urdf(file); });
  return 0;
}
