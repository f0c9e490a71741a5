// Numbers that a recording states: of one run, of its start, and before any data
#include <gtest/gtest.h>

#include "host/base/error.hpp"
#include "host/identify/candidates/candidate.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/window.hpp"
#include "host/identify/sensing/world.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg::diagnose {
namespace {

constexpr double ARM = 0.3;  // of a pendulum to its marker [m]

// A pendulum that a camera sees from the side by a marker ARM below its hinge, at angles 0.9 + 1.5 t; `pose` of the
// body.
Problem tracked_pendulum(const TestFolder& folder) {
  folder.write("scene.yaml", R"(schema: 1
name: pendulum
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}}
  - {name: bar, kind: rigid, shape: {box: {size: [0.02, 0.02, 0.3]}}, mass: 0.1, pose: {position: [0, 0, -0.15]}}
joints:
  - {name: hinge, type: revolute, parent: base, child: bar, axis: [0, 1, 0]}
)");
  std::string table = "t,x,z\n";
  for (int i = 0; i < 20; ++i) {
    const double t = 0.01 * i, q = 0.9 + 1.5 * t;
    table +=
        std::to_string(t) + "," + std::to_string(-ARM * std::sin(q)) + "," + std::to_string(-ARM * std::cos(q)) + "\n";
  }
  folder.write("a.csv", table);
  folder.write("recording.yaml", R"(schema: 1
scene: scene.yaml
runs:
  - {file: a.csv, role: fit}
channels:
  - {columns: [x, z], kind: marker, body: bar, point: [0, 0, -0.15], axes: [x, z], unit: m, noise: 0.0005}
)");
  return make_problem(folder.path);
}

TEST(StartPlaces, AMarkerTellsTheAngleAndRateOfTheJointThatCarriesIt) {
  const TestFolder folder;
  const Problem problem = tracked_pendulum(folder);
  EXPECT_TRUE(problem.can_restart);
  const Window window = make_windows(problem, false, 0, 1).front();
  EXPECT_NEAR(window.initial.position[0], 0.9, 0.01);  // noise over the arm is 0.0017 rad
  ASSERT_EQ(window.unknowns.size(), 2u);
  // The first samples tell the rate to some 0.2 rad/s, and without them it would be 0 +- s: of both the mean, by their
  // squared standard deviations, is 1.5 (1 - sigma^2 / s^2), sigma that of the mean.
  const double s = criteria().start_unmeasured_rate * criteria().start_unmeasured_turn;
  const double sigma = window.unknowns[1].sigma / criteria().start_looseness;
  EXPECT_LT(sigma, 0.3);
  EXPECT_NEAR(window.initial.rate[0], 1.5 * (1 - sigma * sigma / (s * s)), 0.01);
  EXPECT_EQ(window.unknowns[0].kind, Unknown::Kind::joint_position);
  EXPECT_EQ(window.unknowns[1].kind, Unknown::Kind::joint_rate);
}

// A pendulum whose two runs differ in the load of its tip. keys: of the second run; more: of the recording.
Problem pendulum(const TestFolder& folder, const std::string& keys, const std::string& more = "") {
  folder.write("scene.yaml", R"(schema: 1
name: pendulum
time_step: 5 ms
bodies:
  - {name: base, kind: static, shape: {box: {size: [0.1, 0.1, 0.1]}}}
  - {name: tip, kind: rigid, shape: {box: {size: [0.2, 0.02, 0.02]}}, mass: 0.1, pose: {position: [0, 0, 1]}}
  - {name: ball, kind: rigid, shape: {box: {size: [0.1, 0.1, 0.1]}}, mass: 0.3, pose: {position: [2, 0, 1]}}
joints:
  - {name: hinge, type: revolute, parent: base, child: tip, parent_frame: {position: [0, 0, 1]}, axis: [0, 1, 0],
     damping: 0.01}
)");
  std::string a = "t,q,x,y,z\n", b = a;
  for (int i = 0; i < 20; ++i) {
    a += std::to_string(0.01 * i) + "," + std::to_string(0.02 * i) + ",2,0,1\n";
    b += std::to_string(0.01 * i) + "," + std::to_string(0.03 * i) + ",2,0,1\n";
  }
  folder.write("a.csv", a);
  folder.write("b.csv", b);
  folder.write("recording.yaml",
               "schema: 1\nscene: scene.yaml\nruns:\n  - {file: a.csv, role: fit}\n"
               "  - {file: b.csv, role: fit" +
                   keys +
                   "}\nchannels:\n"
                   "  - {column: q, kind: position, joint: hinge, noise: 0.001}\n"
                   "  - {columns: [x, y, z], kind: position, body: ball, noise: 0.001}\n" +
                   more);
  return make_problem(folder.path / "recording.yaml");
}

