// The motion of every task of data/tasks, as it is written for the arms: planned for some draws, each sample of it
// inside the makers' limits, by differences that are made here anew.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "host/base/error.hpp"
#include "host/load/task_file.hpp"
#include "host/robot/joint_path.hpp"
#include "pipeline/episode/motion_plan.hpp"
#include "tests/expect_error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct TaskMotion : testing::TestWithParam<const char*> {};

// of the arm's joint i at step k; it rests before the first and after the last
struct Column {
  const std::vector<std::vector<double>>& targets;
  double home;
  std::size_t column;
  double at(std::ptrdiff_t k) const {
    if (k < 0) return home;
    return targets[std::min(std::size_t(k), targets.size() - 1)][column];
  }
};

TEST_P(TaskMotion, IsPlannedAndKeepsEveryLimitAtEverySample) {
  const Task task = load_task(fs::path(PVG_DATA_FOLDER) / "tasks" / (std::string(GetParam()) + ".yaml"));
  const std::vector<RobotCell> robots = robots_of(task);
  for (const std::uint64_t episode : {0, 1}) {
    const TaskScene built = build_scene(task, 7, episode);
    const MotionPlan plan = plan_episode(task, built);
    const double h = task.solver.time_step;
    std::size_t column = 0;
    for (const RobotCell& cell : robots) {
      const RobotModel model = load_urdf(cell.robot.urdf);
      for (std::size_t i = 0; i < model.actuated.size(); ++i) {
        const RobotJoint& joint = model.joints[std::size_t(model.actuated[i])];
        const Column q{plan.targets, cell.robot.home[i], column + i};
        for (std::ptrdiff_t k = 0; k < std::ptrdiff_t(plan.targets.size()) + 3; ++k) {
          const double v = (q.at(k) - q.at(k - 1)) / h;
          const double a = (q.at(k) - 2 * q.at(k - 1) + q.at(k - 2)) / (h * h);
          const double j = (q.at(k) - 3 * q.at(k - 1) + 3 * q.at(k - 2) - q.at(k - 3)) / (h * h * h);
          ASSERT_GE(q.at(k), joint.lower);
          ASSERT_LE(q.at(k), joint.upper);
          ASSERT_LE(std::abs(v),
                    std::max(velocity_limit(joint, q.at(k), v > 0), velocity_limit(joint, q.at(k - 1), v > 0)))
              << joint.name << " step " << k;
          ASSERT_LE(std::abs(a), 10) << joint.name << " step " << k;
          ASSERT_LE(std::abs(j), 5000) << joint.name << " step " << k;
        }
      }
      column += model.actuated.size() + cell.gripper->joints.size();
    }
    ASSERT_EQ(column, plan.targets.front().size());
    // one episode must not take minutes of motion
    EXPECT_LE(double(plan.targets.size()) * h, 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Tasks, TaskMotion,
                         testing::Values("weigh_beaker", "place_flask", "place_dish", "open_cabinet", "fold_towel",
                                         "dual_fold_towel"));

// On the vendor's bimanual mount instead of on the table: the bases of robots/fr3_duo/fr3_duo_mount/kinematics.yaml of
// franka_description, tilted outward 50 mm from the middle and 202 mm up.
TEST(TaskMotion, DualFoldTowelIsPlannedOnThePublishedMountToo) {
  Task task = load_task(fs::path(PVG_DATA_FOLDER) / "tasks/dual_fold_towel.yaml");
  const auto base = [](double y, double roll, double pitch, double yaw) {
    Pose pose(Eigen::Translation3d(0.03467, y, 0.202));
    pose.linear() = (Eigen::AngleAxisd(yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(pitch, Vec3::UnitY()) *
                     Eigen::AngleAxisd(roll, Vec3::UnitX()))
                        .toRotationMatrix();
    return pose;
  };
  RobotSection &left = task.more_robots.at(0).robot, &right = task.more_robots.at(1).robot;
  left.base = base(0.050681, -0.89334809, -0.17456074, -0.46334506);
  right.base = base(-0.050681, 0.89334809, -0.17456074, 0.46334506);
  // one the other's mirror image; the hand is mounted at -45 degrees, which the last joint takes up
  const std::vector<double> home = {-44.0, 55.8, 73.5, -141.3, -3.6, 168.2, 78.2};
  for (std::size_t i = 0; i < 7; ++i) {
    const bool is_mirrored = i % 2 == 0;
    left.home[i] = home[i] * M_PI / 180;
    right.home[i] = (i == 6 ? 90 - home[i] : is_mirrored ? -home[i] : home[i]) * M_PI / 180;
  }
  task.cloths.at(0).pose.x = {0.7, 0.7};
  const TaskScene built = build_scene(task, 7, 0);
  EXPECT_FALSE(plan_episode(task, built).targets.empty());
}

// The beaker stands on the table, whose top is at z = 0.
TEST(TaskMotion, ATargetDeepInAFixedBodyIsRefusedByName) {
  Task task = load_task(fs::path(PVG_DATA_FOLDER) / "../tests/pipeline/small_task/push_beaker.yaml");
  task.motion[1].target.translation().z() = -0.005;
  const TaskScene built = build_scene(task, 7, 0);
  EXPECT_FALSE(plan_episode(task, built).targets.empty());
  task.motion[1].target.translation().z() = -0.02;
  expect_error<UsageError>([&] { plan_episode(task, built); },
                           {"push_beaker.yaml:", "element 2 (approach", "inside of `table`, which is fixed"});
}

// The table is 40 mm thick.
TEST(TaskMotion, ATargetBehindAFixedBodyIsRefusedByName) {
  Task task = load_task(fs::path(PVG_DATA_FOLDER) / "../tests/pipeline/small_task/push_beaker.yaml");
  task.motion[1].target.translation().z() = -0.1;
  const TaskScene built = build_scene(task, 7, 0);
  expect_error<UsageError>([&] { plan_episode(task, built); },
                           {"push_beaker.yaml:", "element 2 (approach", "pass through `table`, which is fixed"});
}

// Two arms whose targets are exchanged would cross.
TEST(TaskMotion, ArmsThatWouldMeetAreRefusedByName) {
  Task task = load_task(fs::path(PVG_DATA_FOLDER) / "tasks/dual_fold_towel.yaml");
  task.motion.resize(2);
  std::swap(task.motion[0].target, task.motion[1].target);
  const TaskScene built = build_scene(task, 7, 0);
  expect_error<UsageError>([&] { plan_episode(task, built); },
                           {"dual_fold_towel.yaml", "`left/", "`right/", "closer than 10 mm", "motion[0] (move)"});
}

// Targets lead while a braked joint moves; other joints', and those of the end, are as planned.
TEST(TaskMotion, TargetsLeadByTheFrictionThatTheTaskKnows) {
  Task task = load_task(fs::path(PVG_DATA_FOLDER) / "../tests/pipeline/small_task/push_beaker.yaml");
  task.effects = {{"joint_coulomb_friction", "fr3_joint4", {8, 1e-3}}};
  const auto targets = [&] { return plan_episode(task, build_scene(task, 7, 0)).targets; };
  const std::vector<std::vector<double>> planned = targets();
  task.robot.feeds_friction_forward = true;
  const std::vector<std::vector<double>> led = targets();
  ASSERT_EQ(led.size(), planned.size());
  double most = 0;
  for (std::size_t step = 0; step < led.size(); ++step)
    for (std::size_t joint = 0; joint < led[step].size(); ++joint) {
      if (joint == 3)
        most = std::max(most, std::abs(led[step][joint] - planned[step][joint]));
      else
        ASSERT_EQ(led[step][joint], planned[step][joint]) << "joint " << joint << " step " << step;
    }
  EXPECT_NEAR(most, 8 / task.robot.drive_stiffness, 1e-9);
  EXPECT_EQ(led.back(), planned.back());
}

}  // namespace
}  // namespace pvg
