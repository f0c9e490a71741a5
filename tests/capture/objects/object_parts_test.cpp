// A pot and its lid, of one file with two nodes.
#include "host/capture/objects/object_parts.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/base/files.hpp"
#include "host/capture/room_files.hpp"
#include "host/formats/gltf_nodes.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/formats/tinygltf.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

VisualMesh shifted(const TriangleMesh& mesh, const Vec3& by) {
  VisualMesh out = visual_of(mesh);
  for (Vec3f& p : out.points) p += by.cast<float>();
  return out;
}

// a cylinder of 100 mm and one of 20 mm above it, `gap` apart; a triangle of the upper one is flipped, so that it is
// wrapped
fs::path write_pot(const TestFolder& folder, double gap, const std::string& lid_name = "lid") {
  const VisualMesh pot = shifted(cylinder_surface(0.05, 0.1, 32), Vec3(0, 0, 0.05));
  VisualMesh lid = shifted(cylinder_surface(0.05, 0.02, 32), Vec3(0, 0, 0.11 + gap));
  std::swap(lid.triangles.back()[0], lid.triangles.back()[1]);
  const NamedMesh meshes[] = {{"pot", &pot}, {lid_name, &lid}};
  write_captured_meshes(folder.path / "pot.glb", meshes, false);
  return folder.path / "pot.glb";
}

// white would reflect all light, at each bounce
TEST(ObjectParts, WhatHasNoColoursIsGrey) {
  const TestFolder folder;
  const tinygltf::Model model = load_gltf(write_pot(folder, 2.5e-3));
  ASSERT_EQ(model.materials.size(), 2u);
  for (const tinygltf::Material& material : model.materials)
    EXPECT_EQ(material.pbrMetallicRoughness.baseColorFactor, (std::vector<double>{0.5, 0.5, 0.5, 1}));
}

TEST(ObjectParts, EachNodeIsAPartAndNoTwoMeet) {
  const TestFolder folder;
  ObjectSettings settings;
  settings.mass = 2;
  settings.wrap.spacing = 5e-3;  // the wrap is 3 mm larger: too coarse for the gap
  const std::vector<NamedSource> sources = read_object_parts(write_pot(folder, 2.5e-3), settings);
  ASSERT_EQ(sources.size(), 2u);
  EXPECT_EQ(sources[0].name, "pot");
  EXPECT_EQ(sources[1].name, "lid");
  const std::vector<CapturedPart> parts = capture_parts(sources, settings);
  TriangleMesh all;
  std::vector<std::uint32_t> group;
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(is_sound(parts[i].object.simulation));
    const auto first = std::uint32_t(all.points.size());
    for (const Vec3& p : parts[i].object.simulation.points) all.points.push_back(p);
    for (const Triangle& t : parts[i].object.simulation.triangles) {
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      group.push_back(i);
    }
  }
  EXPECT_FALSE(find_intersection(all.points, all.triangles));
  EXPECT_TRUE(parts[0].object.was_sound);
  EXPECT_FALSE(parts[1].object.was_sound);
  EXPECT_LT(parts[1].object.spacing, 4e-3);  // made anew
  EXPECT_NEAR(parts[0].object.mass.mass + parts[1].object.mass.mass, 2, 1e-9);
  // five to one by volume; the wrap of the lid is up to 1.5 mm larger all around, 1.22 times its volume
  EXPECT_LT(parts[0].object.mass.mass, 2 * 5 / 6.0);
  EXPECT_GT(parts[0].object.mass.mass, 2 * 5 / 6.22 - 0.01);
  fs::create_directories(folder.path / "out");
  write_parts(folder.path / "out", parts, settings, 0);
  const std::string yaml = read_whole_file(folder.path / "out" / "object.yaml").value();
  for (const char* text : {"name: pot", "mesh: part_lid.obj", "type: fixed, parent: pot, child: lid"})
    EXPECT_NE(yaml.find(text), std::string::npos) << text;
  EXPECT_EQ(read_closed_surface(folder.path / "out" / "part_lid.obj").triangles.size(),
            parts[1].object.simulation.triangles.size());
  EXPECT_TRUE(parts_report(parts, settings, 0)["parts"].contains("lid"));
}

TEST(ObjectParts, WhatAUserCanGetWrongIsOneSentence) {
  const TestFolder folder;
  ObjectSettings settings;
  settings.wrap.spacing = 10e-3;
  expect_error<UsageError>([&] { read_object_parts(folder.path / "pot.stl", settings); }, {"--parts", "glTF"});
  expect_error<UsageError>([&] { read_object_parts(write_pot(folder, 1e-3, "a lid"), settings); },
                           {"a lid", "pot.glb"});
  expect_error<UsageError>([&] { read_object_parts(write_pot(folder, 1e-3, "pot"), settings); },
                           {"one node", "--parts out"});
  expect_error<UsageError>([&] { capture_parts(read_object_parts(write_pot(folder, -5e-3), settings), settings); },
                           {"`pot`", "`lid`", "cross each other"});
  // nearer than the wrap's offset after it was halved twice
  expect_error<UsageError>([&] { capture_parts(read_object_parts(write_pot(folder, 2e-5), settings), settings); },
                           {"`pot`", "`lid`", "--detail"});
}

}  // namespace
}  // namespace pvg