PhysicalScene world_of_run(const Problem& problem, int run) {
  const std::vector<Window> windows = make_windows(problem, false, 0, 2);
  return world_of(problem, problem.scene.scene, windows.at(std::size_t(run)), windows[std::size_t(run)].initial);
}

TEST(StatedNumbers, OfARunHoldInItsWorldAlone) {
  const TestFolder folder;
  const Problem problem = pendulum(folder,
                                   ", set: {body/tip/mass: 52 g, joint/hinge/damping: 0.03, "
                                   "pair/tip/ball/friction: 0.7, gravity: [0, 1, -9.8]}");
  const PhysicalScene first = world_of_run(problem, 0), second = world_of_run(problem, 1);
  EXPECT_EQ(first.rigid_bodies[1].mass, 0.1);
  EXPECT_DOUBLE_EQ(second.rigid_bodies[1].mass, 0.052);
  EXPECT_TRUE(second.rigid_bodies[1].inertia.isApprox(0.52 * first.rigid_bodies[1].inertia, 1e-12));
  EXPECT_EQ(first.joints[0].damping, 0.01);
  EXPECT_EQ(second.joints[0].damping, 0.03);
  ASSERT_EQ(second.pair_friction.size(), 1u);
  EXPECT_EQ(second.pair_friction[0].coefficient, 0.7);
  EXPECT_EQ(second.gravity, Vec3(0, 1, -9.8));
}

// Keys of the scene file: sizes, centres of mass, frames. A variant's own mass stays in proportion.
TEST(StatedNumbers, OfTheSceneFileMayBeAnyOfItsKeys) {
  const TestFolder folder;
  const Problem problem =
      pendulum(folder,
               ", set: {body/tip/size: [0.3 m, 0.02, 0.02], body/tip/center_of_mass: [5 mm, 0, 0], "
               "joint/hinge/parent_frame/position: [0, 0, 0.9], body/tip/pose/position: [0, 0, 0.9]}");
  const PhysicalScene first = world_of_run(problem, 0), second = world_of_run(problem, 1);
  const auto length_of = [](const PhysicalScene& scene) {
    double low = 1, high = -1;
    for (const Vec3& point : scene.rigid_bodies[1].collision.points) {
      low = std::min(low, point.x());
      high = std::max(high, point.x());
    }
    return high - low;
  };
  EXPECT_NEAR(length_of(first), 0.2, 1e-12);
  EXPECT_NEAR(length_of(second), 0.3, 1e-12);
  EXPECT_EQ(second.rigid_bodies[1].mass, 0.1);
  EXPECT_EQ(second.rigid_bodies[1].center_of_mass, Vec3(0.005, 0, 0));
  EXPECT_NEAR(second.rigid_bodies[1].inertia(2, 2), 0.1 * (0.09 + 0.0004) / 12, 1e-9);
  EXPECT_NEAR(second.rigid_bodies[1].pose.translation().z(), 0.9, 1e-12) << "where the start puts what hangs there";
  PhysicalScene heavier = problem.scene.scene;
  heavier.rigid_bodies[1].mass *= 2;
  heavier.rigid_bodies[1].inertia *= 2;
  const std::vector<Window> windows = make_windows(problem, false, 0, 2);
  const PhysicalScene world = world_of(problem, heavier, windows[1], windows[1].initial);
  EXPECT_NEAR(world.rigid_bodies[1].mass, 0.2, 1e-12);
  EXPECT_TRUE(world.rigid_bodies[1].inertia.isApprox(2 * second.rigid_bodies[1].inertia, 1e-12));
}

