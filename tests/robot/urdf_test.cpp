// The URDF loader: our arm, the maker's meshes, and one sentence for each way in which a file can be wrong.
#include <gtest/gtest.h>

#include <fstream>

#include "host/base/error.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/robot/kinematics.hpp"
#include "host/robot/robot.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

bool is_closed(const TriangleMesh& mesh) { return !closed_surface_defect(mesh); }

const std::string inertial =
    "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
const std::string limit = "<limit lower='-1' upper='1' velocity='1' effort='1'/>";

std::string two_links(const std::string& in_link, const std::string& in_joint, const std::string& type = "revolute") {
  return "<robot name='r'><link name='a'/><link name='b'>" + in_link + "</link><joint name='hinge' type='" + type +
         "'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>" + in_joint + "</joint></robot>";
}

std::string refusal(const fs::path& file) {
  try {
    load_urdf(file);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "(was accepted)";
}

void expect_refusal(const std::string& urdf, const std::vector<std::string>& words) {
  const TestFolder folder;
  const std::string message = refusal(folder.write("arm.urdf", urdf));
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << word << " not in: " << message;
  EXPECT_NE(message.find("arm.urdf"), std::string::npos) << message;
}

TEST(Urdf, OurArmHasThePublishedFigures) {
  const RobotModel arm = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  ASSERT_EQ(arm.actuated.size(), 7u);
  double mass = 0;
  for (const RobotLink& link : arm.links) mass += link.mass;
  EXPECT_NEAR(
      mass,
      2.3966 + 2.9274653454 + 2.9355370338 + 2.2449013699 + 2.6155955791 + 2.3271207594 + 1.8170376524 + 0.6271432862,
      1e-12);
  const RobotJoint& elbow = arm.joints[3];
  EXPECT_EQ(elbow.name, "fr3_joint4");
  EXPECT_EQ(elbow.lower, -3.0421);
  EXPECT_EQ(elbow.upper, -0.1518);
  EXPECT_EQ(elbow.velocity, 2.62);
  EXPECT_EQ(elbow.effort, 87);
  EXPECT_EQ(elbow.acceleration, 10);
  EXPECT_EQ(elbow.jerk, 5000);
  ASSERT_TRUE(elbow.envelope);
  EXPECT_EQ(elbow.envelope->lower, 3.0481);
  EXPECT_EQ(arm.noncolliding.size(), 13u);
  for (const RobotJoint& joint : arm.joints) EXPECT_EQ(joint.child, int(&joint - arm.joints.data()) + 1);
}

TEST(Urdf, OurArmsCollisionShapesAreClosedSmallAndAboutAsBigAsTheArm) {
  const RobotModel arm = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  double sum = 0;
  for (int i = 0; i < 8; ++i) {
    const TriangleMesh& shape = arm.links[i].collision;
    EXPECT_TRUE(is_closed(shape)) << arm.links[i].name;
    EXPECT_LE(shape.triangles.size(), 150u) << arm.links[i].name;
    EXPECT_GT(enclosed_volume(shape), 1e-4) << arm.links[i].name;
    sum += enclosed_volume(shape);
    for (const LinkVisual& visual : arm.links[i].visuals)
      EXPECT_EQ(visual.mesh.normals.size(), visual.mesh.points.size());
  }
  EXPECT_GT(sum, 0.008);  // 17.9 kg of aluminium and motors: some 13 litres
  EXPECT_LT(sum, 0.020);
}

TEST(Urdf, VisualNormalsPointOutOfTheirTriangles) {
  const RobotModel arm = load_urdf(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  for (const RobotLink& link : arm.links)
    for (const LinkVisual& visual : link.visuals) {
      int wrong = 0;
      for (const Triangle& t : visual.mesh.triangles) {
        const auto& p = visual.mesh.points;
        const Vec3f face = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
        for (const unsigned v : t) wrong += face.dot(visual.mesh.normals[v]) < 0;
      }
      EXPECT_LE(wrong, 0) << link.name << " " << visual.name;
    }
}

TEST(Urdf, TheMakersCollisionMeshesLoad) {
  const fs::path meshes = PVG_SHARED_FOLDER "/assets/franka_fr3/collision";
  if (!fs::exists(meshes)) GTEST_SKIP() << "the maker's meshes are not here";
  std::ifstream ours(PVG_DATA_FOLDER "/robots/fr3/fr3.urdf");
  std::string text((std::istreambuf_iterator<char>(ours)), {});
  for (int i = 0; i < 8; ++i) {
    const std::string mine = "collision/link" + std::to_string(i) + ".obj";
    text.replace(text.find(mine), mine.size(), (meshes / ("link" + std::to_string(i) + ".stl")).string());
    for (const char* kind : {"shell", "trim"}) {
      const std::string seen = "visual/link" + std::to_string(i) + "_" + kind + ".obj";
      text.replace(text.find(seen), seen.size(), (meshes / ("link" + std::to_string(i) + ".stl")).string());
    }
  }
  const TestFolder folder;
  const RobotModel arm = load_urdf(folder.write("maker.urdf", text));
  // numbers of triangles as the files' headers give them
  const std::vector<std::size_t> triangles = {374, 236, 228, 270, 262, 266, 323, 314};
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(double(arm.links[i].collision.triangles.size()), double(triangles[i]), 3) << i;  // less degenerate ones
    EXPECT_LT(arm.links[i].collision.points.size(), triangles[i]) << "equal points were not joined";
    EXPECT_GT(enclosed_volume(arm.links[i].collision), 3e-4);
  }
}

TEST(Urdf, PackagePathsPrimitivesScaleAndInertialFramesAreUnderstood) {
  const TestFolder folder;
  folder.write("my_robot/meshes/tetra.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const fs::path file = folder.write(
      "my_robot/urdf/arm.urdf",
      "<robot name='r'><link name='a'><collision><geometry><mesh filename='package://my_robot/meshes/tetra.obj' "
      "scale='0.001 0.001 -0.002'/></geometry></collision></link><link name='b'><inertial><origin xyz='0 0 1' "
      "rpy='0 0 1.5707963267948966'/><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='2' iyz='0' "
      "izz='2.5'/></inertial>"
      "<collision><geometry><box size='1 2 3'/></geometry></collision><collision><origin xyz='9 0 0'/><geometry>"
      "<sphere radius='1'/></geometry></collision><collision><origin xyz='0 9 0'/><geometry><cylinder radius='1' "
      "length='2'/></geometry></collision></link><joint name='slide' type='prismatic'><parent link='a'/><child "
      "link='b'/>"
      "<axis xyz='0 0 2'/>" +
          limit + "</joint></robot>");
  const RobotModel robot = load_urdf(file);
  EXPECT_TRUE(is_closed(robot.links[0].collision));
  EXPECT_NEAR(enclosed_volume(robot.links[0].collision), 2e-9 / 6, 1e-16);
  EXPECT_TRUE(is_closed(robot.links[1].collision));
  // polygons of 24 corners instead of circles
  EXPECT_NEAR(enclosed_volume(robot.links[1].collision), 6 + 4.0 / 3 * M_PI + 2 * M_PI, 0.02 * 16.5);
  EXPECT_LT((robot.links[1].inertia.diagonal() - Vec3(2, 1, 2.5)).norm(), 1e-12);
  EXPECT_EQ(robot.links[1].center_of_mass, Vec3(0, 0, 1));
  EXPECT_EQ(robot.joints[0].axis, Vec3::UnitZ());
  EXPECT_EQ(robot.joints[0].type, Joint::Type::prismatic);
}

TEST(Urdf, ColladaKeepsItsAxesAndItsUnit) {
  const TestFolder folder;
  folder.write(
      "tetra.dae",
      "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'><asset>"
      "<unit name='centimeter' meter='0.01'/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id='g'>"
      "<mesh><source id='p'><float_array id='a' count='12'>0 0 0 100 0 0 0 200 0 0 0 300</float_array>"
      "<technique_common><accessor source='#a' count='4' stride='3'><param name='X' type='float'/><param name='Y' "
      "type='float'/><param name='Z' type='float'/></accessor></technique_common></source><vertices id='v'><input "
      "semantic='POSITION' source='#p'/></vertices><triangles count='4'><input semantic='VERTEX' source='#v' "
      "offset='0'/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>"
      "<library_visual_scenes><visual_scene id='s'><node id='n'><instance_geometry url='#g'/></node>"
      "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>");
  const RobotModel robot = load_urdf(folder.write(
      "arm.urdf",
      "<robot name='r'><link name='a'><collision><geometry><mesh filename='tetra.dae'/></geometry></collision>"
      "</link></robot>"));
  Vec3 highest = Vec3::Zero();
  for (const Vec3& p : robot.links[0].collision.points) highest = highest.cwiseMax(p);
  EXPECT_LT((highest - Vec3(1, 2, 3)).norm(), 1e-6);
  EXPECT_NEAR(enclosed_volume(robot.links[0].collision), 1, 1e-6);
}

TEST(Urdf, AMissingFileIsNamed) {
  EXPECT_NE(refusal("/nowhere/arm.urdf").find("/nowhere/arm.urdf does not exist"), std::string::npos);
}

TEST(Urdf, AJointWithoutLimitsIsNamed) {
  expect_refusal(two_links(inertial, ""), {"joint 'hinge'", "no limits", "lower, upper, velocity and effort"});
  expect_refusal(two_links(inertial, "<limit velocity='1' effort='1'/>"), {"joint 'hinge'", "'lower'"});
  expect_refusal(two_links(inertial, "<limit lower='0' upper='1' effort='1'/>"), {"joint 'hinge'", "'velocity'"});
}

TEST(Urdf, WrongLimitsAreNamed) {
  expect_refusal(two_links(inertial, "<limit lower='1' upper='-1' velocity='1' effort='1'/>"),
                 {"joint 'hinge'", "lower limit above"});
  expect_refusal(two_links(inertial, "<limit lower='-1' upper='1' velocity='0' effort='1'/>"),
                 {"joint 'hinge'", "not positive"});
  expect_refusal(two_links(inertial, "<limit lower='-1' upper='nan' velocity='1' effort='1'/>"),
                 {"joint 'hinge'", "'upper'", "finite number"});
}

TEST(Urdf, UnphysicalMassAndInertiaAreNamed) {
  const auto with = [](const std::string& mass, const std::string& ixx) {
    return two_links("<inertial><mass value='" + mass + "'/><inertia ixx='" + ixx +
                         "' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>",
                     limit);
  };
  expect_refusal(with("-1", "1"), {"link 'b'", "mass"});
  expect_refusal(with("1", "-1"), {"link 'b'", "inertia that no body can have"});
  expect_refusal(with("1", "2.1"), {"link 'b'", "inertia that no body can have"});
  expect_refusal(two_links("", limit), {"link 'b'", "joint 'hinge'", "no mass"});
}

TEST(Urdf, AMeshThatIsMissingOrBrokenIsNamed) {
  const auto with = [](const std::string& mesh) {
    return two_links(inertial + "<collision><geometry><mesh filename='" + mesh + "'/></geometry></collision>", limit);
  };
  expect_refusal(with("none.stl"), {"link 'b'", "none.stl", "does not exist"});
  expect_refusal(with("package://none/none.stl"), {"link 'b'", "package://none/none.stl", "was found neither"});
  const TestFolder folder;
  folder.write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string message = refusal(folder.write("nan.urdf", with("nan.obj")));
  EXPECT_NE(message.find("not a finite number"), std::string::npos) << message;
  EXPECT_NE(message.find("nan.obj"), std::string::npos) << message;
  folder.write("text.stl", "this is no mesh");
  EXPECT_NE(refusal(folder.write("text.urdf", with("text.stl"))).find("could not be read"), std::string::npos);
}

TEST(Urdf, WhatIsNoTreeIsRefused) {
  const auto joint = [](const std::string& name, const std::string& a, const std::string& b) {
    return "<joint name='" + name + "' type='fixed'><parent link='" + a + "'/><child link='" + b + "'/></joint>";
  };
  const std::string links = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>";
  expect_refusal(links + joint("i", "a", "b") + joint("j", "b", "c") + joint("k", "c", "a") + "</robot>", {"loop"});
  expect_refusal(links + joint("i", "a", "b") + joint("j", "b", "c") + joint("k", "a", "c") + "</robot>",
                 {"joint 'k'", "link 'c'", "tree"});
  expect_refusal(links + joint("i", "a", "b") + "</robot>", {"'a' and 'c' are not joined"});
  expect_refusal(links + joint("i", "a", "nothing") + "</robot>", {"joint 'i'", "'nothing'", "does not exist"});
}

TEST(Urdf, WhatIsNoUrdfIsRefused) {
  expect_refusal("<robot name='r'><link name='a'></robot>", {"no valid XML", "line 1"});
  expect_refusal("<scene/>", {"no <robot>"});
  expect_refusal("<robot name='r'/>", {"no links"});
  expect_refusal(two_links(inertial, limit, "floating"), {"joint 'hinge'", "'floating'"});
}

TEST(Urdf, AMeshOfAnotherFormatIsRefused) {
  const TestFolder folder;
  folder.write("a.glb", "glTF");
  const std::string message = refusal(folder.write(
      "arm.urdf", two_links(inertial + "<visual><geometry><mesh filename='a.glb'/></geometry></visual>", limit)));
  EXPECT_NE(message.find("a.glb is of no format that is read here; give an STL, OBJ, DAE or PLY"), std::string::npos)
      << message;
}

TEST(Urdf, DeeplyNestedElementsAreRefused) {
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 200000; ++i) deep += "<a>";
  expect_refusal(deep, {"thousand elements"});
}

}  // namespace
}  // namespace pvg
