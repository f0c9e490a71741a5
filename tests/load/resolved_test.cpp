// The configuration that an episode records is read by the tables that wrote it.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "host/base/error.hpp"
#include "host/load/build_scene.hpp"
#include "host/load/scene_file.hpp"
#include "host/load/task_file.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// Equal words; numbers to 1e-12, for a rotation becomes a quaternion and back.
void expect_same(const YAML::Node& a, const YAML::Node& b, const std::string& where) {
  ASSERT_EQ(int(a.Type()), int(b.Type())) << where;
  if (a.IsScalar()) {
    double first = 0, second = 0;
    if (YAML::convert<double>::decode(a, first) && YAML::convert<double>::decode(b, second)) {
      ASSERT_LE(std::abs(first - second), 1e-12 * std::max(1.0, std::abs(first))) << where;
    } else {
      ASSERT_EQ(a.Scalar(), b.Scalar()) << where;
    }
    return;
  }
  ASSERT_EQ(a.size(), b.size()) << where;
  if (a.IsSequence())
    for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i], where + "[" + std::to_string(i) + "]");
  if (a.IsMap())
    for (const auto& entry : a) expect_same(entry.second, b[entry.first.Scalar()], where + "." + entry.first.Scalar());
}

// What read_resolved leaves out. The counts of a cloth's mesh are not read either.
YAML::Node read_part(const std::string& text) {
  YAML::Node root = YAML::Load(text);
  root.remove("drawn");
  for (YAML::Node cloth : root["cloths"]) cloth.remove("points"), cloth.remove("triangles");
  return root;
}

void expect_read_again(const Task& task, const TaskScene& built) {
  const std::string text = resolved_yaml(task, built);
  const Task again = read_resolved(text, task.file);
  expect_same(read_part(text), read_part(resolved_yaml(again, {})), task.name);
  ASSERT_EQ(again.objects.size(), task.objects.size());
  EXPECT_EQ(again.textures, task.textures);
  ASSERT_EQ(again.gripper.has_value(), task.gripper.has_value());
  if (task.gripper) {
    EXPECT_EQ(again.gripper->fingers[0].mesh, task.gripper->fingers[0].mesh);
  }
}

TEST(Resolved, EveryTaskIsReadAgainAsItWasWritten) {
  for (const auto& entry : fs::directory_iterator(fs::path(PVG_DATA_FOLDER) / "tasks")) {
    const Task task = load_task(entry.path());
    expect_read_again(task, {});
  }
}

TEST(Resolved, EverySceneIsReadAgainAsItWasWritten) {
  for (const char* folder : {"scenes", "validation", "bench"})
    for (const auto& entry : fs::directory_iterator(fs::path(PVG_DATA_FOLDER) / folder))
      if (entry.path().extension() == ".yaml") expect_read_again(load_scene_file(entry.path()).task, {});
}

TEST(Resolved, HoldsSizeVariationsAndTheRobotOfAHandsCondition) {
  Task task = load_task(fs::path(PVG_DATA_FOLDER) / "tasks/weigh_beaker.yaml");
  task.objects[0].size = 1.25;
  task.variations = {{Variation::Quantity::camera_rotation, "front", {-0.01, 0.02}},
                     {Variation::Quantity::disturbance, "gripper_base", {-0.03, 0.02}}};
  task.variations[1].times = 4;
  task.variations[1].turn = {-0.1, 0.1};
  task.variations[1].duration = {0.25, 0.5};
  task.variations[1].during = {"lift", "wait"};
  Condition moved;
  moved.quantity = Condition::Quantity::moved_in_hand;
  moved.robot = 1;
  moved.at_most = 0.005;
  task.success = {moved};
  const std::string text = resolved_yaml(task, {});
  EXPECT_EQ(YAML::Load(text)["success"][0]["robot"].as<int>(), 1);
  const Task again = read_resolved(text, task.file);
  EXPECT_EQ(again.objects[0].size, 1.25);
  ASSERT_EQ(again.variations.size(), 2u);
  EXPECT_EQ(again.variations[0].quantity, Variation::Quantity::camera_rotation);
  EXPECT_EQ(again.variations[0].of, "front");
  EXPECT_EQ(again.variations[0].range.low, -0.01);
  EXPECT_EQ(again.variations[0].range.high, 0.02);
  EXPECT_EQ(again.variations[1].range.low, -0.03);
  EXPECT_EQ(again.variations[1].times, 4);
  EXPECT_EQ(again.variations[1].turn.low, -0.1);
  EXPECT_EQ(again.variations[1].duration.high, 0.5);
  EXPECT_EQ(again.variations[1].during, (std::vector<std::string>{"lift", "wait"}));
}

TEST(Resolved, ADamagedConfigurationIsNamed) {
  expect_error<UsageError>([] { read_resolved("robot: [", "states.h5"); }, {"states.h5", "make the record again"});
  expect_error<UsageError>([] { read_resolved("contact: {stiffness: soft}", "states.h5"); },
                           {"states.h5:1", "`configuration.contact.stiffness`"});
}

}  // namespace
}  // namespace pvg
