// The columns of a packed row, and of what a policy sees and commands: a joint, or the joints of one gripper, which are
// one number, its width. The poses of objects as numbers.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "host/model/task.hpp"

namespace pvg {

// The base of a gripper and the joints that it moves.
struct PackedToolJoints {
  std::string prefix, base;         // of the robot, such as "left/"; name of the gripper's base
  std::size_t link = 0;             // of `links`
  std::vector<std::size_t> joints;  // of `joints`
  Eigen::Matrix4d tool_center;      // tool frame in the gripper's base
};

// links: names of bodies; joints: names of those with a drive. [n_grippers]
std::vector<PackedToolJoints> find_tools(const std::vector<RobotCell>& robots, const std::vector<std::string>& links,
                                         const std::vector<std::string>& joints);

struct PackedColumn {
  std::string name;  // without slashes
  std::vector<std::size_t> joints;
  bool is_width = false;  // of a gripper: the sum of its joints
};

std::vector<PackedColumn> find_columns(const std::vector<std::string>& joints,
                                       const std::vector<PackedToolJoints>& tools);

// The same name as a column, a folder or a feature has it: `left/cup` -> `left_cup`.
std::string without_slashes(std::string name);

// What environment_state holds of an object: position [m] and quaternion x, y, z, w (w >= 0) of its affine map, whose
// nearest rotation counts.
inline constexpr std::array<const char*, 7> POSE_NUMBERS = {"x", "y", "z", "qx", "qy", "qz", "qw"};
std::array<double, 7> pose_numbers(const Eigen::Matrix<double, 3, 4>& map);

}  // namespace pvg
