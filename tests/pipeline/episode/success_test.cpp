// Success is judged on states made by hand: each condition fails on its own, and the first to fail is named.
#include "pipeline/episode/success.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pvg {
namespace {

using Quantity = Condition::Quantity;
using When = Condition::When;

Condition condition(Quantity quantity, const std::string& of, When when) {
  Condition condition;
  condition.quantity = quantity;
  condition.of = of;
  condition.when = when;
  return condition;
}

Condition at_least(Quantity quantity, const std::string& of, double bound, When when = When::end) {
  Condition made = condition(quantity, of, when);
  made.at_least = bound;
  return made;
}

Condition at_most(Quantity quantity, const std::string& of, double bound, When when = When::end) {
  Condition made = condition(quantity, of, when);
  made.at_most = bound;
  return made;
}

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
    task.success = {at_least(Quantity::lifted, "beaker", 0.1, When::some_time),
                    at_most(Quantity::position_error, "beaker", 0.01), at_most(Quantity::tilt, "beaker", 0.1),
                    at_most(Quantity::held, "beaker", 0),
                    at_most(Quantity::slip_in_hand, "beaker", 0.005, When::always)};
    task.success[1].target = "scale";
    task.success[1].target_position = Vec3(0, 0, 0.05);
    task.failure = {at_least(Quantity::moved_in_hand, "beaker", 0.01, When::some_time)};
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

  static void observe(SuccessMonitor& monitor, const WorldState& state, Phase phase) {
    monitor.observe(state, std::span(&phase, 1));
  }

  // a good episode, with one thing that may go wrong in each place
  SuccessMonitor run(double height, const Vec3& slip, const WorldState& end) {
    SuccessMonitor monitor(task, scene, hands, state);
    observe(monitor, state, Phase::free);
    observe(monitor, holding(state), Phase::holding);
    observe(monitor, holding(at(Vec3(0.5, 0, height))), Phase::holding);
    observe(monitor, holding(at(Vec3(0.4, 0.1, height))), Phase::carrying);
    observe(monitor, holding(at(Vec3(0.3, 0.2, height), 0, slip)), Phase::carrying);
    observe(monitor, holding(at(Vec3(0.3, 0.2, 0.05))), Phase::holding);
    observe(monitor, end, Phase::free);
    return monitor;
  }

  Scene scene;
  Task task;
  std::vector<Hand> hands = {{2, {4}}};  // the finger follows four rigid bodies
  WorldState state, good_end = at(Vec3(0.304, 0.2, 0.053));
};

TEST_F(Success, AGoodEpisodeSucceedsAndIsMeasured) {
  const SuccessMonitor monitor = run(0.12, Vec3(0, 0, 0.0008), good_end);
  EXPECT_EQ(monitor.failure(), std::nullopt);
  EXPECT_NEAR(monitor.measured()["lifted_m"], 0.12, 1e-12);
  EXPECT_NEAR(monitor.measured()["position_error_m"], 0.005, 1e-12);  // (4, 0, 3) mm
  EXPECT_NEAR(monitor.measured()["slip_in_hand_m"], 0.0008, 1e-12);
  EXPECT_NEAR(monitor.measured()["moved_in_hand_m"], 0.0008, 1e-12);
  EXPECT_NEAR(monitor.measured()["tilt_rad"], 0, 1e-7);
}

TEST_F(Success, EachConditionFailsOnItsOwnAndSaysSo) {
  const auto reason = [](const SuccessMonitor& monitor) { return monitor.failure().value_or("none"); };
  EXPECT_EQ(reason(run(0.09, Vec3::Zero(), good_end)),
            "beaker: lifted is at most 90.0 mm, wanted is at least 100.0 mm");
  EXPECT_EQ(reason(run(0.12, Vec3(0, 0, 0.011), good_end)), "beaker: moved in hand is at least 10.0 mm at 0.00 s");
  EXPECT_EQ(reason(run(0.12, Vec3(0, 0, 0.006), good_end)),
            "beaker: slip in hand is between 0.0 mm and 6.0 mm, wanted is at most 5.0 mm at all times");
  EXPECT_EQ(reason(run(0.12, Vec3::Zero(), holding(good_end))), "beaker: held ends at 1, wanted is at most 0");
  EXPECT_EQ(reason(run(0.12, Vec3::Zero(), at(Vec3(0.3, 0.2, 0.05), 0.2))),
            "beaker: tilt ends at 11.5 degrees, wanted is at most 5.7 degrees");
  EXPECT_EQ(reason(run(0.12, Vec3::Zero(), at(Vec3(0.32, 0.2, 0.05)))),
            "beaker: position error ends at 20.0 mm, wanted is at most 10.0 mm");
}

