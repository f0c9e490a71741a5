// Rooms from meshes that were written by hand, whose floor is known.
#include "host/capture/meshes/room_mesh.hpp"

#include <gtest/gtest.h>

#include "host/capture/room_files.hpp"
#include "host/formats/gltf_writer.hpp"
#include "host/formats/picture_files.hpp"
#include "host/load/gltf_scene.hpp"
#include "host/pictures/srgb.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// n x n squares from the corner along u and v, normal along u x v
VisualMesh sheet(const Vec3f& corner, const Vec3f& u, const Vec3f& v, int n, const Vec3f& color) {
  VisualMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) {
      const float a = float(i) / float(n), b = float(k) / float(n);
      mesh.points.push_back(corner + a * u + b * v);
      mesh.colors.push_back(color);
      mesh.uvs.push_back({a, b});
    }
  const auto at = [n](int i, int k) { return std::uint32_t(i * (n + 1) + k); };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return mesh;
}

// A floor of 3 x 2 m at z = -1.4 m with a picture, a wall with colours, and a scrap in the air.
fs::path write_mesh_room(const TestFolder& folder) {
  const VisualMesh floor = sheet({-1, -1, -1.4f}, {3, 0, 0}, {0, 2, 0}, 30, Vec3f::Ones());
  VisualMesh wall = sheet({2, -1, -1.4f}, {0, 0, 1.5f}, {0, 2, 0}, 20, {0.2f, 0.4f, 0.6f});
  VisualMesh scrap = sheet({0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, 2, {1, 0, 0});
  wall.uvs.clear(), scrap.uvs.clear();
  Texture picture{4, 2, std::vector<std::uint8_t>(32, 255)};
  picture.rgba[0] = 17;
  const NamedMesh meshes[] = {{"floor", &floor, &picture}, {"wall", &wall}, {"scrap", &scrap}};
  write_captured_meshes(folder.path / "mesh.glb", meshes, false);
  return folder.path / "mesh.glb";
}

Room room_of(const fs::path& file, const RoomSettings& settings = {}, const Vec3& up = Vec3::UnitZ()) {
  return room_of_mesh(read_room_mesh(file), settings, up, [](const std::string&) {});
}

// the texture's u of a point of the floor
double floor_u(const Room& room, const Vec3f& p) {
  return ((room.room_from_capture.inverse() * p.cast<double>()).x() + 1) / 3;
}

TEST(RoomMesh, AMeshStandsOnItsLargestPlaneThatFacesUpAndKeepsItsLook) {
  const TestFolder folder;
  const Room room = room_of(write_mesh_room(folder));
  ASSERT_EQ(room.planes.size(), 2u);
  ASSERT_EQ(room.ground, 0);
  EXPECT_NEAR(room.planes[0].area, 6, 0.01);
  EXPECT_NEAR(room.planes[0].width * room.planes[0].height, 6, 0.4);  // without a hundredth of the area at each side
  EXPECT_TRUE(room.planes[0].pose.matrix().isApprox(Pose::Identity().matrix(), 1e-5));
  EXPECT_LE((room.room_from_capture * Vec3(0.5, 0, -1.4)).norm(), 0.02);
  EXPECT_GT((room.room_from_capture.linear() * Vec3::UnitX()).x(), 0.9998);  // sides are tried degree by degree
  EXPECT_TRUE((room.room_from_capture.linear() * Vec3::UnitZ()).isApprox(Vec3::UnitZ(), 1e-5));
  std::size_t n = 0;
  float highest = -1;
  for (const CapturedSurface& look : room.looks) {
    n += look.mesh.triangles.size();
    for (const Vec3f& p : look.mesh.points) highest = std::max(highest, p.z());
  }
  EXPECT_EQ(n, 2u * (30 * 30 + 20 * 20));  // without the scrap
  EXPECT_NEAR(highest, 1.5, 1e-5);
  // as a task's background reads it
  std::filesystem::create_directories(folder.path / "room");
  write_room(folder.path / "room", room, {});
  const GltfScene seen = read_gltf_scene(folder.path / "room" / "room.glb");
  ASSERT_EQ(seen.parts.size(), 2u);
  for (const GltfPart& part : seen.parts) {
    const VisualMaterial& material = seen.materials[std::size_t(part.material)];
    EXPECT_EQ(material.kind, VisualMaterial::Kind::shadow_receiver);
    if (material.texture >= 0) {
      EXPECT_EQ(seen.textures[std::size_t(material.texture)].rgba[0], 17);
      EXPECT_EQ(part.mesh.uvs.size(), 31u * 31u);
      for (std::size_t i = 0; i < part.mesh.points.size(); ++i)
        EXPECT_NEAR(part.mesh.uvs[i].x(), floor_u(room, part.mesh.points[i]), 1e-5);
    } else {
      EXPECT_TRUE(part.mesh.colors[0].isApprox(Vec3f(0.2f, 0.4f, 0.6f), 1e-6f));
    }
  }
}

TEST(RoomMesh, FewerTrianglesKeepTheTextureWhereItWas) {
  const TestFolder folder;
  RoomSettings settings;
  settings.most_triangles = 200;
  const Room room = room_of(write_mesh_room(folder), settings);
  std::size_t n = 0;
  for (const CapturedSurface& look : room.looks) {
    n += look.mesh.triangles.size();
    for (std::size_t i = 0; i < look.mesh.uvs.size(); ++i)
      EXPECT_NEAR(look.mesh.uvs[i].x(), floor_u(room, look.mesh.points[i]), 1e-5);
  }
  EXPECT_LE(n, 200u);
  EXPECT_EQ(room.mesh.triangles.size(), n);
  ASSERT_EQ(room.ground, 0);
  EXPECT_NEAR(room.planes[0].area, 6, 0.01);
}

// 128/255 in a PLY file; and a floor whose normal is the file's y
TEST(RoomMesh, ColoursOfPlyAreSrgbAndUpMayBeAnotherAxis) {
  const TestFolder folder;
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "red\nproperty uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  for (const char* xz : {"0 1 0", "0 1 2", "3 1 2", "3 1 0"}) ply += std::string(xz) + " 128 128 128\n";
  const fs::path file = folder.write("room.ply", ply + "3 0 1 2\n3 0 2 3\n");
  EXPECT_EQ(room_of(file).ground, -1);  // it faces along y
  const Room room = room_of(file, {}, Vec3::UnitY());
  ASSERT_EQ(room.ground, 0);
  EXPECT_TRUE((room.room_from_capture.linear() * Vec3::UnitY()).isApprox(Vec3::UnitZ(), 1e-6));
  EXPECT_NEAR(room.looks[0].mesh.colors[0].x(), srgb_to_linear(128 / 255.0f), 1e-3);
}

// trimesh, by which Map-Anything writes, leaves sRGB where glTF says linear.
TEST(RoomMesh, ColoursOfTrimeshAreSrgb) {
  const TestFolder folder;
  for (const char* generator : {"https://github.com/mikedh/trimesh", "another"}) {
    GltfWriter out("room");
    out.model.asset.generator = generator;
    tinygltf::Primitive part;
    part.mode = TINYGLTF_MODE_TRIANGLES;
    part.attributes["POSITION"] = out.add_vectors({0, 0, 0, 1, 0, 0, 0, 1, 0});
    part.attributes["COLOR_0"] =
        out.add(std::vector<float>(9, 0.5f), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 3);
    part.indices = out.add_triangles({{0, 1, 2}});
    tinygltf::Mesh mesh;
    mesh.primitives.push_back(part);
    out.model.meshes.push_back(mesh);
    tinygltf::Node node;
    node.mesh = 0;
    out.add_node(node);
    out.write(folder.path / "mesh.glb");
    const bool is_trimesh = std::string(generator) != "another";
    EXPECT_NEAR(read_room_mesh(folder.path / "mesh.glb")[0].mesh.colors[0].y(),
                is_trimesh ? srgb_to_linear(0.5f) : 0.5f, 1e-5)
        << generator;
  }
}

TEST(RoomMesh, WhatIsNoRoomIsOneSentence) {
  const TestFolder folder;
  const fs::path file = write_mesh_room(folder);
  std::vector<CapturedSurface> surfaces = read_room_mesh(file);
  for (CapturedSurface& surface : surfaces)
    for (Vec3f& p : surface.mesh.points) p *= 1000;
  const auto say = [](const std::string&) {};
  expect_error<UsageError>([&] { room_of_mesh(surfaces, {}, Vec3::UnitZ(), say); }, {"3e+03 m large", "--scale"});
  RoomSettings settings;
  settings.least_piece = 50;
  expect_error<UsageError>([&] { room_of(file, settings); }, {"--least-piece"});
  settings = {};
  settings.ground = 7;
  expect_error<UsageError>([&] { room_of(file, settings); }, {"--ground 7", "2 planes"});
}

// COLMAP's model as Map-Anything writes it, without depth maps: a camera at (1, 2, 3) that looks along z at a wall at
// z = 4.5 m, and points on the wall.
struct MapAnythingFolder {
  TestFolder folder;
  MapAnythingFolder() {
    folder.write("sparse/cameras.txt", "1 PINHOLE 8 6 10 11 4 3\n");
    folder.write("sparse/images.txt", "1 1 0 0 0 -1 -2 -3 1 c.png\n\n");
    std::string points = "# id x y z r g b error track\n";
    for (int i = 0; i < 5; ++i) points += std::to_string(i) + " " + std::to_string(i - 1) + " 2.5 4.5 9 9 9 0.1\n";
    folder.write("sparse/points3D.txt", points);
    fs::create_directories(folder.path / "images");
    write_picture(folder.path / "images" / "c.png", {8, 6, std::vector<std::uint8_t>(3 * 8 * 6, 90)});
  }
  // the wall, with `way` from the capture's frame to the mesh's with z up
  void write_wall(const Eigen::Matrix3f& way) const {
    VisualMesh wall = sheet({-2, -1, 4.5f}, {0, 6, 0}, {6, 0, 0}, 8, Vec3f::Ones());
    wall.uvs.clear();
    for (Vec3f& p : wall.points) p = way * p;
    write_captured_mesh(folder.path / "dense_mesh.glb", wall, "wall", false);
  }
};

TEST(RoomMesh, PhotosWithoutDepthTakeItFromTheMeshBeside) {
  const MapAnythingFolder scan;
  expect_error<UsageError>([&] { read_capture(scan.folder.path); }, {"no image has a depth map", "dense_mesh.glb"});
  Eigen::Matrix3f turned, as_it_is;
  turned << 1, 0, 0, 0, 0, 1, 0, -1, 0;    // (x, -y, -z) in the file
  as_it_is << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // (x, y, z)
  for (const Eigen::Matrix3f& way : {turned, as_it_is}) {
    scan.write_wall(way);
    Capture capture = read_capture(scan.folder.path);
    ASSERT_EQ(capture.frames.size(), 1u);
    EXPECT_EQ(capture.mesh.filename(), "dense_mesh.glb");
    Device device;
    draw_depths(device, capture);
    const DepthPicture depth = depth_of(capture, capture.frames[0]);
    ASSERT_EQ(depth.depth.size(), 48u);
    for (const float z : depth.depth) EXPECT_NEAR(z, 1.5, 1e-4);
  }
  scan.write_wall(Eigen::Vector3f(1, 2, 1).asDiagonal() * turned);
  Capture capture = read_capture(scan.folder.path);
  Device device;
  expect_error<UsageError>([&] { draw_depths(device, capture); }, {"dense_mesh.glb", "off the mesh"});
}

}  // namespace
}  // namespace pvg
