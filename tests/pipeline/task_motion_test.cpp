// The motion of every task of data/tasks, as it is written for the arms: planned for some draws, each sample of it
// inside the makers' limits, by differences that are made here anew.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "host/robot/joint_path.hpp"
#include "host/scene/task_file.hpp"
#include "pipeline/motion_plan.hpp"

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

}  // namespace
}  // namespace pvg
