// Mesh files, of the format that PVG_FUZZ_SUFFIX names, as surface, as picture and as a robot's link.
#include "host/formats/mesh_files.hpp"
#include "host/robot/link_mesh.hpp"
#include "tests/fuzz/input_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pvg;
  const std::filesystem::path file = input_file("input" PVG_FUZZ_SUFFIX, data, size);
  may_refuse([&] { read_closed_surface(file); });
  may_refuse([&] { read_visual_mesh(file); });
  may_refuse([&] { load_mesh_parts(file, Vec3(1, 2, -1), "input"); });
  return 0;
}