TEST(StatedNumbers, ALoadIsFastenedInItsRunAlone) {
  const TestFolder folder;
  const Problem problem = pendulum(folder, ", set: {body/tip/load: 20 g}");
  EXPECT_TRUE(world_of_run(problem, 0).effects.empty());
  const PhysicalScene second = world_of_run(problem, 1);
  ASSERT_EQ(second.effects.size(), 1u);
  EXPECT_EQ(second.effects[0].name, "payload_mass");
  EXPECT_DOUBLE_EQ(second.effects[0].parameters[0], 0.02);
}

// Times of a push are those of the run, of the world those since its window began.
TEST(Disturbances, ActInTheirRunAloneAndAreNoCandidates) {
  const TestFolder folder;
  const Problem problem =
      pendulum(folder,
               ", disturbances: [{body: ball, point: [0, 0, 5 cm], force: [2 N, 0, 0], from: 0.05 s, to: 0.1 s}, "
               "{body: tip, kind: torque, columns: [x, y, z], unit: mN m}]");
  EXPECT_TRUE(world_of_run(problem, 0).effects.empty());
  const std::vector<KnownPush>& pushes = problem.runs[1].pushes;
  ASSERT_EQ(pushes.size(), 1u + 19) << "one between each two rows";
  EXPECT_DOUBLE_EQ(parameter_of(pushes[1].effect, "torque_x"), 2e-3);
  EXPECT_DOUBLE_EQ(pushes[1].to, 0.01);
  PhysicalScene scene;
  add_pushes({pushes[0]}, 0.04, 0.2, scene);
  ASSERT_EQ(scene.effects.size(), 1u);
  EXPECT_NEAR(parameter_of(scene.effects[0], "from"), 0.01, 1e-12);
  EXPECT_NEAR(parameter_of(scene.effects[0], "to"), 0.06, 1e-12);
  EXPECT_EQ(parameter_of(scene.effects[0], "x"), 2);
  EXPECT_EQ(parameter_of(scene.effects[0], "point_z"), 0.05);
  scene.effects.clear();
  add_pushes({pushes[0]}, 0.1, 0.2, scene);
  EXPECT_TRUE(scene.effects.empty()) << "it was over before";
  EXPECT_EQ(world_of_run(problem, 1).effects.size(), pushes.size());
  for (const Candidate& candidate : make_candidates(problem, {"tip/ball"})) EXPECT_NE(candidate.name, "push");
}

TEST(Disturbances, WhatIsWrongIsNamed) {
  const TestFolder folder;
  const auto expect = [&](const std::string& keys, const std::string& sentence) {
    expect_error<UsageError>([&] { pendulum(folder, ", " + keys); }, {sentence.c_str()});
  };
  expect("disturbances: [{body: base, force: [1, 0, 0], from: 0, to: 0.1}]",
         "pushes the body `base`, which no force can move");
  expect("disturbances: [{body: ball, force: [1, 0, 0], from: 0.1, to: 0}]", "must come after `from`");
  expect("disturbances: [{body: ball, force: [1, 0, 0], from: 3, to: 4}]", "is not recorded");
  expect("disturbances: [{body: ball, from: 0, to: 0.1}]", "must have either a `force` or a `torque`");
  expect("disturbances: [{body: ball, kind: force, columns: [x, y]}]", "must name 3 columns");
  expect("set: {body/tip/length: 3}", "cannot be loaded");
  expect("set: {body/ball/load: -1 g}", "must be 0 to 100 kg");
  expect("set: {body/none/size: 3}", "is no number of the scene that can be stated");
  expect("set: {body/tip/size: [0.2, 0.02, 0.02]}", "change nothing");
}

