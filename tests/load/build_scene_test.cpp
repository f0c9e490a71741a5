// The scene of an episode: a function of (seed, episode) alone, put together as the files say.
#include "host/load/build_scene.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <map>

#include "host/base/error.hpp"
#include "host/base/names.hpp"
#include "host/load/task_file.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

const Task& task() {
  static const Task loaded = load_task(std::string(PVG_DATA_FOLDER) + "/tasks/weigh_beaker.yaml");
  return loaded;
}

// without the robot: quick to build
const Task& objects_only() {
  static const Task loaded = [] {
    Task t = task();
    t.robot.urdf.clear();
    t.gripper.reset();
    t.background.mesh.clear();
    for (ObjectSection& object : t.objects) object.visuals.clear();
    return t;
  }();
  return loaded;
}

const TaskScene& built() {
  static const TaskScene scene = build_scene(task(), 1, 0);
  return scene;
}

const RigidBody& body(const Scene& scene, const std::string& name) {
  for (const RigidBody& b : scene.rigid_bodies) {
    if (b.name == name) return b;
  }
  throw std::logic_error("no body " + name);
}

TEST(UniformNumber, IsEvenAndDependsOnEachArgument) {
  double sum = 0, square = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double u = uniform_number(7, i, "beaker/x");
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    square += u * u;
  }
  EXPECT_NEAR(sum / n, 1.0 / 2, 5 * std::sqrt(1.0 / 12 / n));  // 5 sigma
  EXPECT_NEAR(square / n, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n));
  EXPECT_NE(uniform_number(1, 2, "a"), uniform_number(2, 1, "a"));
  EXPECT_NE(uniform_number(1, 2, "a"), uniform_number(1, 2, "b"));
  EXPECT_NE(uniform_number(1, 2, "a"), uniform_number(1, 3, "a"));
}

TEST(BuildScene, StartDependsOnSeedAndEpisodeAlone) {
  const TaskScene first = build_scene(objects_only(), 5, 3);
  build_scene(objects_only(), 9, 9);
  const TaskScene again = build_scene(objects_only(), 5, 3);
  EXPECT_EQ(body(first.scene, "beaker").pose.matrix(), body(again.scene, "beaker").pose.matrix());
  EXPECT_NE(body(first.scene, "beaker").pose.matrix(),
            body(build_scene(objects_only(), 5, 4).scene, "beaker").pose.matrix());
  EXPECT_NE(body(first.scene, "beaker").pose.matrix(),
            body(build_scene(objects_only(), 6, 3).scene, "beaker").pose.matrix());
}

TEST(BuildScene, AddingAnObjectDoesNotChangeWhatTheOthersDraw) {
  Task other = objects_only();
  other.objects.insert(other.objects.begin(), other.objects[2]);
  other.objects[0].name = "second_beaker";
  EXPECT_EQ(body(build_scene(other, 1, 0).scene, "beaker").pose.matrix(), body(built().scene, "beaker").pose.matrix());
}

// what was drawn by this name, NaN where nothing was
double drawn(const std::string& name) {
  for (const SampledValue& each : built().sampled)
    if (each.name == name) return each.value;
  return NAN;
}

TEST(BuildScene, DrawnNumbersStayInTheirRanges) {
  for (int episode = 0; episode < 100; ++episode) {
    const Vec3 p = body(build_scene(objects_only(), 1, episode).scene, "beaker").pose.translation();
    EXPECT_TRUE(p.x() >= 0.48 && p.x() <= 0.52 && p.y() >= -0.14 && p.y() <= -0.10 && p.z() == 0.0005) << p.transpose();
  }
  ASSERT_EQ(built().sampled.size(),
            11u);  // x, y, yaw of the beaker, two lights, where a camera is and how it is turned
  EXPECT_EQ(drawn("beaker/x"), body(built().scene, "beaker").pose.translation().x());
}

