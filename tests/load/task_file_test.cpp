// Every file in data/ loads; one change to the task file that makes it wrong is named with its place.
#include "host/load/task_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "host/base/error.hpp"
#include "host/formats/mesh_files.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/load/build_scene.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

const fs::path DATA = PVG_DATA_FOLDER;
const fs::path WEIGH_BEAKER = DATA / "tasks/weigh_beaker.yaml";

std::vector<fs::path> files(const fs::path& folder, const std::string& suffix) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == suffix) found.push_back(entry.path());
  }
  return found;
}

// A task file with one text replaced, in a folder from which its relative paths still lead to data/.
struct Spoiled {
  TestFolder folder;
  fs::path file;
  Spoiled(const std::string& from, const std::string& to, const fs::path& task = WEIGH_BEAKER) {
    std::stringstream text;
    text << std::ifstream(task).rdbuf();
    std::string content = text.str();
    const std::size_t at = content.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    content.replace(at, from.size(), to);
    for (std::size_t i = content.find("../"); i != std::string::npos; i = content.find("../", i))
      content.replace(i, 3, DATA.string() + "/");
    file = folder.write("task.yaml", content);
  }
};

void expect_refused(const std::string& from, const std::string& to, std::initializer_list<const char*> words) {
  const Spoiled spoiled(from, to);
  expect_error<UsageError>([&] { load_task(spoiled.file); }, words);
}

TEST(DataFiles, EveryTaskSceneAndGripperLoads) {
  ASSERT_FALSE(files(DATA / "tasks", ".yaml").empty());
  for (const fs::path& file : files(DATA / "tasks", ".yaml"))
    EXPECT_NO_THROW(build_scene(load_task(file), 1, 0)) << file;
  for (const fs::path& file : files(DATA / "scenes", ".yaml")) EXPECT_NO_THROW(load_scene(file)) << file;
  for (const fs::path& file : files(DATA / "grippers", ".yaml")) EXPECT_NO_THROW(load_gripper(file)) << file;
}

TEST(DataFiles, EveryMeshLoadsAndThoseForSimulationAreClosed) {
  for (const char* folder : {"objects", "grippers", "backgrounds"}) {
    for (const fs::path& file : files(DATA / folder, ".obj")) {
      EXPECT_FALSE(read_visual_mesh(file).triangles.empty()) << file;
      const bool is_open = file.parent_path().filename() == "lab";  // a room seen from inside
      EXPECT_EQ(is_open, closed_surface_defect(read_surface(file)).has_value()) << file;
    }
  }
}

TEST(TaskFile, WeighBeakerSaysWhatItShould) {
  const Task task = load_task(WEIGH_BEAKER);
  EXPECT_EQ(task.name, "weigh_beaker");
  EXPECT_LE(task.solver.time_step, 0.02);
  EXPECT_EQ(task.robot.home.size(), 7u);
  EXPECT_DOUBLE_EQ(task.robot.home[1], -M_PI / 4);
  ASSERT_TRUE(task.gripper);
  EXPECT_EQ(task.gripper->fingers.size(), 2u);
  EXPECT_DOUBLE_EQ(task.gripper->fingers[0].material.youngs_modulus, 1e7);
  ASSERT_EQ(task.objects.size(), 3u);
  EXPECT_EQ(task.objects[2].name, "beaker");
  EXPECT_DOUBLE_EQ(task.objects[2].pose.yaw.high, 10 * M_PI / 180);
  EXPECT_EQ(task.motion.size(), 8u);
  ASSERT_EQ(task.success.size(), 5u);
  EXPECT_EQ(task.success[0].quantity, Condition::Quantity::lifted);
  EXPECT_EQ(task.success[0].when, Condition::When::some_time);
  EXPECT_GE(task.success[0].at_least, 0.10);
  EXPECT_EQ(task.success[1].target, "scale");
  EXPECT_LE(task.success[1].at_most, 0.010);
  ASSERT_EQ(task.failure.size(), 1u);
  EXPECT_EQ(task.failure[0].when, Condition::When::some_time);
  ASSERT_EQ(task.cameras.size(), 2u);
  EXPECT_TRUE(task.cameras[1].records_gripper_mask);
}

TEST(TaskFile, AConditionOfAHandNamesItsRobotAndTheResolvedFileKeepsIt) {
  const fs::path two_arms = DATA / "tasks/dual_fold_towel.yaml";
  const std::string held = "{quantity: held, of: towel, at_most: 0}";
  for (const std::string quantity : {"slip_in_hand", "moved_in_hand"}) {
    const std::string condition = "{quantity: " + quantity + ", of: table, at_most: 1 mm";
    const Spoiled named(held, condition + ", robot: right}", two_arms), unnamed(held, condition + "}", two_arms);
    const Task task = load_task(named.file);
    EXPECT_EQ(task.success.back().robot, 1) << quantity;
    const std::string resolved = resolved_yaml(task, build_scene_at_middle(task));
    const std::string entry = "quantity: " + quantity + "\n    of: table\n    when: end\n    robot: 1\n";
    EXPECT_NE(resolved.find(entry), std::string::npos) << quantity;
    expect_error<UsageError>([&] { load_task(unnamed.file); }, {"`success[2]`", "`robot`", "whose hand"});
  }
}

