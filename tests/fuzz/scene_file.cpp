// Scene files, up to the scene that is ready to run.
#include "host/load/scene_file.hpp"

#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  const std::filesystem::path file = input_file("input.yaml", data, size);
  may_refuse([&] { load_scene_run(file); });
  return 0;
}
