// The tables of `bodies`, `joints` and `stitches` of a scene file.
#include <Eigen/Eigenvalues>

#include "host/load/fields/doubtful_numbers.hpp"
#include "host/load/read_bodies.hpp"
#include "host/load/read_shapes.hpp"
#include "host/load/tables.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
using BodyKind = BodySection::Kind;

auto is_kind(std::initializer_list<BodyKind> kinds) {
  return [kinds = std::vector<BodyKind>(kinds)](const BodySection& body) {
    return std::find(kinds.begin(), kinds.end(), body.kind) != kinds.end();
  };
}

// of a real body no principal moment exceeds the sum of the other two
void read_inertia(Section& section, BodySection& body) {
  const std::vector<double> i = section.numbers("inertia", Unit::inertia, -1e9, 1e9);
  if (i.size() != 3 && i.size() != 6) section.fail("inertia", "must be [xx, yy, zz] or [xx, yy, zz, xy, xz, yz]");
  Mat3 inertia = Vec3(i[0], i[1], i[2]).asDiagonal();
  if (i.size() == 6) {
    inertia(0, 1) = inertia(1, 0) = i[3];
    inertia(0, 2) = inertia(2, 0) = i[4];
    inertia(1, 2) = inertia(2, 1) = i[5];
  }
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(moments[0] >= 1e-15)) section.fail("inertia", "must have principal moments of at least 1e-15 kg m^2");
  if (2 * moments[2] > moments.sum() * (1 + 1e-9))
    section.fail("inertia", "has a moment above the sum of the two others, which no body can have");
  body.inertia = inertia;
}

void read_center_of_mass(Section& section, BodySection& body) {
  body.center_of_mass = section.vector("center_of_mass", Unit::length, -REACH, REACH);
}

void check_last_point(Section& section, BodySection& body) {
  const std::vector<PathPoint>& path = body.path;
  if (path.size() == 1 ? path[0].time != 0 : !(path.back().time > path.end()[-2].time))
    section.fail("time", "must be 0 at the first point of a path and ascend from there");
}

void check_body(Section& section, BodySection& body) {
  tell_of_light_density(section, "density");
  if (body.kind == BodyKind::rigid && body.density.has_value() == body.mass.has_value()) {
    section.done();  // a misspelled key is the likelier reason
    section.fail("", "must have either `density` or `mass`, because it can move");
  }
  if (!(body.normal.norm() > 1e-9)) section.fail("normal", "must not have the length zero");
  if (body.kind != BodyKind::moving || !section.has("path")) return;
  if (section.has("pose")) section.fail("pose", "must not stand beside `path`, which says where the body starts");
  if (body.path.empty()) section.fail("path", "must hold at least one point");
  body.pose = body.path[0].pose;
}

// ---- joints

void read_initial(Section& section, SceneJointSection& read) {
  const double largest = largest_coordinate(read.joint.type);
  read.joint.initial = section.number("initial", coordinate_unit(read.joint.type), -largest, largest);
  if (turns(read.joint.type)) tell_of_many_turns(section, "initial");
}

void read_target(Section& section, DriveSection& drive) {
  const bool is_turn = turns(drive.type);
  Unit unit = coordinate_unit(drive.type);
  if (drive.drive.mode == Drive::Mode::velocity)
    unit = is_turn ? Unit::angular_speed : Unit::speed;
  else if (drive.drive.mode == Drive::Mode::torque)
    unit = is_turn ? Unit::torque : Unit::force;
  const double largest = largest_target(drive.type, drive.drive.mode);
  if (unit == Unit::angle) tell_of_many_turns(section, "target");
  if (!section.has("target_times")) {
    drive.target = {{0}, {section.number("target", unit, -largest, largest)}};
    return;
  }
  drive.target = {section.numbers("target_times", Unit::time, 0, 1e6),
                  section.numbers("target", unit, -largest, largest)};
  const TargetTable& table = drive.target;
  if (table.time.empty() || table.time.size() != table.value.size())
    section.fail("target", "and `target_times` must be lists of equal length, at least one entry");
  for (std::size_t i = 1; i < table.time.size(); ++i)
    if (!(table.time[i] > table.time[i - 1])) section.fail("target_times", "must ascend");
}

