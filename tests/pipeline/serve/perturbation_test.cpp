// A perturbed task differs in what was asked for, and its episodes start as they did.
#include "pipeline/serve/perturbation.hpp"

#include <gtest/gtest.h>

#include <map>

#include "host/base/error.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/task_file.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

const Task& weigh_beaker() {
  static const Task loaded = load_task(PVG_DATA_FOLDER "/tasks/weigh_beaker.yaml");
  return loaded;
}

// without the robot: quick to build
Task objects_only() {
  Task task = weigh_beaker();
  task.robot.urdf.clear();
  task.gripper.reset();
  task.background.mesh.clear();
  for (ObjectSection& object : task.objects) object.visuals.clear();
  return task;
}

TEST(Perturbation, ChangesWhatItSaysAndNoStart) {
  const TaskScene nominal = build_scene(objects_only(), 3, 2);
  Task task = objects_only();
  for (const char* text : {"friction=0.5", "mass=2", "light=3", "camera=0.1"}) perturb(task, read_perturbation(text));
  const TaskScene changed = build_scene(task, 3, 2);
  ASSERT_EQ(changed.sampled.size(), nominal.sampled.size());
  for (std::size_t i = 0; i < nominal.sampled.size(); ++i)
    EXPECT_EQ(changed.sampled[i].value, nominal.sampled[i].value) << nominal.sampled[i].name;
  for (std::size_t i = 0; i < nominal.scene.rigid_bodies.size(); ++i) {
    EXPECT_DOUBLE_EQ(changed.scene.rigid_bodies[i].friction, 0.5 * nominal.scene.rigid_bodies[i].friction);
  }
  const RigidBody &beaker = changed.scene.rigid_bodies.back(), &before = nominal.scene.rigid_bodies.back();
  ASSERT_EQ(beaker.name, "beaker");
  EXPECT_DOUBLE_EQ(beaker.mass, 2 * before.mass);
  EXPECT_FLOAT_EQ(changed.scene.lights[0].radiance[0], 3 * nominal.scene.lights[0].radiance[0]);
  const Vec3 moved = changed.scene.cameras[0].pose.translation() - nominal.scene.cameras[0].pose.translation();
  EXPECT_NEAR(moved.norm(), 0.1, 1e-12);
}

TEST(Perturbation, OfDrivesNamesThemAll) {
  Task perturbed = weigh_beaker();
  perturb(perturbed, read_perturbation("backlash=0.01"));
  perturb(perturbed, read_perturbation("latency=0.05"));
  std::map<std::string, int> n;
  for (const Effect& effect : perturbed.effects) ++n[effect.name];
  EXPECT_EQ(n["backlash"], 7);        // of the arm
  EXPECT_EQ(n["actuator_delay"], 9);  // and of both fingers
}

TEST(Perturbation, WhatCannotBeIsRefused) {
  expect_error<UsageError>([] { read_perturbation("colour=1"); }, {"colour=1", "friction", "backlash"});
  expect_error<UsageError>([] { read_perturbation("friction"); }, {"friction", "number"});
  expect_error<UsageError>([] { read_perturbation("friction=nan"); }, {"nan"});
  expect_error<UsageError>([] { read_perturbation("latency=2"); }, {"latency=2", "0", "1"});
  Task rigid = objects_only();
  expect_error<UsageError>([&] { perturb(rigid, read_perturbation("stiffness=2")); }, {"weigh_beaker", "soft"});
}

}  // namespace
}  // namespace pvg