TEST_F(Success, ADoorCountsByItsJointsAngle) {
  Joint hinge;
  hinge.name = "hinge";
  hinge.type = Joint::Type::revolute;
  scene.joints.push_back(hinge);
  task.success = {at_least(Quantity::joint_angle, "hinge", 1.0)};
  for (const double angle : {0.99, 1.01}) {
    SuccessMonitor monitor(task, scene, hands, state);
    WorldState opened = state;
    opened.joint_position = {angle};
    observe(monitor, opened, Phase::free);
    EXPECT_EQ(monitor.failure().has_value(), angle < 1) << angle;
    EXPECT_DOUBLE_EQ(monitor.measured()["joint_angle_rad"], angle);
  }
}

// 3 x 3 points, 0.1 m apart
struct FoldedCloth : Success {
  FoldedCloth() {
    Cloth towel;
    towel.name = "towel";
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) towel.mesh.points.push_back(Vec3(0.1 * i, 0.1 * j, 0));
    scene.cloths.push_back(towel);
    state.cloth = {towel.mesh.points};
  }
};

TEST_F(FoldedCloth, CornersCountByTheirDistance) {
  task.success = {at_most(Quantity::corner_distance, "towel", 0.03)};
  task.success[0].first = Vec3(0.01, 0, 0);
  task.success[0].second = Vec3(0.2, 0.19, 0);
  SuccessMonitor monitor(task, scene, hands, state);
  observe(monitor, state, Phase::free);
  EXPECT_NEAR(monitor.measured()["corner_distance_m"], 0.2 * std::sqrt(2), 1e-12);
  EXPECT_TRUE(monitor.failure().has_value());
  WorldState folded = state;
  folded.cloth[0][0] = Vec3(0.2, 0.2, 0) + Vec3(0.012, 0.016, 0);  // 20 mm from the opposite corner
  observe(monitor, folded, Phase::free);
  EXPECT_NEAR(monitor.measured()["corner_distance_m"], 0.020, 1e-12);
  EXPECT_EQ(monitor.failure(), std::nullopt);
  folded.cloth[0][0].x() = std::nan("");
  observe(monitor, folded, Phase::free);
  EXPECT_TRUE(monitor.failure().has_value());
}

TEST_F(FoldedCloth, EdgesCountByTheirLargestDistance) {
  task.success = {at_most(Quantity::edge_distance, "towel", 0.04)};
  task.success[0].first_end = Vec3(0.2, 0, 0);
  task.success[0].second = Vec3(0, 0.2, 0);
  task.success[0].second_end = Vec3(0.2, 0.2, 0);
  SuccessMonitor monitor(task, scene, hands, state);
  WorldState folded = state;
  for (int i = 0; i < 3; ++i) folded.cloth[0][std::size_t(i)] = folded.cloth[0][std::size_t(6 + i)];
  folded.cloth[0][1] += Vec3(0, 0, 0.039);  // the middle stands off most
  observe(monitor, folded, Phase::free);
  EXPECT_NEAR(monitor.measured()["edge_distance_m"], 0.039, 1e-12);
  EXPECT_EQ(monitor.failure(), std::nullopt);
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
  SuccessMonitor monitor(task, scene, hands, state);
  observe(monitor, holding(state), Phase::holding);
  observe(monitor, holding(at(Vec3(0.5, 0, 0.12))), Phase::carrying);
  WorldState lagging = at(Vec3(0.4, 0, 0.12), 0, Vec3(0, 0, 0.005));
  lagging.soft[0][1] = Vec3(0.4, 0, 0.22);
  observe(monitor, holding(lagging), Phase::carrying);
  EXPECT_NEAR(monitor.measured()["slip_in_hand_m"], 0, 1e-12);
  EXPECT_NEAR(monitor.measured()["moved_in_hand_m"], 0.005, 1e-12);
}

TEST_F(Success, ABodyThatDoesNotExistIsNamed) {
  task.success[1].target = "stove";
  try {
    SuccessMonitor monitor(task, scene, hands, state);
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "a condition names `stove`, but the scene has no body of that name; correct the name");
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
  const auto of_one = [](const std::vector<std::vector<Phase>>& of_steps) {
    std::vector<Phase> list;
    for (const std::vector<Phase>& of_robots : of_steps) list.push_back(of_robots.at(0));
    return list;
  };
  EXPECT_EQ(of_one(phases(elements, {0, 0, 1, 2, 3, 3, 4, 5, 6}, 1)),
            (std::vector<Phase>{Phase::free, Phase::free, Phase::free, Phase::holding, Phase::carrying, Phase::carrying,
                                Phase::holding, Phase::free, Phase::free}));
}

TEST(Phases, RobotsThatMoveTogetherHaveEachTheirOwn) {
  using Type = MotionElement::Type;
  const std::vector<MotionElement> elements = {{.type = Type::close, .robot = 1},
                                               {.type = Type::carry, .robot = 0},
                                               {.type = Type::carry, .robot = 1, .is_with_previous = true},
                                               {.type = Type::open, .robot = 1}};
  EXPECT_EQ(phases(elements, {0, 1, 3}, 2),
            (std::vector<std::vector<Phase>>{
                {Phase::free, Phase::free}, {Phase::free, Phase::carrying}, {Phase::free, Phase::free}}));
}

}  // namespace
}  // namespace pvg