const Fields<DriveSection>& drive_fields() {
  using D = DriveSection;
  using Mode = Drive::Mode;
  static const Fields<D> FIELDS =
      Fields<D>()
          .then([](D& d) {
            d.is_there = true;
            d.drive.compensates_gravity = false;
          })
          .choice(
              "mode", [](auto& d) -> auto& { return d.drive.mode; }, {"position", "velocity", "torque"},
              "what the target is of")
          .number(
              "stiffness", [](auto& d) -> auto& { return d.drive.stiffness; },
              [](const D& d) { return turns(d.type) ? Unit::angular_stiffness : Unit::stiffness; }, "N m/rad or N/m", 0,
              LARGEST_JOINT_NUMBER, "toward the target")
          .when([](const D& d) { return d.drive.mode == Mode::position; }, "`position`")
          .number(
              "damping", [](auto& d) -> auto& { return d.drive.damping; },
              [](const D& d) { return turns(d.type) ? Unit::angular_damping : Unit::damping; }, "N m s/rad or N s/m", 0,
              LARGEST_JOINT_NUMBER, "toward the target's rate, see `damped_rate`")
          .when([](const D& d) { return d.drive.mode != Mode::torque; }, "`position`, `velocity`")
          .choice(
              "damped_rate", [](auto& d) -> auto& { return d.drive.damped_rate; }, {"error", "joint"},
              "that `damping` acts against: of target - q, or of q alone, as `kv` of MuJoCo's position servos")
          .when([](const D& d) { return d.drive.mode == Mode::position; }, "`position`")
          .number(
              "dead_band", [](auto& d) -> auto& { return d.drive.play; },
              [](const D& d) { return turns(d.type) ? Unit::angle : Unit::length; }, "rad or m", 0, 1,
              "total width around the target within which `stiffness` does not act; beyond it the error counts from "
              "its edge")
          .when([](const D& d) { return d.drive.mode == Mode::position; }, "`position`")
          .number(
              "effort_limit", [](auto& d) -> auto& { return d.drive.effort_limit; },
              [](const D& d) { return turns(d.type) ? Unit::torque : Unit::force; }, "N m or N", 0,
              LARGEST_JOINT_NUMBER, "of all that the drive exerts, its damping included; 0: none")
          .flag(
              "compensates_gravity", [](auto& d) -> auto& { return d.drive.compensates_gravity; },
              "adds the effort that holds what the joint carries")
          .otherwise("false")
          .custom({"target", "of the mode", "`initial`; 0", "number or list", "a list: over `target_times`"},
                  read_target, nullptr)
          .custom({"target_times", "s", "none", "0 to 1e+06", "ascending; straight lines between"}, nullptr, nullptr)
          .check([](Section& s, D& d) {
            Joint joint;
            joint.drive = d.drive;
            if (!is_driven(joint)) s.fail("", "needs a `damping` above 0, or in the mode `position` a `stiffness`");
          });
  return FIELDS;
}

}  // namespace

const Fields<BodySection>& body_fields() {
  using B = BodySection;
  const auto is_rigid = is_kind({BodyKind::rigid}), is_soft = is_kind({BodyKind::soft}),
             is_half_space = is_kind({BodyKind::half_space}), is_moving = is_kind({BodyKind::moving});
  const auto has_shape = is_kind({BodyKind::rigid, BodyKind::soft, BodyKind::fixed, BodyKind::moving});
  const auto has_surface = is_kind({BodyKind::rigid, BodyKind::fixed, BodyKind::moving});
  const std::string half_space = "`half_space`", surfaces = "not `soft`, `half_space`";
  static const Fields<PathPoint> POINT =
      Fields<PathPoint>()
          .number("time", &PathPoint::time, Unit::time, 0, 1e6, "0 at the first point, then ascending")
          .required()
          .own_pose(&PathPoint::pose, "of the body");
  static const Fields<B> FIELDS =
      Fields<B>()
          .name(&B::name, "of the body")
          .choice("kind", &B::kind, {"rigid", "soft", "static", "moving", "half_space"},
                  "`static` never moves; `moving` goes its way whatever it meets; a half space fills all below a plane")
          .required()
          .custom(
              {"shape", "", "", "one of [these](#shapes-of-bodies)", "its form, in its own frame"},
              [=](Section& s, B& b) {
                if (is_soft(b))
                  b.solid = solid_shapes().read(s.section("shape"));
                else
                  b.surface = (is_rigid(b) ? closed_shapes() : open_shapes()).read(s.section("shape"));
              },
              nullptr)
          .required()
          .when(has_shape, "not `half_space`")
          .number("density", &B::density, Unit::density, 1e-3, 1e5, "or `mass`")
          .when(is_rigid, "`rigid`")
          .number("mass", &B::mass, Unit::mass, 1e-9, 1e6, "or `density`")
          .when(is_rigid, "`rigid`")
          .custom({"center_of_mass", "m", "of the shape", "-100 to 100", "in its frame"}, read_center_of_mass, nullptr)
          .when(is_rigid, "`rigid`")
          .custom({"inertia", "kg m^2", "of the shape", "-1e+09 to 1e+09",
                   "`[xx, yy, zz]`, or these and `xy, xz, yz`: about the centre of mass, along the axes of its frame"},
                  read_inertia, nullptr)
          .when(is_rigid, "`rigid`")
          .section("material", &B::material, solid_material_fields(), "of the solid")
          .required()
          .when(is_soft, "`soft`")
          .number("friction", &B::friction, Unit::none, 0, 10, "coefficient of friction")
          .number("contact_offset", &B::contact_offset, Unit::length, 0, 1,
                  "half thickness: contact acts outside of it")
          .pose("pose", &B::pose, "to the world, at the start")
          .when(has_shape, "not `half_space`")
          .number("affine_modulus", &B::affine_modulus, Unit::pressure, 1e3, 1e13, "keeps it rigid")
          .when(is_rigid, "`rigid`")
          .list("path", &B::path, POINT, "replaces `pose` and velocities; straight lines between", check_last_point)
          .when(is_moving, "`moving`")
          .number("velocity", &B::velocity, Unit::speed, -FASTEST, FASTEST, "at the start; of `moving` for ever")
          .when([=](const B& b) { return is_rigid(b) || is_soft(b) || (is_moving(b) && b.path.empty()); },
                "not `static`, `half_space`")
          .number("angular_velocity", &B::angular_velocity, Unit::angular_speed, -MOST_TURNS, MOST_TURNS, "likewise")
          .when([=](const B& b) { return is_rigid(b) || (is_moving(b) && b.path.empty()); }, "`rigid`, `moving`")
          .flag("collides", &B::collides, "false: passes through everything")
          .when(has_surface, surfaces)
          .number("point", &B::point, Unit::length, -REACH, REACH, "of its plane")
          .when(is_half_space, half_space)
          .number("normal", &B::normal, Unit::none, -1e6, 1e6, "of its plane; of any length")
          .when(is_half_space, half_space)
          .list("visuals", &B::visuals, visual_fields(), "what is seen of it, carried by it")
          .section("display", &B::display, display_fields(), "seven-segment figures of the mass that presses on it")
          .when([=](const B& b) { return !is_soft(b); }, "not `soft`")
          .check(check_body);
  return FIELDS;
}

