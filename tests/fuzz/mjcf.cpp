// MuJoCo's models as scenes.
#include "host/robot/imported_scene.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  const std::filesystem::path file = input_file("input.xml", data, size);
  may_refuse([&] { imported_scene(file); });
  return 0;
}