TEST(BuildScene, BeakerHasTheMassOfItsGlass) {
  // rings of 24 sides: a frustum of height h between radii a and b holds 12 sin(15 deg) h (a^2 + a b + b^2) / 3
  const auto frustum = [](double h, double a, double b) {
    return 12 * std::sin(M_PI / 12) * h * (a * a + a * b + b * b) / 3;
  };
  const double outer = frustum(0.003, 0.028, 0.034) + frustum(0.092, 0.034, 0.034) - frustum(0.0005, 0.028, 0);
  const double inner = frustum(0.002, 0.0284, 0.0324) + frustum(0.0905, 0.0324, 0.0324);
  const double glass = outer - inner;
  const RigidBody& beaker = body(built().scene, "beaker");
  EXPECT_NEAR(beaker.volume, glass, 1e-5 * glass);  // the file has single precision
  EXPECT_NEAR(beaker.mass, 2230 * beaker.volume, 1e-12);
  EXPECT_NEAR(beaker.center_of_mass.head<2>().norm(), 0, 1e-9);
}

TEST(BuildScene, TheScalesDisplayLiesOnItsSlopeAndLooksOut) {
  const Scene& scene = built().scene;
  ASSERT_EQ(scene.displays.size(), 1u);
  const Display& display = scene.displays[0];
  EXPECT_EQ(display.name, "scale");
  EXPECT_EQ(scene.rigid_bodies.at(std::size_t(display.rigid)).name, "scale");
  EXPECT_EQ(scene.textures.at(std::size_t(display.texture)).rgba.size(), 4u * 240 * 96);  // 60 mm x 24 mm
  // the slope falls 21 mm over 41.5 mm toward +x; figures are read from there, left to right along +y
  const Vec3 normal = Vec3(21, 0, 41.5).normalized();
  EXPECT_LT((display.pose.linear().col(0) - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_LT((display.pose.linear().col(2) - normal).norm(), 1e-4);
  EXPECT_NEAR((display.pose.translation() - Vec3(0.072, 0, 0.035)).dot(normal), 0.9e-3, 0.1e-3);  // above the plate
  const Visual& face = scene.visuals.at(scene.visuals.size() - 3);  // before the beaker and the background
  EXPECT_EQ(face.name, "scale/display");
  EXPECT_EQ(face.rigid, display.rigid);
  EXPECT_EQ(scene.materials.at(std::size_t(face.material)).emission_texture, display.texture);
}

TEST(BuildScene, ABackgroundThatIsRelitIsADiffuseSurfaceOfItsPicture) {
  using Kind = VisualMaterial::Kind;
  EXPECT_EQ(built().scene.materials.back().kind, Kind::shadow_receiver);
  Task nominal = task();
  nominal.background.is_relit = true;
  const TaskScene relit = build_scene(nominal, 1, 0);
  EXPECT_EQ(relit.scene.materials.back().name, "background");
  EXPECT_EQ(relit.scene.materials.back().kind, Kind::diffuse);
  EXPECT_EQ(relit.scene.materials.back().texture, built().scene.materials.back().texture);
  EXPECT_NE(resolved_yaml(nominal, relit).find("relit: true"), std::string::npos);  // a record says how it was shown
}

TEST(BuildScene, AnObjectWithoutABodyHasNoDisplay) {
  const std::string text = "schema: 1\nname: t\ntime_step: 20 ms\nobjects:\n  - {name: mark, visuals: [{mesh: " +
                           std::string(PVG_DATA_FOLDER) +
                           "/objects/mat_visual.obj, material: grey}], display: {width: 0.1, height: 0.1}}\n";
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("pvg_display_" + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << text;
  expect_error<UsageError>([&] { load_task(file); }, {"display", "no `mesh`"});
  std::filesystem::remove(file);
}

TEST(BuildScene, FingersFaceEachOtherAcrossTheTool) {
  const Scene& scene = built().scene;
  ASSERT_EQ(scene.soft_bodies.size(), 2u);
  const Pose tool = scene.rigid_bodies[built().robots[0].gripper_base].pose * task().gripper->tool_center;
  EXPECT_LT((tool.linear() * Vec3::UnitZ() - Vec3(0, 0, -1)).norm(), 1e-6);  // at home the fingers point down
  for (int f = 0; f < 2; ++f) {
    const double side = f == 0 ? 1 : -1;
    double nearest = INFINITY, lowest = INFINITY, highest = -INFINITY;
    for (const Vec3& p : scene.soft_bodies[f].mesh.points) {
      const Vec3 in_tool = tool.inverse() * (scene.soft_bodies[f].pose * p);
      nearest = std::min(nearest, side * in_tool.y());
      lowest = std::min(lowest, in_tool.z());
      highest = std::max(highest, in_tool.z());
    }
    EXPECT_NEAR(nearest, 0.042, 1e-9);      // open: more than the beaker's radius and 3 mm on each side
    EXPECT_NEAR(highest, 0.085 / 3, 1e-6);  // the tool is at two thirds of the height
    EXPECT_NEAR(lowest, -0.085 * 2 / 3, 1e-6);
    EXPECT_GE(scene.soft_bodies[f].mesh.points.size(), 1000u);
  }
}

TEST(BuildScene, StitchesHoldTheFootAndAreNotTooStiff) {
  for (const Stitch& stitch : built().scene.stitches) {
    const SoftBody& finger = built().scene.soft_bodies[stitch.soft];
    EXPECT_GE(stitch.nodes.size(), 30u);
    for (const std::uint32_t node : stitch.nodes) EXPECT_LE(finger.mesh.points[node].z(), 0.0005);
    EXPECT_LE(double(stitch.nodes.size()) * stitch.stiffness / finger.material.youngs_modulus, 1000);  // [m]
    EXPECT_NE(built().scene.rigid_bodies[stitch.rigid].name.find("carriage"), std::string::npos);
  }
}

TEST(BuildScene, FeetStandOffTheCarriagesByMoreThanContactReaches) {
  const Scene& scene = built().scene;
  for (const Stitch& stitch : scene.stitches) {
    const RigidBody& carriage = scene.rigid_bodies[stitch.rigid];
    double top = -INFINITY, foot = INFINITY;
    for (const Vec3& p : carriage.collision.points) top = std::max(top, p.z());
    for (const Vec3& p : scene.soft_bodies[stitch.soft].mesh.points) {
      foot = std::min(foot, (carriage.pose.inverse() * (scene.soft_bodies[stitch.soft].pose * p)).z());
    }
    EXPECT_GT(foot - top, scene.contact.activation_distance);
  }
}

TEST(BuildScene, WristCameraSeesTheToolAndTheFrontCameraTheBeaker) {
  const Scene& scene = built().scene;
  const auto pixel = [&](const Camera& camera, const Vec3& world) {
    const Pose mount = camera.rigid < 0 ? Pose::Identity() : scene.rigid_bodies[camera.rigid].pose;
    const Vec3 p = (mount * camera.pose).inverse() * world;
    EXPECT_GT(p.z(), 0);
    return Vec3(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy, p.z());
  };
  const Vec3 tool =
      (scene.rigid_bodies[built().robots[0].gripper_base].pose * task().gripper->tool_center).translation();
  const Vec3 at = pixel(scene.cameras[1], tool);
  // from (82, 0, 20) mm the camera looks at (14, 0, 125) mm; the tool, at (0, 0, 350/3) mm, is further from the
  // camera's x
  const double below = std::atan2(82, 350.0 / 3 - 20) - std::atan2(68, 105);
  EXPECT_NEAR(at.x(), 319.5, 0.01);
  EXPECT_NEAR(at.y(), 179.5 + scene.cameras[1].fy * std::tan(below), 0.01);
  const Vec3 beaker = pixel(scene.cameras[0], body(scene, "beaker").pose.translation());
  EXPECT_TRUE(beaker.x() > 40 && beaker.x() < 600 && beaker.y() > 40 && beaker.y() < 320) << beaker.transpose();
}

TEST(BuildScene, FlangeToToolAgreesWithTheGrippersPlace) {
  // the flange's published place in this posture, and the gripper turned by -45 degrees on it
  const Pose base = built().scene.rigid_bodies[built().robots[0].gripper_base].pose;
  EXPECT_LT((base.translation() - Vec3(0.306891, 0, 0.590282)).norm(), 1e-5);
  const Pose tool = base * task().gripper->tool_center;
  EXPECT_LT((tool.linear() * Vec3::UnitX() - Vec3::UnitX()).norm(), 1e-6);
  const Pose flange = base * task().gripper->mount.inverse();
  EXPECT_LT(((flange * built().robots[0].flange_to_tool).matrix() - tool.matrix()).norm(), 1e-9);
}

TEST(BuildScene, DrivesBelongToTheJointsThatTheIndicesName) {
  const Scene& scene = built().scene;
  ASSERT_EQ(built().robots[0].arm.size(), 7u);
  ASSERT_EQ(built().robots[0].gripper.size(), 2u);
  for (const int j : built().robots[0].arm) EXPECT_EQ(scene.joints[j].type, Joint::Type::revolute);
  for (const int j : built().robots[0].gripper) {
    EXPECT_EQ(scene.joints[j].type, Joint::Type::prismatic);
    EXPECT_EQ(scene.joints[j].initial, 0.040);
    EXPECT_EQ(scene.joints[j].drive.stiffness, 2e4);
  }
}

TEST(BuildScene, EmptyStitchBoxIsNamed) {
  Task other = task();
  other.gripper->fingers[1].stitch_high.z() = -0.0005;
  expect_error<UsageError>([&] { build_scene(other, 1, 0); }, {"finger_right", "stitch box", "at least 3"});
}

TEST(ResolvedYaml, HoldsDefaultsAndDrawnNumbersToTheLastBit) {
  const YAML::Node node = YAML::Load(resolved_yaml(task(), built()));
  EXPECT_EQ(node["schema"].as<int>(), 1);
  EXPECT_EQ(node["drawn"]["beaker/x"].as<double>(), drawn("beaker/x"));
  EXPECT_EQ(node["objects"][2]["affine_modulus"].as<double>(), 1e9);  // a default
  EXPECT_EQ(node["gripper"]["fingers"][1]["tetgen"]["nodes_per_element"].as<int>(), 10);
  EXPECT_EQ(node["motion"].size(), task().motion.size());
  EXPECT_EQ(node["robot"]["home"][1].as<double>(), task().robot.home[1]);
  EXPECT_EQ(resolved_yaml(task(), built()), resolved_yaml(task(), build_scene(task(), 1, 0)));
}

TEST(LoadScene, PlainSceneHasNoRobotAndStartsAtTheMiddle) {
  const Scene scene = load_scene(std::string(PVG_DATA_FOLDER) + "/scenes/beaker_on_scale.yaml");
  EXPECT_TRUE(scene.joints.empty());
  EXPECT_EQ(scene.rigid_bodies.size(), 3u);
  EXPECT_NEAR(body(scene, "beaker").pose.translation().z(), 0.055, 1e-15);
  const std::string task_path = std::string(PVG_DATA_FOLDER) + "/tasks/weigh_beaker.yaml";
  expect_error<UsageError>([&] { load_scene(task_path); }, {"`motion`", "phyvisgen generate"});
}

TEST(Variation, DrawsFactorsAndShiftsWithinTheirRangesAndPutsThemOnRecord) {
  Task nominal = task(), same = task();
  same.variations.clear();
  using Quantity = Variation::Quantity;
  nominal.variations = {{Quantity::size, "beaker", {0.9, 0.95}},
                        {Quantity::mass, "beaker", {2, 2}},
                        {Quantity::light, "front", {0.5, 0.6}},
                        {Quantity::color, "scale_body", {0.7, 0.8}},
                        {Quantity::camera_position, "front", {-0.01, 0.01}}};
  const auto drawn = [](const TaskScene& built, const std::string& name) {
    for (const SampledValue& value : built.sampled)
      if (value.name == name) return value.value;
    return -1.0;
  };
  const TaskScene plain = build_scene(same, 3, 4), varied = build_scene(nominal, 3, 4),
                  other = build_scene(nominal, 3, 5);
  const double size = drawn(varied, "beaker/size");
  EXPECT_GE(size, 0.9);
  EXPECT_LE(size, 0.95);
  EXPECT_NE(size, drawn(other, "beaker/size"));
  const auto beaker = [](const TaskScene& built) { return built.scene.rigid_bodies.back(); };
  ASSERT_EQ(beaker(plain).name, "beaker");
  EXPECT_NEAR(beaker(varied).collision.points[5].norm(), size * beaker(plain).collision.points[5].norm(), 1e-12);
  EXPECT_NEAR(beaker(varied).mass, 2 * size * size * size * beaker(plain).mass, 1e-12);
  EXPECT_NEAR(varied.scene.lights[0].radiance.x(), drawn(varied, "front/light") * plain.scene.lights[0].radiance.x(),
              1e-5);
  const Vec3 moved = varied.scene.cameras[0].pose.translation() - task().cameras[0].pose.translation();
  EXPECT_GT(moved.norm(), 1e-6);
  EXPECT_LE(moved.cwiseAbs().maxCoeff(), 0.01 * std::sqrt(3.0));
  // the pose is drawn from its own numbers, whatever else varies
  EXPECT_EQ(beaker(varied).pose.translation(), beaker(plain).pose.translation());
}

// Half as far again to the picture is a field of view of 2 atan(tan(44 deg / 2) / 1.5); its pixels per radian grow as
// much.
TEST(Variation, DrawsFocalLengthsAndTextures) {
  Task nominal = task();
  const std::filesystem::path lab = nominal.background.texture;
  using Quantity = Variation::Quantity;
  nominal.variations = {{Quantity::focal_length, "front", {1.5, 1.5}},
                        {Quantity::texture, "scale_body", {}, {lab, lab}}};
  const TaskScene varied = build_scene(nominal, 3, 4);
  EXPECT_NEAR(varied.scene.cameras[0].fy, 1.5 * built().scene.cameras[0].fy, 1e-9 * varied.scene.cameras[0].fy);
  bool is_textured = false;
  for (const VisualMaterial& material : varied.scene.materials)
    is_textured |= material.name == "scale_body" && material.texture >= 0;
  EXPECT_TRUE(is_textured);
}

TEST(Variation, ADistractorIsThereAsOftenAsAsked) {
  Task nominal = task();
  ObjectSection distractor = nominal.objects.back();
  distractor.name = "distractor";
  distractor.pose.y = {0.4, 0.4};
  nominal.objects.push_back(distractor);
  nominal.variations = {{Variation::Quantity::presence, "distractor", {}, {}, 0.25}};
  int n_present = 0;
  for (int episode = 0; episode < 64; ++episode) {
    double u = -1;
    const TaskScene scene = build_scene(nominal, 1, episode);
    for (const SampledValue& value : scene.sampled)
      if (value.name == "distractor/presence") u = value.value;
    const bool is_there = scene.scene.rigid_bodies.back().name == "distractor";
    EXPECT_EQ(is_there, u < 0.25) << u;
    n_present += is_there;
  }
  EXPECT_GE(n_present, 6);  // 16 +- 3.5
  EXPECT_LE(n_present, 26);
  nominal.variations[0].of = "beaker";  // which the motion picks up
  expect_error<UsageError>([&] { build_scene(nominal, 1, 0); }, {"presence", "beaker", "motion"});
}

// Whatever else is said of the object: entries of `vary` after its own, what it does to others, effects.
TEST(Variation, AnAbsentObjectLeavesWithAllThatIsSaidOfIt) {
  Task nominal = objects_only();
  ObjectSection distractor = nominal.objects.back();
  distractor.name = "distractor";
  nominal.objects.push_back(distractor);
  nominal.variations = {{Variation::Quantity::presence, "distractor", {}, {}, 0},
                        {Variation::Quantity::mass, "distractor", {0.5, 2}}};
  nominal.pair_restitution = {{"distractor", "beaker", 0.5}, {"beaker", "scale", 0.5}};
  nominal.effects = {
      {"linear_drag", "distractor", {1}}, {"adhesion", "beaker/distractor", {1}}, {"linear_drag", "beaker", {1}}};
  const Scene scene = build_scene(nominal, 1, 0).scene;
  EXPECT_FALSE(find_named(scene.rigid_bodies, "distractor"));
  ASSERT_EQ(scene.pair_restitution.size(), 1u);
  EXPECT_EQ(scene.pair_restitution[0].second, "scale");
  ASSERT_EQ(scene.effects.size(), 1u);
  EXPECT_EQ(scene.effects[0].target, "beaker");
}

// The start is that of the episode without pushes; every push has its own numbers.
TEST(Variation, DrawsDisturbancesOfAHandAndNothingElseChanges) {
  Task nominal = task();
  Variation push{Variation::Quantity::disturbance, "gripper_base", {-0.02, 0.02}};
  push.times = 3;
  push.duration = {0.3, 0.6};
  nominal.variations.push_back(push);
  const TaskScene plain = build_scene(task(), 3, 4), pushed = build_scene(nominal, 3, 4),
                  other = build_scene(nominal, 3, 5);
  EXPECT_TRUE(plain.disturbances.empty());
  ASSERT_EQ(pushed.disturbances.size(), 3u);
  EXPECT_EQ(pushed.sampled.size(), plain.sampled.size() + 3 * 5);
  for (const SampledValue& value : plain.sampled)
    EXPECT_TRUE(std::any_of(pushed.sampled.begin(), pushed.sampled.end(), [&](const SampledValue& same) {
      return same.name == value.name && same.value == value.value;
    })) << value.name;
  for (const Disturbance& drawn : pushed.disturbances) {
    EXPECT_EQ(drawn.of, "gripper_base");
    EXPECT_LE(drawn.by.cwiseAbs().maxCoeff(), 0.02);
    EXPECT_GE(drawn.duration, 0.3);
    EXPECT_LE(drawn.duration, 0.6);
    EXPECT_EQ(drawn.turn, Vec3::Zero());
    EXPECT_EQ(drawn.during, Variation().during);
  }
  EXPECT_NE(pushed.disturbances[0].by, pushed.disturbances[1].by);
  EXPECT_NE(pushed.disturbances[0].when, other.disturbances[0].when);
  nominal.variations.push_back(push);
  expect_error<UsageError>([&] { build_scene(nominal, 3, 4); }, {"disturbances", "gripper_base", "twice"});
  nominal.variations = {push};
  nominal.variations[0].of = "left/gripper_base";
  expect_error<UsageError>([&] { build_scene(nominal, 3, 4); }, {"left/gripper_base", "disturbance"});
}

TEST(Variation, OfSomethingThatIsNotThereIsRefused) {
  Task nominal = task();
  nominal.variations = {{Variation::Quantity::mass, "kettle", {1, 2}}};
  EXPECT_THROW(build_scene(nominal, 1, 0), UsageError);
}

TEST(RigidGripper, HasTheSameFingersAsBodiesThatDoNotBend) {
  Task rigid = task();
  rigid.gripper->is_rigid = true;
  const TaskScene built_rigid = build_scene(rigid, 1, 0);
  EXPECT_TRUE(built_rigid.scene.soft_bodies.empty());
  EXPECT_TRUE(built_rigid.scene.stitches.empty());
  ASSERT_EQ(built_rigid.robots[0].rigid_fingers.size(), 2u);
  const Scene& soft = built().scene;
  for (std::size_t k = 0; k < 2; ++k) {
    const RigidBody& finger = built_rigid.scene.rigid_bodies[std::size_t(built_rigid.robots[0].rigid_fingers[k])];
    EXPECT_EQ(finger.name, soft.soft_bodies[k].name);
    EXPECT_LT((finger.pose.matrix() - soft.soft_bodies[k].pose.matrix()).norm(), 1e-12);
    const Joint& mount = *std::find_if(built_rigid.scene.joints.begin(), built_rigid.scene.joints.end(),
                                       [&](const Joint& j) { return j.name == finger.name + "_mount"; });
    EXPECT_EQ(mount.type, Joint::Type::fixed);
  }
}

}  // namespace
}  // namespace pvg
