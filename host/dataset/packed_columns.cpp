#include "host/dataset/packed_columns.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

namespace pvg {
namespace {

// "left/gripper_base" is the part gripper_base of the robot left
std::optional<std::string> robot_prefix(const std::string& name, const std::string& part) {
  if (name == part) return "";
  if (!name.ends_with("/" + part)) return std::nullopt;
  return name.substr(0, name.size() - part.size());
}

}  // namespace

std::string without_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

std::vector<PackedToolJoints> find_tools(const std::vector<RobotCell>& robots, const std::vector<std::string>& links,
                                         const std::vector<std::string>& joints) {
  std::vector<PackedToolJoints> tools;
  for (std::size_t link = 0; link < links.size(); ++link)
    for (const RobotCell& robot : robots) {
      if (!robot.gripper) continue;
      const GripperSection& gripper = *robot.gripper;
      const auto prefix = robot_prefix(links[link], gripper.base_link);
      if (!prefix) continue;
      PackedToolJoints tool{*prefix, links[link], link, {}, gripper.tool_center.matrix()};
      for (const std::string& name : gripper.joints) {
        const auto at = std::find(joints.begin(), joints.end(), *prefix + name);
        if (at != joints.end()) tool.joints.push_back(std::size_t(at - joints.begin()));
      }
      tools.push_back(tool);
      break;
    }
  return tools;
}

std::vector<PackedColumn> find_columns(const std::vector<std::string>& joints,
                                       const std::vector<PackedToolJoints>& tools) {
  std::vector<PackedColumn> columns;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto tool = std::find_if(tools.begin(), tools.end(), [&](const PackedToolJoints& t) {
      return std::find(t.joints.begin(), t.joints.end(), j) != t.joints.end();
    });
    if (tool == tools.end())
      columns.push_back({without_slashes(joints[j]), {j}, false});
    else if (tool->joints.front() == j)
      columns.push_back({without_slashes(tool->prefix + "gripper_width"), tool->joints, true});
  }
  return columns;
}

std::array<double, 7> pose_numbers(const Eigen::Matrix<double, 3, 4>& map) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(map.leftCols<3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Quaterniond q(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose()));
  if (q.w() < 0) q.coeffs() *= -1;
  return {map(0, 3), map(1, 3), map(2, 3), q.x(), q.y(), q.z(), q.w()};
}

}  // namespace pvg