const Fields<SceneJointSection>& scene_joint_fields() {
  using J = SceneJointSection;
  const std::string coordinate = "`revolute`, `prismatic`";
  static const Fields<J> FIELDS =
      Fields<J>()
          .include(joint_ends_fields(), std::identity{})
          .number(
              "stiffness", [](auto& j) -> auto& { return j.joint.stiffness; }, Unit::stiffness, 1e-3, 1e13,
              "of the constraint itself")
          .custom({"initial", "rad or m", "0", "-1000 to 1000 rad, -100 to 100 m", "coordinate at the start"},
                  read_initial, nullptr)
          .when(has_coordinate, coordinate)
          .include(joint_frame_fields(), std::identity{})
          .number(
              "limit_stiffness", [](auto& j) -> auto& { return j.joint.limit_stiffness; },
              [](const J& j) { return turns(j.joint.type) ? Unit::angular_stiffness : Unit::stiffness; },
              "N m/rad or N/m", 1e-3, 1e12, "with `limits`, of the stops")
          .when([](const J& j) { return j.joint.lower < j.joint.upper; }, coordinate)
          .otherwise("1e5 N m/rad, 1e6 N/m")
          .custom(
              {"child_frame", "m, rad", "as the bodies start", "`{position, rotation}`",
               "the joint in the child's frame; must meet `parent_frame` at the start"},
              [](Section& s, J& j) { j.child_frame = read_pose(s, "child_frame"); }, nullptr)
          .reads([](Section& s, J& j) {
            j.drive.type = j.joint.type;
            if (s.has("drive") && !has_coordinate(j))
              s.section("drive").fail("",
                                      "is of no use: only revolute and prismatic joints have a coordinate to drive");
          })
          .section("drive", &J::drive, drive_fields(), "acts on the coordinate");
  return FIELDS;
}

const Fields<StitchSection>& stitch_fields() {
  using S = StitchSection;
  static const Fields<S> FIELDS =
      Fields<S>()
          .reads([](Section& s, S&) {
            if (s.has("soft") == s.has("cloth"))
              s.fail("", "must name either a `soft` body or a `cloth`, which is held");
          })
          .text("soft", &S::soft, "a soft body, or instead:")
          .text("cloth", &S::cloth, "a cloth, which is held")
          .text("rigid", &S::rigid, "the body that holds it")
          .required()
          .number(
              "stiffness", [](auto& s) -> auto& { return s.stitch.stiffness; }, Unit::stiffness, 1e-3, 1e13,
              "of each node's spring")
          .number(
              "direction", [](auto& s) -> auto& { return s.stitch.direction; }, Unit::none, -1e6, 1e6,
              "in the rigid body's frame: holds along it alone, as rollers do; none: all directions")
          .otherwise("none")
          .number("low", &S::low, Unit::length, -2 * REACH, 2 * REACH,
                  "lowest corner of a box in the frame of what is held; nodes inside are tied")
          .required()
          .number("high", &S::high, Unit::length, -2 * REACH, 2 * REACH, "its highest corner")
          .required()
          .check([](Section& section, S& s) {
            if (section.has("direction") && !(s.stitch.direction.norm() > 1e-9))
              section.fail("direction", "must not have the length zero; leave it out to hold all directions");
          });
  return FIELDS;
}

const Fields<NoncollidingPair>& noncolliding_fields() {
  using P = NoncollidingPair;
  static const Fields<P> FIELDS = Fields<P>()
                                      .text("first", &P::first, "name of a rigid or static body")
                                      .required()
                                      .text("second", &P::second, "name of the other one")
                                      .required();
  return FIELDS;
}

}  // namespace pvg
