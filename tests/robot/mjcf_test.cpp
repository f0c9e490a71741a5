// The reader of MJCF: every number by hand, and one sentence for what is not supported.
#include <gtest/gtest.h>

#include <numbers>

#include "host/base/error.hpp"
#include "host/robot/multibody.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

const char* const ARM = R"(<mujoco model="two">
  <compiler angle="radian"/>
  <option timestep="0.001" gravity="0 0 -10"/>
  <default>
    <joint damping="0.2"/>
    <position kv="3"/>
    <default class="light"><geom density="500"/><joint armature="0.01"/></default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1" pos="0 0 -2"/>
    <body name="upper" pos="0 0 1">
      <joint name="shoulder" axis="0 2 0" range="-1 2"/>
      <geom type="box" size="0.05 0.1 0.2" pos="0 0 -0.2"/>
      <body name="lower" pos="0 0 -0.4" childclass="light">
        <joint name="elbow" axis="0 1 0" pos="0 0 0.1" frictionloss="0.3" stiffness="2" springref="0.5" ref="0.1"/>
        <geom type="sphere" size="0.1" pos="0 0 -0.3"/>
        <geom type="cylinder" size="0.02" fromto="0 0 0 0 0 -0.3" mass="1" contype="0" conaffinity="0"/>
        <body name="tip" pos="0 0 -0.4"/>
      </body>
    </body>
  </worldbody>
  <actuator><position joint="shoulder" kp="50" gear="2" forcerange="-7 7"/></actuator>
</mujoco>
)";

Multibody read(const std::string& text) {
  const TestFolder folder;
  return read_mjcf(folder.write("arm.xml", text));
}

void expect_refused(const std::string& from, const std::string& to, std::initializer_list<const char*> words) {
  std::string text = ARM;
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  expect_error<UsageError>([&] { read(text); }, words);
}

TEST(Mjcf, BodiesHaveTheirPlacesMassesAndInertias) {
  const Multibody model = read(ARM);
  ASSERT_EQ(model.bodies.size(), 3u);  // the tip has no mass: it is only a place on the lower link
  EXPECT_EQ(model.bodies[0].kind, MultibodyBody::Kind::half_space);
  EXPECT_EQ(model.bodies[0].pose.translation(), Vec3(0, 0, -2));
  const MultibodyBody& upper = model.bodies[1];
  EXPECT_NEAR(upper.mass, 8, 1e-12);  // 0.1 x 0.2 x 0.4 m of water
  EXPECT_TRUE(upper.center_of_mass.isApprox(Vec3(0, 0, -0.2), 1e-12));
  EXPECT_TRUE(upper.inertia.isApprox(Mat3(Vec3(0.4 / 3, 0.34 / 3, 0.1 / 3).asDiagonal()), 1e-12)) << upper.inertia;
  const MultibodyBody& lower = model.bodies[2];
  const double ball = 500 * 4 * std::numbers::pi / 3 * 1e-3, mass = ball + 1;
  EXPECT_NEAR(lower.mass, mass, 1e-12);
  EXPECT_NEAR(lower.center_of_mass[2], -(0.3 * ball + 0.15) / mass, 1e-12);
  EXPECT_NEAR(lower.inertia(2, 2), 0.4 * ball * 0.01 + 0.5 * 4e-4, 1e-12);
  EXPECT_NEAR(lower.inertia(0, 0), 0.4 * ball * 0.01 + (3 * 4e-4 + 0.09) / 12 + ball / mass * 0.15 * 0.15, 1e-12);
  EXPECT_EQ(lower.shapes.size(), 1u);  // the cylinder collides with nothing
  EXPECT_TRUE(lower.pose.translation().isApprox(Vec3(0, 0, 0.6), 1e-12));
}

TEST(Mjcf, JointsTakeWhatTheirClassesSay) {
  const Multibody model = read(ARM);
  ASSERT_EQ(model.joints.size(), 2u);
  const MultibodyJoint &shoulder = model.joints[0], &elbow = model.joints[1];
  EXPECT_EQ(shoulder.joint.parent, -1);
  EXPECT_EQ(shoulder.joint.axis, Vec3(0, 1, 0));
  EXPECT_EQ(shoulder.joint.lower, -1);
  EXPECT_EQ(shoulder.joint.upper, 2);
  EXPECT_EQ(shoulder.joint.damping, 0.2);
  EXPECT_EQ(shoulder.armature, 0);
  EXPECT_EQ(elbow.joint.parent, 1);
  EXPECT_EQ(elbow.joint.damping, 0.2);
  EXPECT_EQ(elbow.armature, 0.01);
  EXPECT_EQ(elbow.coulomb, 0.3);
  EXPECT_EQ(elbow.spring, 2);
  EXPECT_EQ(elbow.spring_preload, 1);  // 2 N m/rad x 0.5 rad
  EXPECT_EQ(elbow.joint.initial, 0.1);
  EXPECT_TRUE(elbow.joint.parent_frame.translation().isApprox(Vec3(0, 0, -0.3), 1e-12));
  EXPECT_NEAR(elbow.joint.parent_frame.linear()(0, 2), std::sin(-0.1), 1e-12);
}

TEST(Mjcf, PositionServosCountInTheJointsUnits) {
  const Drive drive = read(ARM).joints[0].joint.drive;
  EXPECT_EQ(drive.mode, Drive::Mode::position);
  EXPECT_EQ(drive.stiffness, 200);  // kp gear^2
  EXPECT_EQ(drive.damping, 12);     // kv gear^2
  EXPECT_EQ(drive.effort_limit, 14);
}