TEST(StatedNumbers, OfAStartHoldInsteadOfWhatTheFirstSamplesSay) {
  const TestFolder folder;
  const Problem problem = pendulum(folder,
                                   ", initial: {joint/hinge/velocity: {value: 90 deg/s, sigma: 0.01}, "
                                   "joint/hinge/position: 0, body/ball/velocity: [1, 0, 2]}");
  const std::vector<Window> windows = make_windows(problem, false, 0.1, 4);
  const auto sigma_of = [](const Window& window, Unknown::Kind kind) {
    for (const Unknown& one : window.unknowns)
      if (one.kind == kind) return one.sigma;
    return 0.0;
  };
  const auto is_of_second = [&](const Window& w, double start) {
    return w.run == 1 && std::abs(w.start - start) < 1e-9;
  };
  for (const Window& window : windows) {
    if (is_of_second(window, 0)) {
      EXPECT_NEAR(window.initial.rate[0], M_PI / 2, 1e-12);
      EXPECT_EQ(sigma_of(window, Unknown::Kind::joint_rate), 0.01);
      EXPECT_EQ(sigma_of(window, Unknown::Kind::joint_position), 0);
      EXPECT_EQ(window.initial.velocity[2], Vec3(1, 0, 2));
      EXPECT_EQ(sigma_of(window, Unknown::Kind::velocity), 0);
      EXPECT_GT(sigma_of(window, Unknown::Kind::position), 0);
    } else {
      EXPECT_GT(sigma_of(window, Unknown::Kind::joint_position), 0);
    }
  }
}

TEST(StatedNumbers, BeforeAnyDataAreTheScenesAndBoundTheCandidate) {
  const TestFolder folder;
  const Problem problem = pendulum(folder, "",
                                   "priors: {body/ball/mass: {value: 0.37 kg, sigma: 10 g}, "
                                   "joint/hinge/damping: {sigma: 0.002}}\n");
  EXPECT_EQ(problem.scene.scene.rigid_bodies[2].mass, 0.37);
  int n = 0;
  for (const Candidate& candidate : make_candidates(problem, {})) {
    if (candidate.label() == "retune_mass at ball") {
      ++n;
      EXPECT_DOUBLE_EQ(candidate.parameters[0].prior_sigma, 0.01);
      EXPECT_EQ(candidate.parameters[0].off, 0.37);
    }
    if (candidate.label() == "retune_joint_damping at hinge") {
      ++n;
      EXPECT_EQ(candidate.parameters[0].prior_sigma, 0.002);
      EXPECT_EQ(candidate.parameters[0].off, 0.01);
    }
    if (candidate.label() == "retune_mass at tip") {
      EXPECT_EQ(candidate.parameters[0].prior_sigma, 0);
    }
  }
  EXPECT_EQ(n, 2);
}

TEST(StatedNumbers, ThatTheSceneDoesNotHaveAreRefused) {
  const TestFolder folder;
  const auto refused = [&](const std::string& keys, std::initializer_list<const char*> words,
                           const std::string& more = "") {
    expect_error<UsageError>([&] { pendulum(folder, keys, more); }, words);
  };
  refused(", set: {body/top/mass: 1}", {"b.csv", "set.body/top/mass", "body/tip/mass"});
  refused(", set: {body/tip/colour: 1}", {"set", "body/tip/colour", "is unknown here"});
  refused(", set: {body/tip/mass: 1 m}", {"set.body/tip/mass", "`m`", "kg"});
  refused(", set: {body/tip/mass: [1, 2]}", {"one number"});
  refused(", set: {body/tip/mass: {value: 1, sigma: 0.1}}", {"sigma", "priors"});
  refused(", set: {gravity: [0, 1]}", {"gravity", "three numbers"});
  refused(", initial: {joint/knee/position: 1}", {"initial.joint/knee/position", "does not have"});
  refused(", initial: {joint/hinge/colour: 1}", {"position or the velocity"});
  refused(", initial: {body/ball/velocity: 1}", {"three numbers"});
  refused(", initial: {body/base/velocity: [1, 0, 0]}", {"can move"});
  refused("", {"priors.body/ball/mass", "sigma"}, "priors: {body/ball/mass: 1}\n");
}

}  // namespace
}  // namespace pvg::diagnose
