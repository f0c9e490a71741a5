// A bumpy floor as a solid, and a cube that is dropped onto its bump.
#include "host/capture/objects/room_solid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/capture/objects/wrap.hpp"
#include "host/capture/room_files.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/primitive_shapes.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/captured_room.hpp"
#include "host/physics/step/simulation.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

constexpr double BUMP = 0.03, TOP = 0.05, FOOT = 0.09;  // height, and radii of its flat top and of its foot [m]

double bump(double x, double y) {
  const double s = std::clamp((std::hypot(x, y) - TOP) / (FOOT - TOP), 0.0, 1.0);
  return BUMP * (1 - s * s * (3 - 2 * s));
}

// 0.4 x 0.4 m, open, seen from above
Room bumpy_room() {
  constexpr int N = 80;
  Room room;
  for (int i = 0; i <= N; ++i)
    for (int k = 0; k <= N; ++k) {
      const double x = 0.4 * i / N - 0.2, y = 0.4 * k / N - 0.2;
      room.mesh.points.push_back(Vec3(x, y, bump(x, y)).cast<float>());
    }
  const auto at = [](int i, int k) { return std::uint32_t(i * (N + 1) + k); };
  for (int i = 0; i < N; ++i)
    for (int k = 0; k < N; ++k) {
      room.mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      room.mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  room.looks = {{room.mesh, {}}};
  CapturedPlane floor;
  floor.width = floor.height = 0.4;
  room.planes = {floor};
  room.ground = 0;
  return room;
}

TEST(RoomSolid, ItsUpperSideIsWhereTheSurfaceWas) {
  Room room = bumpy_room();
  make_solid({1, 0.01}, room);
  EXPECT_TRUE(is_sound(room.solid));
  EXPECT_LE(room.solid_distances[room.solid_distances.size() * 95 / 100], 1.5e-3);
  std::size_t n_upper = 0;
  for (const Vec3& p : room.solid.points)
    if (std::max(std::abs(p.x()), std::abs(p.y())) < 0.19 && p.z() > bump(p.x(), p.y()) - 4e-3) {
      ++n_upper;
      EXPECT_NEAR(p.z(), bump(p.x(), p.y()), 3e-3) << p.transpose();  // a quarter of the detail and a little
    }
  EXPECT_GT(n_upper, 20u);
}

TEST(RoomSolid, WhatCannotBeSolidIsOneSentence) {
  Room room = bumpy_room();
  for (Vec3f& p : room.mesh.points) p.x() += 5;
  expect_error<UsageError>([&] { make_solid({1, 0.01}, room); }, {"--contact"});
  Room closed;  // its hollow would be filled
  const TriangleMesh box = box_surface(Vec3(0.3, 0.3, 0.3));
  for (const Vec3& p : box.points) closed.mesh.points.push_back(p.cast<float>());
  for (const Triangle& t : box.triangles) closed.mesh.triangles.push_back({t[0], t[2], t[1]});
  expect_error<UsageError>([&] { make_solid({1, 0.01}, closed); }, {"closed all around", "--contact"});
}

// a cube of 40 mm whose lower side is `height` above the floor, in the room that is written beside it
Scene cube_above(const TestFolder& folder, double height, const std::vector<std::string>& planes = {}) {
  std::string obj;
  for (const Vec3& p : box_surface(Vec3(0.04, 0.04, 0.04)).points)
    obj += "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
  for (const Triangle& t : box_surface(Vec3(0.04, 0.04, 0.04)).triangles)
    obj += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  CapturedBackground captured;
  captured.room = folder.path / "room" / "room.yaml";
  captured.contact = CapturedBackground::Contact::surface;
  captured.planes = planes;
  Task task;
  task.name = "drop";
  task.solver.time_step = 0.01;
  ObjectSection& cube = task.objects.emplace_back();
  cube.name = "cube";
  cube.mesh = folder.write("cube.obj", obj);
  cube.mass = 0.05;
  cube.pose.z = {height + 0.02, height + 0.02};  // its origin is its middle
  add_captured_room(captured, task.objects);
  return build_scene_at_middle(task).scene;
}

TEST(RoomSolid, ACubeRestsOnTheBumpAndNotOnThePlane) {
  const TestFolder folder;
  Room room = bumpy_room();
  make_solid({1, 0.01}, room);
  std::filesystem::create_directories(folder.path / "room");
  write_room(folder.path / "room", room, {});
  const Scene scene = cube_above(folder, 0.04);
  ASSERT_EQ(scene.rigid_bodies.size(), 2u);
  EXPECT_EQ(scene.rigid_bodies[1].name, "room_surface");
  Device device;
  Simulation simulation(device, scene);
  for (int step = 0; step < 40; ++step) {
    simulation.step(std::vector<double>{});
    TriangleMesh all;
    std::vector<std::uint32_t> body;
    for (std::uint32_t i = 0; i < scene.rigid_bodies.size(); ++i) {
      const auto first = std::uint32_t(all.points.size());
      for (const Vec3& p : scene.rigid_bodies[i].collision.points)
        all.points.push_back(simulation.state().rigid[i] * p.homogeneous());
      for (const Triangle& t : scene.rigid_bodies[i].collision.triangles) {
        all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        body.push_back(i);
      }
    }
    ASSERT_FALSE(find_intersection(all.points, all.triangles, body)) << "step " << step;
  }
  const Vec3 at = simulation.state().rigid[0].col(3);
  EXPECT_NEAR(at.z(), BUMP + 0.02, 4e-3);  // a quarter of the detail, and the distance of contact
  EXPECT_LE(std::hypot(at.x(), at.y()), 5e-3);
}

TEST(RoomSolid, WhatStartsInTheSurfaceIsRefused) {
  const TestFolder folder;
  Room room = bumpy_room();
  std::filesystem::create_directories(folder.path / "room");
  write_room(folder.path / "room", room, {});
  expect_error<UsageError>([&] { cube_above(folder, 0.01); }, {"surface", "--contact"});
  make_solid({1, 0.01}, room);
  std::filesystem::create_directories(folder.path / "room");
  write_room(folder.path / "room", room, {});
  expect_error<UsageError>([&] { cube_above(folder, 0.01, {"plane_0"}); }, {"planes", "contact: surface"});
  const Scene scene = cube_above(folder, 0.01);
  Device device;
  expect_error<UsageError>([&] { Simulation(device, scene); }, {"room_surface", "cube", "intersect at the start"});
}

}  // namespace
}  // namespace pvg
