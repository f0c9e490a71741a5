// What rests on something starts on it
#include "host/identify/sensing/support.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

// A block of 0.1 x 0.1 x 0.04 m that slides along x at 1 m/s, seen at this height, with its tilt about y or without.
Problem sliding(const TestFolder& folder, double height, bool is_turn_measured) {
  folder.write("scene.yaml", R"(schema: 1
name: slide
time_step: 5 ms
contact: {activation_distance: 0.1 mm, stiffness: 10 MPa}
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: block, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.04]}}, mass: 0.4, pose: {position: [0, 0, 0.0201]}}
)");
  std::string run = "t,x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i < 20; ++i)
    run +=
        std::to_string(0.01 * i) + "," + std::to_string(0.01 * i) + ",0," + std::to_string(height) + ",0,0.001,0,1\n";
  folder.write("a.csv", run);
  std::string channels = "  - {columns: [x, y, z], kind: position, body: block, unit: m, noise: 0.0005}\n";
  if (is_turn_measured) channels += "  - {columns: [qx, qy, qz, qw], kind: orientation, body: block, noise: 0.002}\n";
  folder.write("recording.yaml",
               "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\nchannels:\n" + channels);
  return make_problem(folder.path / "recording.yaml");
}

Window settled(const Problem& problem) {
  Window window = make_windows(problem, false, 0, 1).at(0);
  static Device device;
  settle_on_support(device, problem, problem.scene.scene, window);
  return window;
}

int count(const Window& window, Unknown::Kind kind) {
  int n = 0;
  for (const Unknown& unknown : window.unknowns) n += unknown.kind == kind;
  return n;
}

TEST(Support, ABlockStartsOnTheFloorWhereverTheNoisePutsIt) {
  double first = 0;
  for (const double height : {0.0196, 0.0206}) {
    const TestFolder folder;
    const Window window = settled(sliding(folder, height, false));
    const double z = window.initial.pose[1].translation().z();
    EXPECT_GT(z, 0.02);
    EXPECT_LT(z, 0.0201);  // within the activation distance
    EXPECT_NEAR(z, first > 0 ? first : z, 2e-6);
    first = z;
    EXPECT_EQ(window.initial.velocity[1].z(), 0);
    EXPECT_NEAR(window.initial.velocity[1].x(), 1, 1e-6);
    EXPECT_EQ(count(window, Unknown::Kind::position), 2);
    EXPECT_EQ(count(window, Unknown::Kind::velocity), 2);
    for (const Unknown& unknown : window.unknowns) EXPECT_NEAR(unknown.direction.z(), 0, 1e-6);
  }
}

TEST(Support, ABlockInTheAirKeepsItsMeasuredStart) {
  const TestFolder folder;
  const Window window = settled(sliding(folder, 0.03, false));
  EXPECT_NEAR(window.initial.pose[1].translation().z(), 0.03, 1e-9);
  EXPECT_EQ(window.unknowns.size(), 6u);
}

TEST(Support, ABlockOnItsFaceIsNotTilted) {
  const TestFolder folder;
  const Window window = settled(sliding(folder, 0.02, true));
  const Vec3 up = window.initial.pose[1].linear().col(2);
  EXPECT_NEAR(up.z(), 1, 1e-9);
  EXPECT_EQ(count(window, Unknown::Kind::rotation), 1);
  EXPECT_EQ(count(window, Unknown::Kind::spin), 1);
}

// A wheel of 50 mm rolls along x at 1 m/s, seen 0.4 mm above or below where it touches: it starts on the floor,
// rolling, though what it rests on is a face.
TEST(Support, AWheelRollsOnTheFloorWhereverTheNoisePutsIt) {
  double first = 0;
  for (const double height : {0.0496, 0.0504}) {
    const TestFolder folder;
    folder.write("scene.yaml", R"(schema: 1
name: roll
time_step: 5 ms
contact: {activation_distance: 0.1 mm, stiffness: 10 MPa}
bodies:
  - {name: floor, kind: half_space, normal: [0, 0, 1]}
  - {name: wheel, kind: rigid, shape: {cylinder: {radius: 0.05, length: 0.04, sides: 64}}, mass: 0.2, pose: {position: [0, 0, 0.0501], rotation: [90 deg, 0, 0]}}
)");
    std::string run = "t,x,y,z,qx,qy,qz,qw\n";
    for (int i = 0; i < 20; ++i) {
      // about y, after a quarter of a turn about x; half a side on, it lies on one of its sides
      const double half = 0.5 * (20 * 0.01 * i + EIGEN_PI / 64), c = std::sqrt(0.5);
      run += std::to_string(0.01 * i);
      for (const double value :
           {0.01 * i, 0.0, height, std::cos(half) * c, std::sin(half) * c, -std::sin(half) * c, std::cos(half) * c})
        run += "," + std::to_string(value);
      run += "\n";
    }
    folder.write("a.csv", run);
    folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, y, z], kind: position, body: wheel, unit: m, noise: 0.0005}
  - {columns: [qx, qy, qz, qw], kind: orientation, body: wheel, noise: 0.002}
)");
    const Window window = settled(make_problem(folder.path / "recording.yaml"));
    const double z = window.initial.pose[1].translation().z();
    if (first == 0) first = z;
    EXPECT_NEAR(z, first, 1e-5);
    EXPECT_NEAR(z, 0.05, 2e-4);
    EXPECT_NEAR(window.initial.spin[1].y(), 20, 0.5);
    EXPECT_EQ(count(window, Unknown::Kind::position), 2);
    EXPECT_EQ(count(window, Unknown::Kind::rotation), 3);
    EXPECT_EQ(count(window, Unknown::Kind::spin), 3);
  }
}

}  // namespace
}  // namespace pvg::diagnose