TEST(Mjcf, GeneralActuatorsAreServosOrMotors) {
  const auto drive_of = [](const std::string& actuator) {
    std::string text = ARM;
    const std::string from = R"(<position joint="shoulder" kp="50" gear="2" forcerange="-7 7"/>)";
    text.replace(text.find(from), from.size(), actuator);
    text.replace(text.find(R"(<position kv="3"/>)"), 18, R"(<general biastype="affine"/>)");
    return read(text).joints[0];
  };
  const MultibodyJoint servo =
      drive_of(R"(<general joint="shoulder" gainprm="9" biasprm="0 -9 -2" dyntype="filter" dynprm="0.05"/>)");
  EXPECT_EQ(servo.joint.drive.stiffness, 9);
  EXPECT_EQ(servo.joint.drive.damping, 2);
  EXPECT_EQ(servo.actuator_lag, 0.05);
  const Drive speed = drive_of(R"(<velocity joint="shoulder" kv="4"/>)").joint.drive;
  EXPECT_EQ(speed.mode, Drive::Mode::velocity);
  EXPECT_EQ(speed.damping, 4);
  const Drive motor = drive_of(R"(<motor joint="shoulder" gear="30" ctrlrange="-1 1"/>)").joint.drive;
  EXPECT_EQ(motor.mode, Drive::Mode::torque);
  EXPECT_EQ(motor.effort_limit, 30);
  expect_error<UsageError>([&] { drive_of(R"(<general joint="shoulder" gainprm="9" biasprm="0 -8"/>)"); },
                           {"arm.xml:22", "kp in gainprm"});
}

TEST(Mjcf, StartsAtTheNearestEndOfItsRange) {
  std::string text = ARM;
  text.replace(text.find("range=\"-1 2\""), 12, "range=\"0.5 2\"");
  const Multibody model = read(text);
  EXPECT_EQ(model.joints[0].joint.initial, 0.5);
  // the elbow's body hangs 0.4 m below the shoulder, which has turned by half a radian about y
  EXPECT_TRUE(
      model.bodies[2].pose.translation().isApprox(Vec3(-0.4 * std::sin(0.5), 0, 1 - 0.4 * std::cos(0.5)), 1e-12));
}

TEST(Mjcf, DegreesAreTheDefaultAndIncludedFilesAreRead) {
  const TestFolder folder;
  folder.write("body.xml",
               R"(<mujoco><body name="b"><joint range="-90 45"/><geom size="0.1" euler="90 0 0"/></body></mujoco>)");
  const Multibody model =
      read_mjcf(folder.write("arm.xml", R"(<mujoco><worldbody><include file="body.xml"/></worldbody></mujoco>)"));
  ASSERT_EQ(model.joints.size(), 1u);
  EXPECT_EQ(model.joints[0].joint.name, "b_joint");
  EXPECT_NEAR(model.joints[0].joint.lower, -std::numbers::pi / 2, 1e-15);
}

TEST(Mjcf, BodiesOfOneGroupAndItsCarrierPassThroughEachOther) {
  const Multibody model = read(R"(<mujoco><worldbody><body name="a"><joint name="j"/><geom size="0.1"/>
    <body name="b" pos="1 0 0"><geom size="0.1"/><body name="c" pos="1 0 0"><joint/><geom size="0.1"/>
    <body name="d" pos="1 0 0"><joint/><geom size="0.1"/></body></body></body></body></worldbody></mujoco>)");
  ASSERT_EQ(model.bodies.size(), 4u);
  EXPECT_EQ(model.joints[1].joint.type, Joint::Type::fixed);  // a and b are one group: c is carried by both
  ASSERT_EQ(model.noncolliding.size(), 1u);                   // a and c; the other pairs have joints, or may collide
  EXPECT_EQ(model.noncolliding[0], (std::array<int, 2>{0, 2}));
}

TEST(Mjcf, WhatIsNotSupportedIsNamedWithItsLine) {
  expect_refused("</worldbody>", "</worldbody><tendon>\n<fixed/></tendon>",
                 {"arm.xml:22", "of <tendon> is not supported"});
  expect_refused("timestep", "wind='1 0 0' timestep", {"arm.xml:3", "wind"});
  expect_refused("<joint name=\"shoulder\"", "<joint name='x'/><joint name=\"shoulder\"",
                 {"`upper`", "several joints"});
  expect_refused("type=\"sphere\"", "type='sdf'", {"arm.xml:16", "the type sdf"});
  expect_refused("axis=\"0 2 0\"", "axis='0 0 0'", {"arm.xml:12", "`shoulder`", "axis"});
  expect_refused("kp=\"50\"", "kp='x'", {"kp", "1 finite number"});
  expect_refused("joint=\"shoulder\" kp", "joint='knee' kp", {"`knee`", "no hinge or slide"});
  expect_refused("forcerange=\"-7 7\"", "forcerange='-7 8'", {"forcerange", "[-a, a]"});
  expect_refused("childclass=\"light\"", "childclass='heavy'", {"arm.xml:15", "class"});
  expect_refused("</mujoco>", "", {"arm.xml", "no valid XML"});
  expect_refused("0.05 0.1 0.2", "0.05 0.1", {"arm.xml:13", "size", "3 finite numbers"});
}

}  // namespace
}  // namespace pvg
