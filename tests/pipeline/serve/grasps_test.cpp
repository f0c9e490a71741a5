// Phases and events from contacts, with a hand of two fingers and one object whose states are written by hand.
#include "pipeline/serve/grasps.hpp"

#include <gtest/gtest.h>

namespace pvg {
namespace {

constexpr int OBJECT = 0, TABLE = 1, HAND = 2, LEFT = 3, RIGHT = 4;

struct GraspsOfTwoFingers : testing::Test {
  GraspsOfTwoFingers() {
    for (const char* name : {"cup", "table", "hand", "left", "right"}) {
      built.scene.rigid_bodies.emplace_back();
      built.scene.rigid_bodies.back().name = name;
    }
    built.scene.rigid_bodies[TABLE].is_fixed = true;
    for (const char* name : {"left_slide", "right_slide", "elbow"}) {
      built.scene.joints.emplace_back();
      built.scene.joints.back().name = name;
    }
    for (int joint : {0, 1}) built.scene.joints[std::size_t(joint)].initial = 0.04;
    BuiltRobot robot;
    robot.arm = {2};
    robot.gripper = {0, 1};
    robot.gripper_base = HAND;
    robot.gripper_bodies = {HAND};
    robot.rigid_fingers = {LEFT, RIGHT};
    built.robots = {robot};
  }

  // width: of the gripper [m]; touching: pairs of bodies; height: of the object [m]
  WorldState at(double time, double width, std::vector<std::array<int, 2>> touching, double height = 0) const {
    WorldState state;
    state.time = time;
    state.rigid.assign(5, AffineMap::Zero());
    for (AffineMap& map : state.rigid) map.leftCols<3>() = Mat3::Identity();
    state.rigid[OBJECT](2, 3) = height;
    state.joint_position = {width / 2, width / 2, 0};
    state.joint_stop_effort = {0, 0, 0};
    for (const auto& [first, second] : touching) {
      ContactForce contact;
      contact.first = first;
      contact.second = second;
      state.contacts.push_back(contact);
    }
    return state;
  }

  static std::vector<std::string> names(const Grasps& grasps) {
    std::vector<std::string> names;
    for (const EpisodeEvent& event : grasps.events()) names.push_back(event.name + " " + event.of);
    return names;
  }

  TaskScene built;
};

TEST_F(GraspsOfTwoFingers, AnObjectIsHeldFromRestAndCarriedWhenNothingElseTouchesIt) {
  Grasps grasps(built);
  const auto phase_after = [&](const WorldState& state) {
    grasps.observe(state);
    return grasps.phase()[0];
  };
  EXPECT_EQ(phase_after(at(0.02, 0.08, {{OBJECT, TABLE}})), Phase::free);
  // still closing: 1 mm in 20 ms
  EXPECT_EQ(phase_after(at(0.04, 0.06, {{OBJECT, TABLE}, {LEFT, OBJECT}, {OBJECT, RIGHT}})), Phase::free);
  EXPECT_EQ(phase_after(at(0.06, 0.06, {{OBJECT, TABLE}, {LEFT, OBJECT}})), Phase::free);  // one finger
  EXPECT_EQ(phase_after(at(0.08, 0.06, {{OBJECT, TABLE}, {LEFT, OBJECT}, {OBJECT, RIGHT}})), Phase::holding);
  EXPECT_EQ(phase_after(at(0.10, 0.06, {{LEFT, OBJECT}, {OBJECT, RIGHT}})), Phase::carrying);
  EXPECT_EQ(names(grasps), (std::vector<std::string>{"grasped cup", "carried cup"}));
  EXPECT_EQ(phase_after(at(0.12, 0.06, {{LEFT, OBJECT}, {OBJECT, RIGHT}}, -0.011)), Phase::carrying);
  EXPECT_EQ(grasps.events().back().name, "slipped");
  EXPECT_EQ(phase_after(at(0.14, 0.06, {}, -0.02)), Phase::free);
  EXPECT_EQ(phase_after(at(0.16, 0.06, {{LEFT, OBJECT}}, -0.029)), Phase::free);
  EXPECT_EQ(grasps.events().back().name, "slipped");
  EXPECT_EQ(phase_after(at(0.18, 0.06, {}, -0.031)), Phase::free);  // 11 mm below where it was let go of
  EXPECT_EQ(grasps.events().back().name, "dropped");
  EXPECT_NEAR(grasps.events().back().time, 0.18, 1e-12);
}

TEST_F(GraspsOfTwoFingers, WhatIsPutDownFromAnotherHeightIsNotDropped) {
  Grasps grasps(built);
  for (int step = 1; step <= 2; ++step) grasps.observe(at(0.02 * step, 0.06, {{LEFT, OBJECT}, {OBJECT, RIGHT}}, 0.1));
  ASSERT_EQ(grasps.phase()[0], Phase::carrying);
  grasps.observe(at(0.06, 0.07, {}, 0.1));
  grasps.observe(at(0.08, 0.08, {{OBJECT, TABLE}}, 0.0995));
  grasps.observe(at(0.10, 0.08, {}, 0.05));  // it tips over later
  EXPECT_EQ(names(grasps), (std::vector<std::string>{"grasped cup", "carried cup"}));
}

TEST_F(GraspsOfTwoFingers, APushByAnOpenHandIsNoGraspAndAReleaseOnTheTableNoDrop) {
  Grasps grasps(built);
  for (int step = 1; step <= 3; ++step)
    grasps.observe(at(0.02 * step, 0.08, {{OBJECT, TABLE}, {LEFT, OBJECT}, {OBJECT, RIGHT}}));
  EXPECT_EQ(grasps.phase()[0], Phase::free);
  for (int step = 4; step <= 5; ++step)
    grasps.observe(at(0.02 * step, 0.06, {{OBJECT, TABLE}, {LEFT, OBJECT}, {OBJECT, RIGHT}}));
  EXPECT_EQ(grasps.phase()[0], Phase::holding);
  grasps.observe(at(0.12, 0.06, {{OBJECT, TABLE}}));
  EXPECT_EQ(names(grasps), (std::vector<std::string>{"grasped cup"}));
}

TEST_F(GraspsOfTwoFingers, ABumpAndAStopAreNamedOnce) {
  Grasps grasps(built);
  WorldState state = at(0.02, 0.08, {{HAND, TABLE}, {LEFT, TABLE}});
  state.joint_stop_effort[2] = -3;
  grasps.observe(state);
  grasps.observe(state);
  EXPECT_EQ(names(grasps), (std::vector<std::string>{"bumped table", "at_stop elbow"}));
}

}  // namespace
}  // namespace pvg
