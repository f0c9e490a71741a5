// Task files and gripper files.
#include "host/load/task_file.hpp"

#include "host/load/build_scene.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  const std::filesystem::path file = input_file("input.yaml", data, size);
  may_refuse([&] {
    const Task task = load_task(file);
    resolved_yaml(task, build_scene(task, 0, 0));
  });
  may_refuse([&] { load_gripper(file); });
  return 0;
}
