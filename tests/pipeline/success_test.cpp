// Success is judged on states made by hand: each condition fails on its own, and the first to fail is named.
#include "pipeline/success.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

// object 0, target 1, tool 2, carriage 3; one finger stitched to the carriage
struct Success : testing::Test {
  Success() {
    for (const char* name : {"beaker", "scale", "base", "carriage"}) {
      RigidBody body;
      body.name = name;
      scene.rigid_bodies.push_back(body);
    }
    SoftBody finger;
    finger.name = "finger";
    finger.mesh.points = {{0, 0, 0}, {0, 0, 0.1}};
    scene.soft_bodies.push_back(finger);
    scene.stitches.push_back({0, 3, {0}, 1e5});
    conditions.object = "beaker";
    conditions.target = "scale";
    conditions.target_position = Vec3(0, 0, 0.05);
    conditions.lifted = 0.1;
    conditions.position_tolerance = 0.01;
    conditions.tilt_tolerance = 0.1;
    conditions.slip_tolerance = 0.01;
    state = at(Vec3(0.5, 0, 0));
  }

  // the hand hangs 0.2 m above the beaker; the finger's second node touches it
  static WorldState at(const Vec3& beaker, double tilt = 0, const Vec3& hand_error = Vec3::Zero()) {
    WorldState state;
    state.rigid.assign(4, AffineMap::Zero());
    for (AffineMap& map : state.rigid) map.leftCols<3>() = Mat3::Identity();
    state.rigid[0].leftCols<3>() = Eigen::AngleAxisd(tilt, Vec3::UnitX()).toRotationMatrix();
    state.rigid[0].col(3) = beaker;
    state.rigid[1].col(3) = Vec3(0.3, 0.2, 0);
    for (const std::size_t i : {2, 3}) state.rigid[i].col(3) = beaker + Vec3(0, 0, 0.2) + hand_error;
    state.soft = {{beaker + Vec3(0, 0, 0.2) + hand_error, beaker + Vec3(0, 0, 0.1) + hand_error}};
    return state;
  }

  static WorldState holding(WorldState state) {
    ContactForce contact;
    contact.first = 0;
    contact.second = 4;
    contact.point = state.soft[0][1];
    state.contacts.push_back(contact);
    return state;
  }

  // a good episode, with one thing that may go wrong in each place
  SuccessMonitor run(double height, const Vec3& slip, const WorldState& end) {
    SuccessMonitor monitor(conditions, scene, 2, state);
    monitor.observe(state, Phase::free);
    monitor.observe(holding(state), Phase::holding);
    monitor.observe(holding(at(Vec3(0.5, 0, height))), Phase::holding);
    monitor.observe(holding(at(Vec3(0.4, 0.1, height))), Phase::carrying);
    monitor.observe(holding(at(Vec3(0.3, 0.2, height), 0, slip)), Phase::carrying);
    monitor.observe(holding(at(Vec3(0.3, 0.2, 0.05))), Phase::holding);
    monitor.observe(end, Phase::free);
    return monitor;
  }

  Scene scene;
  SuccessConditions conditions;
  WorldState state, good_end = at(Vec3(0.304, 0.2, 0.053));
};

TEST_F(Success, AGoodEpisodeSucceedsAndIsMeasured) {
  const SuccessMonitor monitor = run(0.12, Vec3(0, 0, 0.0008), good_end);
  EXPECT_EQ(monitor.failure(), std::nullopt);
  EXPECT_NEAR(monitor.measured().lifted, 0.12, 1e-12);
  EXPECT_NEAR(monitor.measured().position_error, 0.005, 1e-12);  // (4, 0, 3) mm
  EXPECT_NEAR(monitor.measured().slip_in_hand, 0.0008, 1e-12);
  EXPECT_NEAR(monitor.measured().moved_in_hand, 0.0008, 1e-12);
  EXPECT_NEAR(monitor.measured().tilt, 0, 1e-7);
}

TEST_F(Success, EachConditionFailsOnItsOwnAndSaysSo) {
  const auto reason = [](const SuccessMonitor& monitor) { return monitor.failure().value_or("none"); };
  EXPECT_EQ(reason(run(0.09, Vec3::Zero(), good_end)), "beaker was lifted 90.0 mm, not 100.0 mm");
  EXPECT_EQ(reason(run(0.12, Vec3(0, 0, 0.011), good_end)), "beaker moved more than 10.0 mm in the hand at 0.00 s");
  EXPECT_EQ(reason(run(0.12, Vec3::Zero(), holding(good_end))), "beaker is still held at the end");
  EXPECT_EQ(reason(run(0.12, Vec3::Zero(), at(Vec3(0.3, 0.2, 0.05), 0.2))),
            "beaker ends tilted by 11.5 degrees, allowed are 5.7");
  EXPECT_EQ(reason(run(0.12, Vec3::Zero(), at(Vec3(0.32, 0.2, 0.05)))),
            "beaker ends 20.0 mm from its target, allowed are 10.0 mm");
}

TEST_F(Success, NotANumberIsAFailure) {
  EXPECT_TRUE(run(0.12, Vec3::Zero(), at(Vec3(0.3, std::nan(""), 0.05))).failure().has_value());
}

TEST_F(Success, FingersThatMoveWithTheirCarriageDoNotDeform) {
  const SuccessMonitor rigid = run(0.12, Vec3::Zero(), good_end);
  EXPECT_NEAR(rigid.measured().finger_deformation, 0, 1e-12);
  WorldState bent = good_end;
  bent.soft[0][1] += Vec3(0, 0.003, 0.004);
  EXPECT_NEAR(run(0.12, Vec3::Zero(), bent).measured().finger_deformation, 0.005, 1e-12);
}

TEST_F(Success, ASwingOfSoftFingersIsNoSlip) {
  // hand and finger base lag by 5 mm, the node in contact stays on the beaker
  SuccessMonitor monitor(conditions, scene, 2, state);
  monitor.observe(holding(state), Phase::holding);
  monitor.observe(holding(at(Vec3(0.5, 0, 0.12))), Phase::carrying);
  WorldState lagging = at(Vec3(0.4, 0, 0.12), 0, Vec3(0, 0, 0.005));
  lagging.soft[0][1] = Vec3(0.4, 0, 0.22);
  monitor.observe(holding(lagging), Phase::carrying);
  EXPECT_NEAR(monitor.measured().slip_in_hand, 0, 1e-12);
  EXPECT_NEAR(monitor.measured().moved_in_hand, 0.005, 1e-12);
}

TEST_F(Success, ABodyThatDoesNotExistIsNamed) {
  conditions.target = "stove";
  try {
    SuccessMonitor monitor(conditions, scene, 2, state);
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "success/target: the scene has no body named 'stove'");
  }
}

TEST(Phases, HoldingRunsFromCloseToOpen) {
  using Type = MotionElement::Type;
  std::vector<MotionElement> elements;
  for (const Type type : {Type::approach, Type::close, Type::lift, Type::carry, Type::lower, Type::open, Type::carry}) {
    MotionElement element;
    element.type = type;
    elements.push_back(element);
  }
  EXPECT_EQ(phases(elements, {0, 0, 1, 2, 3, 3, 4, 5, 6}),
            (std::vector<Phase>{Phase::free, Phase::free, Phase::free, Phase::holding, Phase::carrying, Phase::carrying,
                                Phase::holding, Phase::free, Phase::free}));
}

}  // namespace
}  // namespace pvg
