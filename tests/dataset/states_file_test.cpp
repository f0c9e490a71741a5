// states.h5 and the masks: the layout that readers rely on, and a vertex that can be rebuilt from it by hand.
#include "host/dataset/states_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <limits>

#include "host/base/error.hpp"
#include "host/dataset/masks_file.hpp"
#include "host/dataset/states_reader.hpp"
#include "host/dataset/states_record.hpp"
#include "host/hdf5/file.hpp"

namespace pvg {
namespace {

using hdf5::Shape;

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("pvg_states_" + std::to_string(getpid()) + "_" + name);
}

Scene example_scene() {
  Scene scene;
  scene.solver.time_step = 0.01;
  for (const char* name : {"link0", "beaker", "hand"}) {
    RigidBody body;
    body.name = name;
    body.collision.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    body.collision.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    scene.rigid_bodies.push_back(body);
  }
  for (const char* name : {"finger", "sponge"}) {
    SoftBody body;
    body.name = name;
    body.mesh.nodes_per_element = 4;
    body.mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    body.mesh.elements = {0, 1, 2, 3};
    body.mesh.surface = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    scene.soft_bodies.push_back(body);
  }
  Cloth towel;
  towel.name = "towel";
  towel.mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  scene.cloths.push_back(towel);
  scene.stitches.push_back({0, 2, {0}, 1e5});
  for (const double stiffness : {1e5, 0.0, 2e4}) {
    Joint joint;
    joint.name = "joint" + std::to_string(scene.joints.size());
    joint.drive.stiffness = stiffness;
    scene.joints.push_back(joint);
  }
  Camera camera;
  camera.name = "fixed";
  camera.fx = 300;
  camera.fy = 301;
  camera.cx = 160;
  camera.cy = 90;
  scene.cameras.push_back(camera);
  for (const char* name : {"table", "finger_skin"}) {
    Visual visual;
    visual.name = name;
    visual.part = std::string(name) == "table" ? "" : "gripper";
    scene.visuals.push_back(visual);
  }
  return scene;
}

WorldState example_state(double t) {
  WorldState state;
  state.time = t;
  for (int i = 0; i < 3; ++i) {
    AffineMap map = AffineMap::Zero();
    map.leftCols<3>() = Mat3::Identity();
    map(0, 1) = 0.25;  // not symmetric, so that rows and columns cannot be swapped unnoticed
    map.col(3) = Vec3(i, 10 * t, 0.5);
    state.rigid.push_back(map);
  }
  for (int i = 0; i < 2; ++i) state.soft.push_back({Vec3(t, i, 0), Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(7, 8, 9)});
  state.cloth.push_back({Vec3(0, 0, t), Vec3(1, 0, t), Vec3(0, 1, 2 * t)});
  state.joint_position = {0.1 + t, 0, 0.3 + t};
  state.joint_effort = {1 + t, 0, 3 + t};
  state.joint_stop_effort = {0, -7 - t, 0};
  state.joint_damping_effort = {0, 0, -0.5};
  state.body_force.resize(6);
  state.body_force[3] = {Vec3(1, 2, 3 + t), Vec3(0, 0.5, t)};
  if (t > 0.005) state.pair_force = {{1, 3, Vec3(0, 0, 2.5), Vec3(t, 0, 0)}};
  // step k has k contacts
  for (int i = 0; i < int(t * 100 + 0.5); ++i) {
    ContactForce contact;
    contact.kind = ContactForce::Kind::edge_edge;
    contact.first = 1;
    contact.second = 3;
    contact.gap = 1e-4 * (i + 1);
    contact.normal_force = 2.5;
    contact.friction_force = Vec3(0, 0, 1.5);
    state.contacts.push_back(contact);
  }
  return state;
}

void write_example(const std::filesystem::path& path) {
  EpisodeHeader header;
  header.task = "weigh_beaker";
  header.seed = 7;
  header.episode = 3;
  header.configuration = "task: weigh_beaker\n";
  header.versions = {{"phyvisgen", "0.1.0"}};
  header.sampled = {{"beaker/x", 0.513}};
  header.objects = {"beaker"};
  const std::vector<DisabledPair> disabled = {{ContactForce::Kind::point_triangle, 2, 3, {5, -1, -1}, {0, 1, 2}}};
  StatesFile file(path, example_scene(), header, disabled);
  StepReport report;
  report.newton = 4;
  report.min_gap = std::numeric_limits<double>::infinity();
  const Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  for (int step = 0; step < 4; ++step) {
    file.append_step(example_state(0.01 * step), report, std::vector<double>{0.2, 0.4});
    if (step % 2 == 1) file.append_frame(std::size_t(step), std::span(&pose, 1));
  }
  file.close();
}

TEST(StatesFile, KeepsWhatPushedTheTargetsApartFromThem) {
  for (const bool is_disturbed : {false, true}) {
    const auto path = scratch("disturbed.h5");
    EpisodeHeader header;
    header.is_disturbed = is_disturbed;
    const std::vector<double> push = {0.01, -0.02}, none;
    StatesFile states(path, example_scene(), header, {});
    states.append_step(example_state(0), {}, std::vector<double>{0.2, 0.4}, is_disturbed ? push : none);
    states.close();
    const hdf5::File file = hdf5::File::open(path);
    EXPECT_EQ(file.read<double>("/a").values, (std::vector<double>{0.2, 0.4}));
    ASSERT_EQ(file.has("/disturbance"), is_disturbed);
    if (is_disturbed) {
      EXPECT_EQ(file.read<double>("/disturbance").values, push);
      EXPECT_EQ(file.texts_attribute("/disturbance", "names"), file.texts_attribute("/a", "names"));
    }
  }
}

TEST(StatesFile, TheStartIsOneRowOfEachAndLeavesTheStepsAsTheyAre) {
  for (const RecordedStates kept : {RecordedStates::full, RecordedStates::float32}) {
    const auto path = scratch("start.h5");
    EpisodeHeader header;
    header.objects = {"beaker"};
    header.states = kept;
    StatesFile states(path, example_scene(), header, {});
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    pose(0, 3) = 0.7;
    states.write_start(example_state(0.25), std::span(&pose, 1));
    for (const double time : {0.125, 0.25}) states.append_step(example_state(time), {}, std::vector<double>{0.2, 0.4});
    states.close();
    const StatesRecord record(path);
    EXPECT_EQ(record.n_steps(), 2u);
    EXPECT_TRUE(record.filmed_steps().empty());
    ASSERT_TRUE(record.has_start());
    // the same state, once before the first step and once after the last
    for (const char* name : {"/q", "/T_link", "/T_rigid", "/X_gripper/finger", "/X_deform/sponge", "/X_deform/towel"}) {
      EXPECT_EQ(record.start(name), record.row(name, 1)) << name;
      EXPECT_NE(record.start(name), record.row(name, 0)) << name;
    }
    EXPECT_EQ(record.start_camera("fixed")[3], 0.7);
    std::filesystem::remove(path);
  }
}

TEST(StatesFile, HasTheLayoutThatReadersRelyOn) {
  const auto path = scratch("layout.h5");
  write_example(path);
  {
    const hdf5::File file = hdf5::File::open(path);
    const std::vector<std::pair<std::string, Shape>> expected = {{"/time", {4}},
                                                                 {"/frame_step", {2}},
                                                                 {"/q", {4, 2}},
                                                                 {"/a", {4, 2}},
                                                                 {"/torque", {4, 2}},
                                                                 {"/T_link", {4, 2, 3, 4}},
                                                                 {"/T_rigid", {4, 1, 3, 4}},
                                                                 {"/X_gripper/finger", {4, 4, 3}},
                                                                 {"/X_deform/sponge", {4, 4, 3}},
                                                                 {"/X_deform/towel", {4, 3, 3}},
                                                                 {"/mesh/towel/triangles", {1, 3}},
                                                                 {"/mesh/towel/elements", {0, 4}},
                                                                 {"/mesh/beaker/rest", {4, 3}},
                                                                 {"/mesh/beaker/elements", {0, 4}},
                                                                 {"/mesh/beaker/triangles", {4, 3}},
                                                                 {"/mesh/finger/elements", {1, 4}},
                                                                 {"/mesh/finger/body", {}},
                                                                 {"/contact/offset", {5}},
                                                                 {"/contact/points", {6, 3}},
                                                                 {"/contact/kind", {6}},
                                                                 {"/contact/gap", {6}},
                                                                 {"/contact/normal_force", {6}},
                                                                 {"/contact/friction_force", {6, 3}},
                                                                 {"/contact_disabled", {1, 9}},
                                                                 {"/joint/stop", {4, 3}},
                                                                 {"/force/net", {4, 6, 3}},
                                                                 {"/force/torque", {4, 6, 3}},
                                                                 {"/pair_force/offset", {5}},
                                                                 {"/pair_force/normal", {3, 3}},
                                                                 {"/camera/fixed/K", {2, 3, 3}},
                                                                 {"/camera/fixed/distortion", {0}},
                                                                 {"/camera/fixed/T_world_camera", {2, 4, 4}}};
    for (const auto& [name, shape] : expected) EXPECT_EQ(file.shape(name), shape) << name;
    for (const auto& [name, number] : {std::pair("schema", 1.0), {"seed", 7.0}, {"episode", 3.0}, {"h", 0.01}})
      EXPECT_EQ(file.number_attribute("/", name), number) << name;
    EXPECT_EQ(file.text_attribute("/", "task"), "weigh_beaker");
    EXPECT_EQ(file.text_attribute("/", "configuration"), "task: weigh_beaker\n");
    EXPECT_EQ(file.texts_attribute("/q", "names"), (std::vector<std::string>{"joint0", "joint2"}));
    EXPECT_EQ(file.texts_attribute("/T_link", "names"), (std::vector<std::string>{"link0", "hand"}));
    EXPECT_EQ(file.read<std::int64_t>("/frame_step").values, (std::vector<std::int64_t>{1, 3}));
    EXPECT_EQ(file.read<std::int64_t>("/contact/offset").values, (std::vector<std::int64_t>{0, 0, 1, 3, 6}));
    EXPECT_EQ(file.read<double>("/q").values[3], 0.3 + 0.01);
    EXPECT_EQ(file.read<double>("/force/net").values[3 * 3 + 2], 3);
    EXPECT_EQ(file.read<double>("/joint/stop").values[3 + 1], -7 - 0.01);
    EXPECT_EQ(file.read<std::int64_t>("/pair_force/bodies").values, (std::vector<std::int64_t>{1, 3, 1, 3, 1, 3}));
    EXPECT_EQ(file.read<double>("/camera/fixed/K").values,
              (std::vector<double>{300, 0, 160, 0, 301, 90, 0, 0, 1, 300, 0, 160, 0, 301, 90, 0, 0, 1}));
  }
  std::filesystem::remove(path);
}

TEST(StatesFile, AReaderCanRebuildEveryVertexOfARigidBody) {
  const auto path = scratch("rebuild.h5");
  write_example(path);
  {
    const hdf5::File file = hdf5::File::open(path);
    const auto body = file.read<std::int64_t>("/mesh/beaker/body").values.at(0);
    const auto source = file.read<std::int64_t>("/bodies/source").values.at(std::size_t(body));
    const auto row = std::size_t(file.read<std::int64_t>("/bodies/row").values.at(std::size_t(body)));
    const std::string data_set = file.texts_attribute("/bodies", "data_sets").at(std::size_t(source));
    ASSERT_EQ(data_set, "/T_rigid");
    const auto poses = file.read<double>(data_set);
    const auto rest = file.read<double>("/mesh/beaker/rest").values;
    const std::size_t step = 2, vertex = 2;
    const double* map = &poses.values[(step * poses.shape[1] + row) * 12];
    double x[3];
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] = map[4 * i + 3];
      for (std::size_t j = 0; j < 3; ++j) x[i] += map[4 * i + j] * rest[3 * vertex + j];
    }
    EXPECT_DOUBLE_EQ(x[0], 1 + 0.25);  // body 1 at x = 1, sheared by 0.25 per unit of y, vertex (0, 1, 0)
    EXPECT_DOUBLE_EQ(x[1], 10 * 0.02 + 1);
    EXPECT_DOUBLE_EQ(x[2], 0.5);
  }
  std::filesystem::remove(path);
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(StatesFile, ReadingsOfDisplaysComeBackAndAreMissedWhereTheSceneHasSome) {
  Scene scene = example_scene();
  const auto path = scratch("reading.h5");
  write_example(path);
  EXPECT_FALSE(hdf5::File::open(path).has("/reading"));
  scene.displays.resize(2);
  scene.displays[0].name = "beaker";
  scene.displays[1].name = "link0";
  EXPECT_THROW(StatesReader(path, scene), UsageError);
  {
    StatesFile file(path, scene, {}, {});
    for (int step = 0; step < 3; ++step) {
      WorldState state = example_state(0.01 * step);
      state.reading = {0.1 * step, 1.5};
      file.append_step(state, {}, std::vector<double>{0.2, 0.4});
    }
    file.close();
  }
  EXPECT_EQ(hdf5::File::open(path).shape("/reading"), (Shape{3, 2}));
  EXPECT_EQ(StatesReader(path, scene).state(2).reading, (std::vector<double>{0.2, 1.5}));
  scene.displays[1].name = "hand";
  EXPECT_THROW(StatesReader(path, scene), UsageError);
  std::filesystem::remove(path);
}

