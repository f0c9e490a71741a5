// A robot in a scene: bodies where forward kinematics puts them, joints that close, masses that add up.
#include "host/robot/add_robot.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <set>

#include "host/base/error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

const RobotModel& fr3() {
  static const RobotModel model = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  return model;
}

const VectorXd home = (VectorXd(7) << 0, -0.6, 0.1, -2.3, 0.2, 1.8, 0.8).finished();
const Pose base = Eigen::Translation3d(0.1, -0.2, 0.3) * Eigen::AngleAxisd(0.4, Vec3::UnitZ());

RobotModel two_finger_gripper() {
  const std::string inertial =
      "<inertial><mass value='0.1'/><inertia ixx='1e-4' ixy='0' ixz='0' iyy='1e-4' iyz='0' izz='1e-4'/></inertial>";
  const auto slide = [](const std::string& name, const std::string& side) {
    return "<joint name='slide_" + name + "' type='prismatic'><parent link='hand'/><child link='carriage_" + name +
           "'/><origin xyz='0 0 0.05'/><axis xyz='0 " + side +
           " 0'/><limit lower='0' upper='0.04' velocity='0.1' effort='40'/></joint>";
  };
  const TestFolder folder;
  return load_urdf(folder.write("gripper.urdf", "<robot name='gripper'><link name='hand'>" + inertial +
                                                    "</link><link name='carriage_left'>" + inertial +
                                                    "</link><link name='carriage_right'>" + inertial + "</link>" +
                                                    slide("left", "1") + slide("right", "-1") + "</robot>"));
}

// At the start a joint's two frames differ by its motion alone.
double gap(const Scene& scene, const Joint& joint) {
  RobotJoint motion;
  motion.type = joint.type;
  motion.axis = joint.axis;
  const Pose parent = scene.rigid_bodies[joint.parent].pose * joint.parent_frame;
  const Pose child = scene.rigid_bodies[joint.child].pose * joint.child_frame;
  return ((parent * joint_motion(motion, joint.initial)).matrix() - child.matrix()).norm();
}

TEST(AddRobot, BodiesStandWhereForwardKinematicsPutsThemAndJointsClose) {
  Scene scene;
  const AddedRobot added = add_robot(scene, fr3(), base, home);
  ASSERT_EQ(scene.rigid_bodies.size(), 8u);  // the massless flange is part of link 7
  ASSERT_EQ(scene.joints.size(), 7u);
  const std::vector<Pose> expected = link_poses(fr3(), home, base);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Pose pose = scene.rigid_bodies[added.body[i]].pose * added.link_in_body[i];
    EXPECT_LT((pose.matrix() - expected[i].matrix()).norm(), 1e-14) << fr3().links[i].name;
  }
  for (const Joint& joint : scene.joints) EXPECT_LT(gap(scene, joint), 1e-13) << joint.name;
  EXPECT_TRUE(scene.rigid_bodies[0].is_fixed);
  EXPECT_FALSE(scene.rigid_bodies[1].is_fixed);
  EXPECT_EQ(scene.joints[6].drive.effort_limit, 12);
  EXPECT_EQ(scene.noncolliding_rigid_bodies.size(), 13u);
  EXPECT_EQ(scene.visuals.size(), 16u);
  EXPECT_EQ(scene.materials.size(), 2u);
}

TEST(AddRobot, AGripperIsCarriedByAFixedJointAndItsDrivesFollowTheArms) {
  Scene scene;
  const AddedRobot added = add_robot(scene, fr3(), base, home);
  const int flange = fr3().link("fr3_link8");
  const Pose mount = added.link_in_body[flange] * Eigen::AngleAxisd(0.3, Vec3::UnitZ());
  const AddedRobot gripper = attach_robot(scene, added.body[flange], mount, two_finger_gripper(),
                                          Eigen::Vector2d(0.03, 0.03), {.prefix = "g_"});
  ASSERT_EQ(scene.joints.size(), 10u);
  EXPECT_EQ(scene.joints[7].type, Joint::Type::fixed);
  EXPECT_EQ(gripper.joints, (std::vector<int>{8, 9}));
  for (const Joint& joint : scene.joints) EXPECT_LT(gap(scene, joint), 1e-13) << joint.name;
  EXPECT_EQ(scene.rigid_bodies[gripper.body[0]].name, "g_hand");
  const Vec3 left = scene.rigid_bodies[gripper.body[1]].pose.translation();
  const Vec3 right = scene.rigid_bodies[gripper.body[2]].pose.translation();
  EXPECT_NEAR((left - right).norm(), 0.06, 1e-12);
}

