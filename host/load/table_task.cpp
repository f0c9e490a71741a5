// The sections that only tasks have, but for joints: motion, success, failure. A resolved configuration counts robots,
// a file names them.
#include <numbers>

#include "host/load/tables.hpp"

namespace pvg {
namespace {

using Section = YamlSection;

template <class T>
auto robot_reader(const std::vector<std::string>& robots) {
  return [robots](Section& s, T& t) {
    t.robot = s.is_resolved() ? s.integer("robot", 0, 1000) : int(s.choice("robot", robots));
  };
}
template <class T>
void write_robot(YamlWriter& w, const T& t) {
  w.entry("robot", t.robot);
}

// With several robots the section names one of them. what: that it does
void demand_robot(Section& section, std::size_t n_robots, const std::string& what) {
  if (n_robots > 1 && !section.has("robot"))
    section.fail("", "lacks the key `robot`: the task has several, say " + what);
}

void normalize_axis(Section& section, Vec3& axis) {
  if (!(axis.norm() > 1e-9)) section.fail("axis", "must not have the length zero");
  axis.normalize();
}

// ---- motion

auto is_given(std::initializer_list<GivenMotion> motions) {
  return [motions = std::vector<GivenMotion>(motions)](const MotionElement& element) {
    return std::find(motions.begin(), motions.end(), kind_of(element).given) != motions.end();
  };
}

// Where the gripper's joints go: their position, or what makes the wanted width between the fingertips.
double read_opening(Section& section, const GripperSection& gripper) {
  const auto [least, most] = std::minmax(gripper.open, gripper.closed);
  if (!section.has("width")) return section.number("gripper", Unit::length, least, most);
  if (section.has("gripper")) section.fail("width", "and `gripper` exclude each other: both say how far it goes");
  if (!gripper.width_at_zero)
    section.fail("width", "needs the key `width_at_zero` in " + gripper.file.string() + "; add it, or give `gripper`");
  const double widest = *gripper.width_at_zero + double(gripper.joints.size()) * std::max(gripper.open, gripper.closed);
  const double width = section.number("width", Unit::length, *gripper.width_at_zero, widest);
  return (width - *gripper.width_at_zero) / double(gripper.joints.size());
}

void check_element(Section& section, MotionElement& element) {
  const GivenMotion given = kind_of(element).given;
  if (element.is_in_tool_frame && !element.object.empty())
    section.fail("object", "and `frame: tool` exclude each other");
  if (given == GivenMotion::path && element.path.empty()) section.fail("path", "must hold at least one pose");
  if (given == GivenMotion::duration || given == GivenMotion::gripper_position)
    section.number("duration", Unit::time, 0, 600);  // says that it is missing
  if (given == GivenMotion::arc || given == GivenMotion::path) element.is_straight = false;
  if (!element.avoids_obstacles) return;
  if (section.has("straight") && element.is_straight)
    section.fail("plan", "plans a path around obstacles, which is not straight: leave `straight` out");
  element.is_straight = false;
}

// ---- conditions

auto reads_keys(int keys) {
  return [keys](const Condition& condition) { return (kind_of(condition).keys & keys) == keys; };
}

Unit unit_of(const Condition& condition) {
  switch (kind_of(condition).unit) {
    case QuantityKind::Unit::rad:
      return Unit::angle;
    case QuantityKind::Unit::m:
      return Unit::length;
    default:
      return Unit::none;
  }
}

template <class Kinds>
std::vector<std::string> names_of(const Kinds& kinds) {
  std::vector<std::string> names;
  for (const auto& kind : kinds) names.push_back(kind.name);
  return names;
}

}  // namespace

const Fields<RecordSection>& record_fields() {
  static const Fields<RecordSection> FIELDS = Fields<RecordSection>().choice(
      "states", &RecordSection::states, RECORDED_STATES,
      "nodes of soft bodies in states.h5: `full` is every bit, `float32` rounds to less than a micrometre, `frames` "
      "keeps these of pictures only; see [states.h5](states.md#size)");
  return FIELDS;
}

Fields<MotionElement> motion_fields(const std::vector<RobotCell>& robots) {
  using E = MotionElement;
  const auto is_way = is_given({GivenMotion::target, GivenMotion::arc, GivenMotion::path});
  const auto is_arc = is_given({GivenMotion::arc}), is_path = is_given({GivenMotion::path});
  const auto is_target = is_given({GivenMotion::target}), is_grip = is_given({GivenMotion::gripper_position});
  const auto closes = [](const E& e) { return kind_of(e).grip == GripChange::closes; };
  const std::string ways = "with a target, arc or path", arc = "`follow_arc`", target = "with a target";
  static const Fields<Pose> POINT = Fields<Pose>().own_pose(std::identity{}, "of the tool");
  return Fields<E>()
      .choice("do", &E::type, names_of(MOTION_KINDS), "what the robot does: see [tasks](../guide/tasks.md)")
      .required()
      .custom({"robot", "", "the only one", "name of a robot", "who moves"}, robot_reader<E>(names_of(robots)),
              write_robot<E>)
      .reads([n = robots.size()](Section& s, E&) { demand_robot(s, n, "which one moves"); })
      .flag("is_with_previous", &E::is_with_previous, "begins and ends with the element above")
      .only_resolved()
      .text("object", &E::object, "what is given is in the frame this object has at the start; none: the world's")
      .when(is_way, ways)
      .choice("frame", &E::is_in_tool_frame, {"object", "tool"}, "`tool`: the frame the tool has when it begins")
      .when(is_way, ways)
      .number("center", &E::center, Unit::length, -REACH, REACH, "a point of the axis")
      .required()
      .when(is_arc, arc)
      .written_when(is_arc)
      .number("axis", &E::axis, Unit::none, -1e6, 1e6, "about which the tool goes; of any length")
      .required()
      .when(is_arc, arc)
      .written_when(is_arc)
      .reads([](Section& s, E& e) { normalize_axis(s, e.axis); })
      .number("angle", &E::angle, Unit::angle, -2 * std::numbers::pi, 2 * std::numbers::pi, "how far")
      .required()
      .when(is_arc, arc)
      .written_when(is_arc)
      .flag("turns", &E::turns_with_arc, "the tool turns about the axis as well")
      .when(is_arc, arc)
      .written_when(is_arc)
      .list("path", &E::path, POINT, "poses of the tool, on a smooth curve")
      .when(is_path, "`follow_path`")
      .otherwise("required")
      .written_when(is_path)
      .custom({"position", "m", "[0, 0, 0]", shown_bounds({Unit::length, -REACH, REACH}), target + ": of the tool"},
              nullptr, nullptr)
      .custom({"rotation", "rad", "[0, 0, 0]", "", target + ": roll, pitch, yaw of the tool, z along the fingers"},
              nullptr, nullptr)
      .reads([=](Section& s, E& e) {
        if (is_target(e)) e.target = read_pose(s);
      })
      .pose("target", &E::target, "of the tool")
      .only_resolved()
      .written_when([=](const E& e) { return !is_arc(e) && !is_path(e); })
      .custom(
          {"gripper", "m", "or `width`", "from `closed` to `open` of the gripper",
           "position of the gripper's joints at the end"},
          [robots](Section& s, E& e) {
            e.gripper = s.is_resolved() ? s.number("gripper", Unit::length, 0, 1)
                                        : read_opening(s, *robots[std::size_t(e.robot)].gripper);
          },
          [](YamlWriter& w, const E& e) { w.entry("gripper", e.gripper); })
      .required()
      .when(is_grip, "`close`, `open`")
      .otherwise("required, or `width`")
      .custom({"width", "m", "none", "from `width_at_zero`", "`close`, `open`: between the fingertips at the end"},
              nullptr, nullptr)
      .number("force", &E::force, Unit::force, 0, 1e4, "ends where the fingers bear so much each; 0: at `gripper` only")
      .when(closes, "`close`")
      .number("duration", &E::duration, Unit::time, 0, 600, "0: as fast as the limits allow")
      .otherwise("0; of `close`, `open`, `wait` required")
      .number("speed", &E::speed, Unit::none, 1e-3, 1, "share of the limits of velocity and acceleration")
      .when(is_way, ways)
      .flag("straight", &E::is_straight, "the tool's origin moves on a straight line")
      .when(is_target, target)
      .flag("plan", &E::avoids_obstacles, "plans a path around what stands in the scene")
      .when(is_target, target)
      .number(
          "blend_radius", &E::blend_radius, Unit::length, 0, 1,
          "goes on into the next element without a stop, while the tool is within it of the end; 0: stops and rests")
      .when(is_way, ways)
      .written_when([](const E& e) { return e.blend_radius > 0; })
      .check(check_element);
}

Fields<Condition> condition_fields(const std::vector<std::string>& robots, Condition::When otherwise) {
  using C = Condition;
  const auto of_target = reads_keys(TARGET_KEYS), of_points = reads_keys(POINT_KEYS), of_edges = reads_keys(EDGE_KEYS),
             of_robot = reads_keys(ROBOT_KEY);
  const std::string error = "`position_error`", points = "`corner_distance`, `edge_distance`", edge = "`edge_distance`";
  return Fields<C>()
      .choice("quantity", &C::quantity, names_of(QUANTITY_KINDS), "what is measured: see [tasks](../guide/tasks.md)")
      .required()
      .text("of", &C::of, "object, cloth or joint")
      .required()
      .then([otherwise](C& c) { c.when = otherwise; })
      .choice("when", &C::when, {"end", "some_time", "always"}, "when it must hold")
      .otherwise("`end`; in `failure` `some_time`")
      .custom({"robot", "", "the only one", "name of a robot", "whose hand"}, robot_reader<C>(robots), write_robot<C>)
      .when(of_robot, "`moved_in_hand`, `slip_in_hand`")
      .written_when(of_robot)
      .reads([=, n = robots.size()](Section& s, C& c) {
        if (of_robot(c)) demand_robot(s, n, "whose hand is watched");
      })
      .text("target", &C::target, "an object; none: the world")
      .when(of_target, error)
      .written_when(of_target)
      .number("target_position", &C::target_position, Unit::length, -REACH, REACH, "in the target's frame")
      .required()
      .when(of_target, error)
      .written_when(of_target)
      .number("point", &C::point, Unit::length, -REACH, REACH, "in the object's frame")
      .when(of_target, error)
      .written_when(of_target)
      .number("first", &C::first, Unit::length, -REACH, REACH, "a point of the cloth at rest; the nearest one counts")
      .required()
      .when(of_points, points)
      .written_when(of_points)
      .number("second", &C::second, Unit::length, -REACH, REACH, "another one")
      .required()
      .when(of_points, points)
      .written_when(of_points)
      .number("first_end", &C::first_end, Unit::length, -REACH, REACH, "where the edge that begins at `first` ends")
      .required()
      .when(of_edges, edge)
      .written_when(of_edges)
      .number("second_end", &C::second_end, Unit::length, -REACH, REACH, "likewise of `second`")
      .required()
      .when(of_edges, edge)
      .written_when(of_edges)
      .number("at_least", &C::at_least, unit_of, "m, rad or 1", -1e3, 1e3, "bound")
      .number("at_most", &C::at_most, unit_of, "m, rad or 1", -1e3, 1e3, "bound; at least one of the two is given")
      .check([](Section& s, C& c) {
        if (!c.at_least && !c.at_most) s.fail("", "lacks a bound: give `at_least`, `at_most` or both");
        if (c.at_least && c.at_most && *c.at_least > *c.at_most)
          s.fail("at_least", "is above `at_most`: nothing is both");
        // 5 for 5 deg would hold whatever happens
        const auto check_tilt = [&](const char* key, const std::optional<double>& bound) {
          if (!s.is_resolved() && c.quantity == C::Quantity::tilt && bound && *bound > std::numbers::pi)
            s.fail(key, "is above 180 deg, the largest tilt there is; bare numbers are in rad, write such as `5 deg`");
        };
        check_tilt("at_least", c.at_least);
        check_tilt("at_most", c.at_most);
      });
}

}  // namespace pvg