TEST(TaskFile, CameraLooksWhereItIsTold) {
  const Task task = load_task(WEIGH_BEAKER);
  // front camera: from (1.20, -0.42, 0.50) to (0.40, 0.03, 0.19), that point lies on its z axis
  const Vec3 seen = task.cameras[0].pose.inverse() * Vec3(0.40, 0.03, 0.19);
  EXPECT_NEAR(seen.x(), 0, 1e-12);
  EXPECT_NEAR(seen.y(), 0, 1e-12);
  EXPECT_NEAR(seen.z(), std::hypot(0.80, 0.45, 0.31), 1e-12);
  // what is higher in the world is higher in the picture, where y points down
  EXPECT_LT((task.cameras[0].pose.inverse() * Vec3(0.40, 0.03, 0.29)).y(), -0.05);
  EXPECT_NEAR(task.cameras[0].pose.linear().determinant(), 1, 1e-12);
}

TEST(TaskFile, MistakesAreNamedWithTheirPlace) {
  expect_refused("time_step: 20 ms", "time_step: 20 mm", {"task.yaml:5", "`time_step`", "`mm`", "s, ms"});
  expect_refused("time_step: 20 ms", "time_step: 30 ms", {"`time_step`", "between 1e-06 and 0.02"});
  expect_refused("time_step: 20 ms", "time_step: 20 ms\ntimestep: 1",
                 {"task.yaml:6", "`timestep`", "unknown", "time_step"});
  expect_refused("schema: 1", "schema: 2", {"`schema`", "must be 1"});
  expect_refused("robot:", "robots:", {"`robot`"});
  expect_refused("density: 2230 kg/m^3", "density: -2230 kg/m^3", {"`objects[2].density`", "-2230"});
  expect_refused("density: 2230 kg/m^3", "mass: 0.1\n    density: 2230",
                 {"`objects[2]`", "either `density` or `mass`"});
  expect_refused("objects/beaker.obj", "objects/cup.obj", {"`objects[2].mesh`", "cup.obj", "does not exist"});
  expect_refused("fixed: true", "fixed: maybe", {"`objects[0].fixed`", "true or false"});
  expect_refused("material: glass}", "material: ice}", {"`ice`", "`materials`"});
  expect_refused("do: lift, object: beaker", "do: lift, object: flask", {"`motion`", "`flask`"});
  expect_refused("density: 2230 kg/m^3", "densty: 2230 kg/m^3", {"`objects[2].densty`", "unknown"});
  expect_refused("home: [0, -45 deg", "home: [0, -45", {"`robot.home`", "-45 rad", "`-45 deg`"});
  expect_refused("do: lift", "do: levitate", {"`motion[3].do`", "levitate", "approach"});
  expect_refused("target: scale", "target: shelf", {"`success`", "`shelf`"});
  expect_refused("second: finger_left", "second: thumb", {"`pair_friction`", "`thumb`"});
  expect_refused("mount: gripper_base", "mount: elbow", {"`cameras`", "`wrist`", "elbow", "gripper_base"});
  expect_refused("width: 640", "width: 641", {"`cameras[0].width`", "even"});
  expect_refused("edge_u: [0, 0.6, 0]", "edge_u: [0.6, 0, 0]", {"`lights[0].edge_u`", "rectangle"});
  expect_refused("x: [0.48, 0.52]", "x: [0.52, 0.48]", {"`objects[2].pose.x`", "low <= high"});
  expect_refused("name: glass, kind: dielectric", "name: steel, kind: dielectric", {"`materials[2].name`", "steel"});
}

TEST(TaskFile, AnElementOfTheMotionKnowsItsLine) {
  const Spoiled whole("do: lift", "do: lift");
  std::ifstream in(whole.file);
  std::string line;
  int number = 1;
  while (std::getline(in, line) && line.find("do: lift") == std::string::npos) ++number;
  EXPECT_EQ(load_task(whole.file).motion.at(3).place, whole.file.string() + ":" + std::to_string(number));
}

// the pads of gripper.yaml are 4 mm apart at joint position 0, and each of the two joints adds its own: 4 + 2 x 28 = 60
TEST(TaskFile, AGripperClosesToAWidth) {
  const Spoiled by_width("close, gripper: 28 mm", "close, width: 60 mm");
  EXPECT_NEAR(load_task(by_width.file).motion.at(2).gripper, 0.028, 1e-15);
  expect_refused("close, gripper: 28 mm", "close, gripper: 28 mm, width: 60 mm", {"`motion[2].width`", "`gripper`"});
  expect_refused("close, gripper: 28 mm", "close, width: 3 mm", {"`motion[2].width`", "between 0.004 and 0.084"});
  expect_refused("close, gripper: 28 mm", "close", {"`motion[2].gripper`"});
  // the joints of gripper.yaml go from 0 (closed) to 40 mm (open)
  expect_refused("close, gripper: 28 mm", "close, gripper: 41 mm", {"`motion[2].gripper`", "between 0 and 0.04"});
}

TEST(TaskFile, WrongNumberOfHomeAnglesIsNamed) {
  const Spoiled spoiled("home: [0, ", "home: [");
  const Task task = load_task(spoiled.file);
  expect_error<UsageError>([&] { build_scene(task, 1, 0); }, {"`robot.home`", "6 numbers", "7 moving joints"});
}

TEST(TaskFile, ObjectWithAHoleIsNamed) {
  const TestFolder folder;
  const auto mesh = folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  Task task = load_task(WEIGH_BEAKER);
  task.objects[2].mesh = mesh;
  expect_error<UsageError>([&] { build_scene(task, 1, 0); }, {"open.obj", "holes"});
}

}  // namespace
}  // namespace pvg