TEST(AddRobot, FixedJointsMergeMassCentreAndInertia) {
  // two unit masses with unit inertia, one metre apart along x: each is half a metre from the common centre
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
  const TestFolder folder;
  const RobotModel model = load_urdf(folder.write(
      "two.urdf", "<robot name='r'><link name='a'>" + inertial + "</link><link name='b'>" + inertial +
                      "</link><joint name='j' type='fixed'><parent link='a'/><child link='b'/><origin xyz='1 0 0' "
                      "rpy='0 0 1'/></joint></robot>"));
  Scene merged, kept;
  add_robot(merged, model, Pose::Identity(), VectorXd());
  add_robot(kept, model, Pose::Identity(), VectorXd(), {.keeps_fixed_joints = true});
  ASSERT_EQ(merged.rigid_bodies.size(), 1u);
  EXPECT_EQ(merged.rigid_bodies[0].mass, 2);
  EXPECT_LT((merged.rigid_bodies[0].center_of_mass - Vec3(0.5, 0, 0)).norm(), 1e-15);
  EXPECT_LT((merged.rigid_bodies[0].inertia - Mat3(Vec3(2, 2.5, 2.5).asDiagonal())).norm(), 1e-14);
  EXPECT_EQ(kept.rigid_bodies.size(), 2u);
  ASSERT_EQ(kept.joints.size(), 1u);
  EXPECT_LT(gap(kept, kept.joints[0]), 1e-14);
}

// Distance of a point to a triangle: to the plane's foot if it lies inside, else to the nearest edge.
double distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a).normalized();
  const bool is_above =
      n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 && n.dot((a - c).cross(p - c)) >= 0;
  if (is_above) return std::abs(n.dot(p - a));
  const auto to_edge = [&](const Vec3& s, const Vec3& e) {
    const double t = std::clamp((p - s).dot(e - s) / (e - s).squaredNorm(), 0.0, 1.0);
    return (p - s - t * (e - s)).norm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

double clearance(const TriangleMesh& first, const Pose& at_first, const TriangleMesh& second, const Pose& at_second) {
  double least = 1e9;
  const Pose to_second = at_second.inverse() * at_first;
  for (const Vec3& p : first.points)
    for (const Triangle& t : second.triangles)
      least = std::min(least, distance(to_second * p, second.points[t[0]], second.points[t[1]], second.points[t[2]]));
  return least;
}

TEST(AddRobot, LinksThatMayCollideKeepApartInTheWorkingRange) {
  std::mt19937 engine(17);
  const VectorXd center = (VectorXd(7) << 0, -0.3, 0, -2.1, 0, 1.9, 0.785).finished();
  const VectorXd reach = (VectorXd(7) << 1.5, 0.6, 0.6, 0.5, 0.6, 0.6, 1.5).finished();
  Scene scene;
  const AddedRobot added = add_robot(scene, fr3(), Pose::Identity(), home);
  std::set<std::array<int, 2>> apart(scene.noncolliding_rigid_bodies.begin(), scene.noncolliding_rigid_bodies.end());
  for (const Joint& joint : scene.joints) apart.insert({joint.parent, joint.child});
  double least = 1e9;
  for (int sample = 0; sample < 40; ++sample) {
    VectorXd q = center;
    for (int i = 0; i < 7; ++i) q[i] += reach[i] * std::uniform_real_distribution(-1.0, 1.0)(engine);
    const std::vector<Pose> poses = link_poses(fr3(), q);
    for (int a = 0; a < 8; ++a)
      for (int b = a + 1; b < 8; ++b) {
        if (apart.count({a, b})) continue;
        least = std::min(least, clearance(fr3().links[a].collision, poses[a], fr3().links[b].collision, poses[b]));
        least = std::min(least, clearance(fr3().links[b].collision, poses[b], fr3().links[a].collision, poses[a]));
      }
  }
  std::printf("least clearance %.1f mm\n", 1e3 * least);
  EXPECT_GT(least, 0.002);
}

TEST(AddRobot, OnlyTheChosenLinksCollide) {
  Scene scene;
  add_robot(scene, fr3(), base, home, {.collision_links = std::vector<std::string>{"fr3_link7"}});
  for (const RigidBody& body : scene.rigid_bodies)
    EXPECT_EQ(body.collision.triangles.empty(), body.name != "fr3_link7") << body.name;
}

TEST(AddRobot, WrongNamesAndPositionsAreRefused) {
  Scene scene;
  EXPECT_THROW(add_robot(scene, fr3(), base, home, {.drives = {{"elbow", Drive{}}}}), UsageError);
  EXPECT_THROW(add_robot(scene, fr3(), base, home, {.collision_links = std::vector<std::string>{"hand"}}), UsageError);
  EXPECT_THROW(add_robot(scene, fr3(), base, VectorXd::Zero(6)), UsageError);
  EXPECT_THROW(add_robot(scene, fr3(), base, VectorXd::Zero(7)), UsageError);  // joint 4 cannot be at 0
  EXPECT_THROW(attach_robot(scene, 99, base, fr3(), home), UsageError);
}

}  // namespace
}  // namespace pvg
