// Every mesh format gives the same solid; broken files are named.
#include "host/formats/mesh_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "host/base/error.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

// a tetrahedron with legs of 1, 2 and 3 m: volume 1 m^3
const char* const OBJ = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const char* const PLY =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 2 0\n0 0 3\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 "
    "3\n";
const char* const DAE =
    R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>
<unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1000 0 0 0 2000 0 0 0 3000</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices><triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#s"/></scene></COLLADA>)";

std::string stl() {
  const double p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  std::string text = "solid t\n";
  for (const auto& f : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int i : f) {
      text +=
          "vertex " + std::to_string(p[i][0]) + " " + std::to_string(p[i][1]) + " " + std::to_string(p[i][2]) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid t\n";
}

// The same tetrahedron with y up: (x, y, z) is written as (x, z, -y). half: the node scales it by 2.
std::string gltf_json(const std::string& uri, bool half) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" +
         std::string(half ? R"(,"scale":[2,2,2])" : "") +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"buffers":[{"byteLength":72)" +
         (uri.empty() ? "" : R"(,"uri":")" + uri + "\"") + R"(}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,-2],"max":[1,3,0]},
{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]})";
}

std::string gltf_buffer(float scale) {
  const float points[12] = {0, 0, 0, scale, 0, 0, 0, 0, -2 * scale, 0, 3 * scale, 0};
  const std::uint16_t corners[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::string bytes(72, '\0');
  std::memcpy(bytes.data(), points, 48);
  std::memcpy(bytes.data() + 48, corners, 24);
  return bytes;
}

std::string glb() {
  std::string json = gltf_json("", true), buffer = gltf_buffer(0.5f);
  while (json.size() % 4) json += ' ';
  const auto word = [](std::uint32_t v) { return std::string(reinterpret_cast<const char*>(&v), 4); };
  return "glTF" + word(2) + word(std::uint32_t(28 + json.size() + buffer.size())) + word(std::uint32_t(json.size())) +
         "JSON" + json + word(std::uint32_t(buffer.size())) + std::string("BIN\0", 4) + buffer;
}

void expect_tetrahedron(const std::filesystem::path& file) {
  const TriangleMesh mesh = read_closed_surface(file);
  EXPECT_EQ(mesh.points.size(), 4u) << file;
  EXPECT_EQ(mesh.triangles.size(), 4u) << file;
  EXPECT_NEAR(enclosed_volume(mesh), 1, 1e-6) << file;  // float positions
  Vec3 high = Vec3::Zero();
  for (const Vec3& p : mesh.points) high = high.cwiseMax(p);
  EXPECT_LT((high - Vec3(1, 2, 3)).norm(), 1e-6) << file;
}

TEST(MeshFiles, EveryFormatGivesTheSameSolid) {
  const TestFolder folder;
  expect_tetrahedron(folder.write("a.obj", OBJ));
  expect_tetrahedron(folder.write("a.ply", PLY));
  expect_tetrahedron(folder.write("a.STL", stl()));
  expect_tetrahedron(folder.write("a.dae", DAE));
  folder.write("a.bin", gltf_buffer(1));
  expect_tetrahedron(folder.write("a.gltf", gltf_json("a.bin", false)));
  expect_tetrahedron(folder.write("a.glb", glb()));
}

TEST(MeshFiles, BrokenFilesAreNamed) {
  const TestFolder folder;
  const auto expect = [&](const std::string& name, const std::string& content,
                          std::initializer_list<const char*> words) {
    const auto file = folder.write(name, content);
    expect_error<UsageError>([&] { read_closed_surface(file); }, words);
  };
  expect_error<UsageError>([] { read_surface("/nowhere/cup.obj"); }, {"/nowhere/cup.obj", "no such mesh file"});
  expect("mesh.xyz", OBJ, {"mesh.xyz", ".obj, .stl, .ply, .dae, .gltf and .glb"});
  expect("empty.obj", "# nothing\n", {"empty.obj"});
  expect("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
         {"nan.obj", "not a finite"});
  expect("hole.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\n",
         {"hole.obj", "holes", "3 edges"});
  expect("flip.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 4 3\n",
         {"flip.obj", "flipped"});
  expect("inward.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n",
         {"inward.obj", "inward"});
  expect("cut.gltf", R"({"asset":{"version":"2.0")", {"cut.gltf", "glTF"});
  expect("lost.gltf", gltf_json("lost.bin", false), {"lost.gltf", "lost.bin"});
  std::filesystem::create_directory(folder.path / "folder");
  expect("opened.gltf", gltf_json("folder", false), {"opened.gltf", "folder"});
  folder.write("short.bin", gltf_buffer(1).substr(0, 60));
  expect("short.gltf", gltf_json("short.bin", false), {"short.gltf"});
  expect("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
         {"far.obj", "a million kilometres away"});
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(MeshFiles, GltfReferencesThatLeadNowhereAreNamed) {
  const TestFolder folder;
  folder.write("a.bin", gltf_buffer(1));
  const auto expect = [&](const std::string& from, const std::string& to, const char* what) {
    const auto file = folder.write("a.gltf", replaced(gltf_json("a.bin", false), from, to));
    expect_error<UsageError>([&] { read_closed_surface(file); }, {"a.gltf", what});
  };
  expect(R"("bufferView":0)", R"("bufferView":7)", "buffer view that does not exist");
  expect(R"({"buffer":0,"byteOffset":48)", R"({"buffer":7,"byteOffset":48)", "");
  expect(R"("byteOffset":48)", R"("byteOffset":18446744073709551600)", "");
  expect(R"("count":4)", R"("count":4000000000)", "beyond its buffer");
  expect(R"("mesh":0)", R"("mesh":7)", "mesh that does not exist");
  expect(R"("nodes":[0])", R"("nodes":[7])", "do not form a tree");
  expect(R"("indices":1)", R"("indices":7)", "accessor");
}

TEST(MeshFiles, AGltfNodeWithTwoParentsIsRefused) {
  // a ladder of 60 rungs, each with the next one twice: 2^60 nodes if it were followed
  std::string nodes = R"("nodes":[)";
  for (int i = 1; i <= 60; ++i) nodes += "{\"children\":[" + std::to_string(i) + "," + std::to_string(i) + "]},";
  const TestFolder folder;
  folder.write("a.bin", gltf_buffer(1));
  const auto file = folder.write("a.gltf", replaced(gltf_json("a.bin", false), R"("nodes":[{)", nodes + "{"));
  expect_error<UsageError>([&] { read_closed_surface(file); }, {"a.gltf", "do not form a tree"});
}

TEST(MeshFiles, WhatAssimpCrashesOnIsRefused) {
  // found by fuzzing: assertions, bad memory, numbers without end
  const TestFolder folder;
  const auto expect = [&](const std::string& name, const std::string& content) {
    const auto file = folder.write(name, content);
    expect_error<UsageError>([&] { read_closed_surface(file); }, {name.c_str()});
  };
  expect("a.ply", replaced(PLY, "0 2 0\n", std::string("0 \0002 0\n", 7)));
  expect("a.dae", replaced(DAE, "count=\"12\"", "coUnt=\"6\""));
  expect("b.dae", replaced(DAE, "<p>0 2 1", "<p>0 2 1\xff"));
}

TEST(MeshFiles, WhatAssimpReadsWithoutEndIsRefused) {
  const TestFolder folder;
  const auto file = folder.write("a.ply", "ply\nformat ascii 1.0\nproperty float x\nproperty fy li3\n3 0 2 1\n");
  expect_error<UsageError>([&] { read_closed_surface(file); }, {"a.ply", "cannot be read"});
}

TEST(MeshFiles, AFileIsReadAsWhatItsEndingSaysAlone) {
  const TestFolder folder;
  for (const char* name : {"a.stl", "a.obj", "a.dae"}) {
    const auto file = folder.write(name, PLY);
    expect_error<UsageError>([&] { read_closed_surface(file); }, {name});
  }
}

TEST(MeshFiles, DeeplyNestedXmlIsRefused) {
  std::string nodes;
  for (int i = 0; i < 200000; ++i) nodes += "<node>";
  const TestFolder folder;
  const auto file = folder.write("deep.dae", replaced(DAE, "<node>", nodes));
  expect_error<UsageError>([&] { read_closed_surface(file); }, {"deep.dae"});
}

TEST(MeshFiles, CreaseStaysSharpAndRoundIsSmoothed) {
  // a roof: two slopes that meet at an angle of 20 degrees
  const double a = 10 * M_PI / 180;
  const TestFolder folder;
  const auto file = folder.write("roof.obj", "v -1 0 0\nv 0 0 " + std::to_string(std::tan(a)) + "\nv 0 1 " +
                                                 std::to_string(std::tan(a)) +
                                                 "\nv 1 0 0\nv -1 1 0\nv 1 1 0\nf 1 2 3 5\nf 2 4 6 3\n");
  const VisualMesh smooth = read_visual_mesh(file, 30 * M_PI / 180), sharp = read_visual_mesh(file, 15 * M_PI / 180);
  EXPECT_EQ(smooth.points.size(), 6u);
  EXPECT_EQ(sharp.points.size(), 8u);  // the ridge twice
  for (std::size_t i = 0; i < smooth.points.size(); ++i) {
    const float x = smooth.points[i].x();
    // the ridge points up, the slopes' other ends along their own normals
    const double lean = x == 0 ? 0 : (x < 0 ? -1 : 1) * std::sin(a);
    EXPECT_NEAR(smooth.normals[i].x(), lean, 1e-5);
  }
  EXPECT_TRUE(read_visual_mesh(file, 0).normals.empty());
}

TEST(MeshFiles, TextureCoordinatesCountFromTheTop) {
  const TestFolder folder;
  const VisualMesh mesh = read_visual_mesh(
      folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0.25\nvt 0 1\nf 1/1 2/2 3/3\n"), 0);
  ASSERT_EQ(mesh.uvs.size(), 3u);
  EXPECT_FLOAT_EQ(mesh.uvs[0].y(), 0.75f);
  EXPECT_FLOAT_EQ(mesh.uvs[2].y(), 0.0f);
}

}  // namespace
}  // namespace pvg
