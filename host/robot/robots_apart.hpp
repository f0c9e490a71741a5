// Do several robots keep away from each other, and each from itself, in the whole of their motion? Every sample of
// their trajectories is looked at, by FCL's distances between the meshes of the links and of what the flanges carry.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/robot/kinematics.hpp"
#include "host/robot/path_planner.hpp"

namespace pvg {

// One robot's shape. Its gripper keeps the opening that it is given with.
struct RobotShape {
  std::string name;  // empty where there is but one
  const RobotModel& model;
  Pose base = Pose::Identity();   // of its base link, to world
  int link = -1;                  // that carries
  std::vector<Obstacle> carried;  // by that link
};

struct Encounter {
  std::size_t step = 0;
  std::string first, second;  // parts, with their robot's name before them where there are several
};

// The first step in which two of them, or two parts of one, are closer than the clearance; nothing: none are.
// q: of each robot [n_steps, >= n_actuated, rad], of which the first columns are the arm's. A robot that stands still
// where the step before was free is not looked at again.
std::optional<Encounter> first_encounter(std::span<const RobotShape> robots, std::span<const Eigen::MatrixXd> q,
                                         double clearance = 0.01);

}  // namespace pvg