TEST(StatesFile, EqualEpisodesAreEqualBytes) {
  const auto first = scratch("first.h5"), second = scratch("second.h5");
  write_example(first);
  usleep(1100000);
  write_example(second);
  EXPECT_TRUE(bytes_of(first) == bytes_of(second));
  std::filesystem::remove(first);
  std::filesystem::remove(second);
}

TEST(MasksFile, PartsFollowFromInstancesAndHaveNames) {
  const auto path = scratch("masks.h5");
  {
    MasksFile masks(path, example_scene(), 3, 1);
    masks.append(std::vector<std::uint32_t>{0, 1, 2});
    masks.append(std::vector<std::uint32_t>{2, 2, 0});
    EXPECT_THROW(masks.append(std::vector<std::uint32_t>{1}), Failure);
    masks.close();
  }
  {
    const hdf5::File file = hdf5::File::open(path);
    EXPECT_EQ(file.shape("/part"), (Shape{2, 1, 3}));
    const auto parts = file.texts_attribute("/part", "names"), instances = file.texts_attribute("/instance", "names");
    EXPECT_EQ(instances, (std::vector<std::string>{"nothing", "table", "finger_skin"}));
    const auto part = file.read<std::uint8_t>("/part").values;
    std::vector<std::string> seen;
    for (const std::uint8_t p : part) seen.push_back(parts.at(p));
    EXPECT_EQ(seen, (std::vector<std::string>{"nothing", "other", "gripper", "gripper", "gripper", "nothing"}));
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace pvg
