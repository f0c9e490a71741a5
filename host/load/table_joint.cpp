// The rows that the joints of scenes and of tasks share, and the table of those of tasks.
#include <fmt/format.h>

#include "host/load/fields/doubtful_numbers.hpp"
#include "host/load/tables.hpp"

namespace pvg {
namespace {

using J = JointSection;
const std::string COORDINATE = "`revolute`, `prismatic`";

void read_limits(YamlSection& section, J& read) {
  Joint& joint = read.joint;
  const double largest = largest_coordinate(joint.type);
  const std::vector<double> limits = section.numbers("limits", coordinate_unit(joint.type), -largest, largest);
  if (limits.size() != 2 || !(limits[0] < limits[1])) section.fail("limits", "must be [lowest, highest]");
  if (turns(joint.type)) tell_of_many_turns(section, "limits");
  joint.lower = limits[0];
  joint.upper = limits[1];
  if (joint.initial < joint.lower || joint.initial > joint.upper)
    section.fail("limits", fmt::format("do not hold {:g}, where the joint starts", joint.initial));
}

}  // namespace

const Fields<J>& joint_ends_fields() {
  static const Fields<J> FIELDS = Fields<J>()
                                      .name(
                                          [](auto& j) -> auto& { return j.joint.name; }, "of the joint")
                                      .choice(
                                          "type", [](auto& j) -> auto& { return j.joint.type; },
                                          {"fixed", "revolute", "prismatic", "spherical"}, "what it leaves free")
                                      .required()
                                      .text("parent", &J::parent, "one of the two")
                                      .required()
                                      .text("child", &J::child, "the other one, which it lets move")
                                      .required()
                                      .number(
                                          "axis", [](auto& j) -> auto& { return j.joint.axis; }, Unit::none, -1e6, 1e6,
                                          "in the joint's frame; of any length")
                                      .required()
                                      .when(has_coordinate, COORDINATE)
                                      .reads([](YamlSection& s, J& j) {
                                        if (!(j.joint.axis.norm() > 1e-9))
                                          s.fail("axis", "must not have the length zero");
                                        j.joint.axis.normalize();
                                      });
  return FIELDS;
}

const Fields<J>& joint_frame_fields() {
  static const Fields<J> FIELDS =
      Fields<J>()
          .custom({"limits", "rad or m", "none", "-1000 to 1000 rad, -100 to 100 m",
                   "`[lowest, highest]` of the coordinate; the one at the start lies between"},
                  read_limits, nullptr)
          .when(has_coordinate, COORDINATE)
          .number(
              "lower", [](auto& j) -> auto& { return j.joint.lower; }, Unit::none, -1e3, 1e3, "the lowest")
          .only_resolved()
          .number(
              "upper", [](auto& j) -> auto& { return j.joint.upper; }, Unit::none, -1e3, 1e3, "the highest")
          .only_resolved()
          .number(
              "damping", [](auto& j) -> auto& { return j.joint.damping; },
              [](const J& j) { return turns(j.joint.type) ? Unit::angular_damping : Unit::damping; },
              "N m s/rad or N s/m", 0, LARGEST_JOINT_NUMBER, "of the joint itself")
          .when(has_coordinate, COORDINATE)
          .number(
              "armature", [](auto& j) -> auto& { return j.joint.armature; },
              [](const J& j) { return turns(j.joint.type) ? Unit::inertia : Unit::mass; }, "kg m^2 or kg", 0, 1e6,
              "inertia of what turns with the coordinate, such as a geared rotor")
          .when(has_coordinate, COORDINATE)
          .pose(
              "parent_frame", [](auto& j) -> auto& { return j.joint.parent_frame; }, "the joint in the parent's frame");
  return FIELDS;
}

const Fields<J>& task_joint_fields() {
  static const Fields<J> FIELDS =
      Fields<J>().include(joint_ends_fields(), std::identity{}).include(joint_frame_fields(), std::identity{});
  return FIELDS;
}

}  // namespace pvg
