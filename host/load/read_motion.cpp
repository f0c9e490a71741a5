// The sections `motion` and `joints` of a task file.
#include <algorithm>

#include "host/load/read_sections.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
constexpr double PI = std::numbers::pi;

// Which of the robots `robot` names; with one robot it may stand alone.
int read_robot_name(Section& section, const std::vector<RobotCell>& robots) {
  if (robots.size() > 1 && !section.has("robot"))
    section.fail("", "lacks the key `robot`: the task has several, say which one moves");
  std::vector<std::string> names;
  for (const RobotCell& robot : robots) names.push_back(robot.name);
  return section.has("robot") ? int(section.choice("robot", names)) : 0;
}

// Where the gripper's joints go: their position, or what makes the wanted width between the fingertips.
double read_opening(Section& section, const GripperSection& gripper) {
  if (!section.has("width")) return section.number("gripper", Unit::length, 0, 1);
  if (section.has("gripper")) section.fail("width", "and `gripper` exclude each other: both say how far it goes");
  if (!gripper.width_at_zero)
    section.fail("width", "needs the key `width_at_zero` in " + gripper.file.string() + "; add it, or give `gripper`");
  const double widest = *gripper.width_at_zero + double(gripper.joints.size()) * std::max(gripper.open, gripper.closed);
  const double width = section.number("width", Unit::length, *gripper.width_at_zero, widest);
  return (width - *gripper.width_at_zero) / double(gripper.joints.size());
}

void read_arc(Section& section, MotionElement& element) {
  element.center = section.vector("center", Unit::length, -REACH, REACH);
  element.axis = section.vector("axis", Unit::none, -1e6, 1e6);
  if (!(element.axis.norm() > 1e-9)) section.fail("axis", "must not have the length zero");
  element.axis.normalize();
  element.angle = section.number("angle", Unit::angle, -2 * PI, 2 * PI);
  element.turns_with_arc = section.boolean("turns", true);
}

void read_way(Section& section, MotionElement& element) {
  using Type = MotionElement::Type;
  element.object = section.text("object", "");
  element.is_in_tool_frame = section.choice("frame", {"object", "tool"}, 0) == 1;
  if (element.is_in_tool_frame && !element.object.empty())
    section.fail("object", "and `frame: tool` exclude each other");
  if (element.type == Type::follow_arc || element.type == Type::follow_path) element.is_straight = false;
  if (element.type == Type::follow_arc) {
    read_arc(section, element);
  } else if (element.type == Type::follow_path) {
    for (Section& point : section.sections("path")) {
      element.path.push_back(read_pose(point));
      point.done();
    }
    if (element.path.empty()) section.fail("path", "must hold at least one pose");
  } else {
    element.target = read_pose(section);
    element.is_straight = section.boolean("straight", true);
    element.avoids_obstacles = section.boolean("plan", false);
    if (element.avoids_obstacles && section.has("straight") && element.is_straight)
      section.fail("plan", "searches a way around obstacles, which is not straight: leave `straight` out");
    if (element.avoids_obstacles) element.is_straight = false;
  }
  element.duration = section.number("duration", Unit::time, 0, 600, 0);
  element.speed = section.number("speed", Unit::none, 1e-3, 1, element.speed);
}

MotionElement read_element(Section& section, const std::vector<RobotCell>& robots) {
  using Type = MotionElement::Type;
  MotionElement element;
  std::vector<std::string> names;
  for (int i = 0; i <= int(Type::follow_path); ++i) names.push_back(name_of(Type(i)));
  element.type = Type(section.choice("do", names));
  element.robot = read_robot_name(section, robots);
  if (element.type == Type::wait) {
    element.duration = section.number("duration", Unit::time, 0, 600);
  } else if (element.type == Type::close || element.type == Type::open) {
    element.gripper = read_opening(section, *robots[std::size_t(element.robot)].gripper);
    if (element.type == Type::close) element.force = section.number("force", Unit::force, 0, 1e4, 0);
    element.duration = section.number("duration", Unit::time, 0, 600);
  } else {
    read_way(section, element);
  }
  section.done();
  return element;
}

}  // namespace

std::vector<MotionElement> read_motion(Section& root, const std::vector<RobotCell>& robots) {
  std::vector<MotionElement> motion;
  for (Section& section : root.sections("motion")) {
    if (!section.has("together")) {
      motion.push_back(read_element(section, robots));
      continue;
    }
    std::vector<Section> parts = section.sections("together");
    for (std::size_t i = 0; i < parts.size(); ++i) {
      motion.push_back(read_element(parts[i], robots));
      motion.back().is_with_previous = i > 0;
      for (std::size_t k = 1; k <= i; ++k)
        if (motion[motion.size() - 1 - k].robot == motion.back().robot)
          parts[i].fail("robot", "moves twice in what goes on together; give each robot one element");
    }
    section.done();
  }
  if (motion.empty()) root.fail("", "lacks `motion`: a task has at least one motion element");
  return motion;
}

JointSection read_task_joint(Section& section) {
  JointSection read;
  Joint& joint = read.joint;
  joint.name = section.text("name");
  joint.type = Joint::Type(section.choice("type", {"fixed", "revolute", "prismatic", "spherical"}));
  read.parent = section.text("parent");
  read.child = section.text("child");
  const bool turns = joint.type == Joint::Type::revolute, moves = turns || joint.type == Joint::Type::prismatic;
  if (moves) {
    const Unit unit = turns ? Unit::angle : Unit::length;
    joint.axis = section.vector("axis", Unit::none, -1e6, 1e6);
    if (!(joint.axis.norm() > 1e-9)) section.fail("axis", "must not have the length zero");
    joint.axis.normalize();
    if (section.has("limits")) {
      const std::vector<double> limits = section.numbers("limits", unit, -1e3, 1e3);
      if (limits.size() != 2 || !(limits[0] <= 0 && 0 <= limits[1] && limits[0] < limits[1]))
        section.fail("limits", "must be [lowest, highest] around 0, where the joint starts");
      joint.lower = limits[0];
      joint.upper = limits[1];
    }
    joint.damping = section.number("damping", turns ? Unit::angular_damping : Unit::damping, 0, 1e9, 0);
  }
  joint.parent_frame = read_pose(section, "parent_frame");
  section.done();
  return read;
}

}  // namespace pvg
