// A path of an arm around the obstacles of a scene: OMPL's RRT-Connect (Kuffner & LaValle 2000) in the joint space,
// with FCL's distances between the meshes of links and obstacles. The way is shortened, and then laid as a smooth path
// that is checked again. The same question has the same answer: nothing depends on time or on what was asked before.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/model/scene.hpp"
#include "host/robot/kinematics.hpp"

namespace pvg {

// What an arm must not run into: a rigid thing of the world, or carried by a link (the gripper).
struct Obstacle {
  std::string name;
  TriangleMesh mesh;             // [m]
  Pose pose = Pose::Identity();  // to the robot's base frame, or to the link that carries it
};

class PathPlanner {
 public:
  // carried: moves with `link`; obstacles stand still. clearance: kept from everything [m]
  PathPlanner(const RobotModel& model, int link, const std::vector<Obstacle>& carried,
              const std::vector<Obstacle>& obstacles, double clearance = 0.01);
  ~PathPlanner();
  PathPlanner(PathPlanner&&) noexcept;

  // Names of the first two that are closer than the clearance in this configuration; nothing: none are.
  std::optional<std::array<std::string, 2>> collision(const VectorXd& q) const;

  // Knots of a JointPath [n, n_actuated] from one configuration to another; nothing: none was found, or one of the two
  // is in collision itself.
  std::optional<Eigen::MatrixXd> plan(const VectorXd& from, const VectorXd& to) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pvg
