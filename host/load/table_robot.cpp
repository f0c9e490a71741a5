// The sections `robot` and `objects`, and gripper files.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "host/load/fields/doubtful_numbers.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/tables.hpp"
#include "host/load/task_file.hpp"

namespace pvg {
namespace {

using Section = YamlSection;

const Fields<RobotSection>& robot_drive_fields() {
  using R = RobotSection;
  static const Fields<R> FIELDS =
      Fields<R>()
          .number("stiffness", &R::drive_stiffness, Unit::angular_stiffness, 1e-3, 1e9,
                  "of every joint's drive; required in this mapping")
          .required()
          .otherwise("1e5")
          .number("damping", &R::drive_damping, Unit::angular_damping, 0, 1e6, "of every joint's drive");
  return FIELDS;
}

const Fields<GripperSection>& gripper_drive_fields() {
  using G = GripperSection;
  static const Fields<G> FIELDS =
      Fields<G>()
          .number("stiffness", &G::drive_stiffness, Unit::stiffness, 1e-3, 1e12,
                  "of every joint's drive; required in this mapping")
          .required()
          .otherwise("2e4")
          .number("damping", &G::drive_damping, Unit::damping, 0, 1e9, "of every joint's drive");
  return FIELDS;
}

const Fields<FingerSection>& finger_stitch_fields() {
  using F = FingerSection;
  static const Fields<F> FIELDS =
      Fields<F>()
          .number("low", &F::stitch_low, Unit::length, -REACH, REACH,
                  "lowest corner of a box in the finger's frame; nodes inside are tied to the carriage")
          .required()
          .number("high", &F::stitch_high, Unit::length, -REACH, REACH, "its highest corner")
          .required()
          .number("stiffness", &F::stitch_stiffness, Unit::stiffness, 1e-3, 1e12, "of each node's spring")
          .required();
  return FIELDS;
}

const Fields<FingerSection>& tetgen_fields() {
  using F = FingerSection;
  static const Fields<F> FIELDS =
      Fields<F>()
          .number("max_volume", &F::max_tetrahedron_volume, Unit::volume, 0, INFINITY,
                  "bound of a tetrahedron's volume; 0: none")
          .number("radius_edge_ratio", &F::radius_edge_ratio, Unit::none, 1.1, 100, "TetGen's -q")
          .flag("keeps_surface", &F::keeps_surface, "TetGen's -Y: adds no vertices on the surface")
          .include(nodes_per_element_fields(), &F::nodes_per_element);
  return FIELDS;
}

void check_object(Section& section, ObjectSection& object) {
  tell_of_light_density(section, "density");
  const bool needs_mass = !object.is_fixed && !object.mesh.empty();
  if (needs_mass && (object.density > 0) == (object.mass > 0)) {
    section.done();  // a misspelled key is the likelier reason
    section.fail("", "must have either `density` or `mass`, because it can move");
  }
  if (!needs_mass && (object.density > 0 || object.mass > 0))
    section.fail("", "has a mass but cannot move: leave `density` and `mass` out");
  if (object.mesh.empty() && object.visuals.empty())
    section.fail("", "has neither `mesh` nor `visuals`: there is nothing to do with it");
  if (object.mesh.empty() && object.display.width > 0)
    section.fail("display", "weighs what presses on the body, but the object has no `mesh`; give it one");
  if (!object.is_visible && !object.visuals.empty())
    section.fail("visible", "is false, but the object has `visuals`; leave one of them out");
}

}  // namespace

const Fields<int>& nodes_per_element_fields() {
  static const Fields<int> FIELDS = Fields<int>()
                                        .number("nodes_per_element", std::identity{}, Unit::none, 4, 10,
                                                "4 or 10; four-node tetrahedra make thin ribs several times too stiff")
                                        .otherwise("10")
                                        .check([](Section& section, int& nodes) {
                                          if (nodes != 4 && nodes != 10)
                                            section.fail("nodes_per_element", "must be 4 or 10");
                                        });
  return FIELDS;
}

const Fields<RobotSection>& robot_fields() {
  using R = RobotSection;
  static const Fields<R> FIELDS =
      Fields<R>()
          .file("urdf", &R::urdf, "the arm")
          .required()
          .pose("base", &R::base, "base link to world")
          .number("home", &R::home, Unit::angle, -1e3, 1e3, "start configuration, a number per joint")
          .required()
          .number(
              "posture", &R::posture, Unit::angle, -1e3, 1e3,
              "tasks only. Of several configurations that reach a target the nearest to this one is planned, a number "
              "per joint")
          .otherwise("none: the nearest to where the arm is")
          .written_when([](const R& robot) { return !robot.posture.empty(); })
          .text("flange", &R::flange, "link that carries the gripper")
          .required()
          .section("drive", std::identity{}, robot_drive_fields(), "of all joints")
          .number("armature", &R::armature, Unit::inertia, 0, 1e3,
                  "inertia of each joint's geared rotor, a number per joint (of one that slides in kg)")
          .otherwise("none")
          .choice("feedforward", &R::feeds_friction_forward, {"none", "friction"},
                  "tasks only. `friction`: targets of the planned motion lead by what friction in the joints, of "
                  "`effects` and of the URDF, would hold the arm back")
          .number("friction", &R::friction, Unit::none, 0, 10, "coefficient of friction of all links")
          .text("collision_links", &R::collision_links, "links that collide")
          .otherwise("all that have a shape for it")
          .check([](Section& section, R& robot) {
            if (!robot.armature.empty() && robot.armature.size() != robot.home.size())
              section.fail("armature", "must hold as many numbers as `home`");
            if (!robot.posture.empty() && robot.posture.size() != robot.home.size())
              section.fail("posture", "must hold as many numbers as `home`");
            for (const double q : robot.home)
              if (!section.is_resolved() && std::abs(q) > 2 * std::numbers::pi)
                section.fail("home", fmt::format("holds {:g} rad, which is more than a turn: write `{:g} deg` if it is "
                                                 "in degrees",
                                                 q, q));
          });
  return FIELDS;
}

const Fields<FingerSection>& finger_fields() {
  using F = FingerSection;
  static const Fields<F> FIELDS =
      Fields<F>()
          .name(&F::name, "of the finger")
          .file("mesh", &F::mesh, "closed surface, in the finger's frame")
          .required()
          .section("material", &F::material, solid_material_fields(), "of the finger")
          .required()
          .number("friction", &F::friction, Unit::none, 0, 10, "coefficient of friction")
          .text("carriage", &F::carriage, "link of the URDF that carries it")
          .required()
          .pose("pose", &F::pose, "finger to carriage")
          .section("stitch", std::identity{}, finger_stitch_fields(), "what holds it on the carriage")
          .required()
          .section("tetgen", std::identity{}, tetgen_fields(), "how it is filled with tetrahedra")
          .list("visuals", &F::visuals, visual_fields(), "carried by its tetrahedra; none: its own surface is seen");
  return FIELDS;
}

const Fields<RobotCell>& robot_cell_fields() {
  using C = RobotCell;
  static const Fields<C> FIELDS = Fields<C>()
                                      .name(&C::name, "of the robot; its bodies and joints are `NAME/link`")
                                      .include(carried_gripper_fields<C>(), std::identity{})
                                      .check([](Section& section, C& cell) {
                                        if (cell.robot.urdf.empty())
                                          section.section("robot");  // says that it is missing
                                      });
  return FIELDS;
}

const Fields<GripperSection>& gripper_fields() {
  using G = GripperSection;
  static const Fields<G> FIELDS =
      Fields<G>()
          .flag("is_rigid", &G::is_rigid, "its fingers do not bend")
          .only_resolved()
          .file("file", &G::file, "of the gripper")
          .only_resolved()
          .file("urdf", &G::urdf, "the rigid parts")
          .required()
          .text("base_link", &G::base_link, "link that is fixed to the robot's flange")
          .required()
          .pose("mount", &G::mount, "gripper base to flange")
          .pose("tool_center", &G::tool_center,
                "tool frame in the gripper base: z along the fingers, y from finger to finger")
          .text("joints", &G::joints, "the prismatic ones, one per finger")
          .required()
          .number("open", &G::open, Unit::length, 0, 10, "position of the joints when open")
          .required()
          .number("closed", &G::closed, Unit::length, 0, 10, "position of the joints when closed")
          .required()
          .number("width_at_zero", &G::width_at_zero, Unit::length, -1, 1,
                  "between the unbent fingertips at position 0; each joint adds its own position")
          .section("drive", std::identity{}, gripper_drive_fields(), "of its joints")
          .text("finger_material", &G::finger_material, "name of the fingers' visual material")
          .required()
          .number("subdivision_levels", &G::subdivision_levels, Unit::none, 0, 4, "of the fingers' visual surface")
          .custom(
              {"materials", "", "none", "list", "as in scenes, without textures"},
              [](Section& s, G& g) { add_materials(s, g.materials, nullptr); }, nullptr)
          .list("fingers", &G::fingers, finger_fields(), "the soft fingers, at least one")
          .otherwise("required")
          .check([](Section& root, G& gripper) {
            if (gripper.open == gripper.closed) root.fail("open", "must differ from `closed`");
            if (gripper.fingers.empty()) root.fail("", "must hold at least one finger under `fingers`");
            check_distinct(root, "fingers", gripper.fingers);
          });
  return FIELDS;
}

const Fields<SampledPose>& sampled_pose_fields() {
  using P = SampledPose;
  static const Fields<P> FIELDS =
      Fields<P>()
          .text("object", &P::object, "whose frame it is in, an object further up in the list; none: the world's")
          .written_when([](const P& p) { return !p.object.empty(); })
          .number("x", &P::x, Unit::length, -REACH, REACH, "a number or a range `[low, high]`, drawn per episode")
          .number("y", &P::y, Unit::length, -REACH, REACH, "likewise")
          .number("z", &P::z, Unit::length, -REACH, REACH, "likewise")
          .number("roll", &P::roll, Unit::angle, -2 * std::numbers::pi, 2 * std::numbers::pi,
                  "about the fixed axis x, first; likewise")
          .number("pitch", &P::pitch, Unit::angle, -2 * std::numbers::pi, 2 * std::numbers::pi,
                  "about the fixed axis y; likewise")
          .number("yaw", &P::yaw, Unit::angle, -2 * std::numbers::pi, 2 * std::numbers::pi,
                  "about the fixed axis z, last; likewise");
  return FIELDS;
}

const Fields<VisualSection>& visual_fields() {
  using V = VisualSection;
  static const Fields<V> FIELDS =
      Fields<V>()
          .file("mesh", &V::mesh, "OBJ, STL, PLY or glTF, in the frame of the body")
          .required()
          .text("material", &V::material, "name of a material; glTF files may keep their own")
          .otherwise("required, of glTF its own")
          .number("crease_angle", &V::crease_angle, Unit::angle, 0, std::numbers::pi,
                  "edges sharper than this stay sharp")
          .check([](Section& section, V& visual) {
            const bool has_own = visual.mesh.extension() == ".glb" || visual.mesh.extension() == ".gltf";
            if (!has_own) section.text("material");  // says that it is missing
          });
  return FIELDS;
}

const Fields<Display>& display_fields() {
  using D = Display;
  static const Fields<D> FIELDS =
      Fields<D>()
          .own_pose(&D::pose, "middle of the face in the frame of the body; x right, y up, z out of it")
          .number("width", &D::width, Unit::length, 1e-3, 10, "of the face")
          .required()
          .number("height", &D::height, Unit::length, 1e-3, 10, "of the face")
          .required()
          .number("digits", &D::digits, Unit::none, 1, 12, "places; dashes where the figures are more")
          .number("resolution", &D::resolution, Unit::mass, 1e-9, 1e3, "of the figures, which are grams")
          .number("tare", &D::tare, Unit::mass, -1e3, 1e3, "is taken from what presses on the body")
          .number("time_constant", &D::time_constant, Unit::time, 0, 60, "of the first-order lag of the reading")
          .number("color", &D::color, Unit::none, 0, 1, "of the face, linear red, green, blue")
          .number("radiance", &D::radiance, Unit::radiance, 0, 1e4, "of a lit segment: red, green, blue");
  return FIELDS;
}

const Fields<ObjectSection>& object_fields() {
  using O = ObjectSection;
  static const Fields<O> FIELDS =
      Fields<O>()
          .name(&O::name, "of the object")
          .file("mesh", &O::mesh, "closed surface for the simulation; none: seen only")
          .list("visuals", &O::visuals, visual_fields(), "what is seen; none: `mesh` in plain grey")
          .section("display", &O::display, display_fields(), "seven-segment figures of the mass that presses on it")
          .written_when([](const O& o) { return o.display.width > 0; })
          .flag("visible", &O::is_visible, "false: an object without `visuals` is not seen")
          .written_when([](const O& o) { return !o.is_visible; })
          .flag("fixed", &O::is_fixed, "never moves")
          .number("density", &O::density, Unit::density, 1e-3, 1e5, "this or `mass`, if it can move")
          .otherwise("required")
          .written_when([](const O& o) { return o.density > 0; })
          .number("mass", &O::mass, Unit::mass, 1e-6, 1e5, "this or `density`")
          .otherwise("required")
          .written_when([](const O& o) { return o.mass > 0; })
          .number("friction", &O::friction, Unit::none, 0, 10, "coefficient of friction")
          .number("affine_modulus", &O::affine_modulus, Unit::pressure, 1e3, 1e12,
                  "keeps it rigid. For small strains it is as stiff as a solid of 8 times this modulus")
          .number("size", &O::size, Unit::none, 0, 1e3, "factor on its meshes")
          .only_resolved()
          .section("pose", &O::pose, sampled_pose_fields(), "to the world or to another object")
          .check(check_object);
  return FIELDS;
}

GripperSection load_gripper(const std::filesystem::path& file) {
  Section root = Section::load(file, "gripper file");
  check_schema(root);
  GripperSection gripper;
  gripper.file = root.path();
  gripper_fields().read(root, gripper);
  root.done();
  return gripper;
}

}  // namespace pvg
