// The sections of files that physics reads: contact, solver, materials, cloths, what is drawn per episode.
#include <algorithm>
#include <cmath>

#include "host/load/fields/doubtful_numbers.hpp"
#include "host/load/read_shapes.hpp"
#include "host/load/tables.hpp"

namespace pvg {
namespace {

using Section = YamlSection;
constexpr double STIFFEST = 1e9;  // of cloth [N/m], [N m]

// the keys KEY_warp and KEY_weft: false where neither is there
bool has_both(Section& section, const std::string& key) {
  const std::string warp = key + "_warp", weft = key + "_weft";
  const bool has_warp = section.has(warp), has_weft = section.has(weft);
  if (section.has(key) && (has_warp || has_weft))
    section.fail(key, "stands for both directions: leave `" + warp + "` and `" + weft + "` out, or this");
  if (has_warp != has_weft) section.text(has_warp ? weft : warp);  // says that it is missing
  return has_warp || section.has(key);
}

// what the numbers that are not given follow from
void complete(Section& section, ClothMaterial& m) {
  if (section.has("area_density") == section.has("density"))
    section.fail("", "must have either `area_density` or, for a sheet of a uniform stuff, `density`");
  tell_of_light_density(section, "density");
  if (!(m.area_density > 0)) section.fail("density", "needs a `thickness` above 0");
  const bool has_stretch = has_both(section, "stretch");
  if (has_stretch == section.has("youngs_modulus"))
    section.fail("", "must have either `stretch` (Young's modulus times thickness) or `youngs_modulus`");
  if (!(m.stretch_warp > 0)) section.fail("youngs_modulus", "needs a `thickness` above 0");
  const double mean = std::sqrt(m.stretch_warp * m.stretch_weft);
  if (!section.has("shear")) m.shear = mean / (2 * (1 + m.poisson_ratio));
  if (has_both(section, "bending")) return;
  if (has_stretch) section.fail("", "lacks the key `bending`: the flexural rigidity [N m]");
  // of a uniform plate: E t^3 / (12 (1 - nu^2))
  m.bending_warp = m.bending_weft = mean * m.thickness * m.thickness / (12 * (1 - m.poisson_ratio * m.poisson_ratio));
}

void read_pinned(Section& section, ClothSection& read) {
  std::vector<std::uint32_t>& pinned = read.cloth.pinned;
  for (Section& box : section.sections("pinned")) {
    const std::vector<std::uint32_t> points = read_points_within(box, read.cloth.mesh.points, "cloth");
    box.done();
    pinned.insert(pinned.end(), points.begin(), points.end());
  }
  std::sort(pinned.begin(), pinned.end());
  pinned.erase(std::unique(pinned.begin(), pinned.end()), pinned.end());
}

}  // namespace

const Fields<ContactSettings>& contact_fields() {
  using C = ContactSettings;
  static const Fields<C> FIELDS =
      Fields<C>()
          .number("activation_distance", &C::activation_distance, Unit::length, 1e-6, 0.1,
                  "contact acts below this gap. Bodies rest at a gap slightly below it and never touch")
          .number("stiffness", &C::stiffness, Unit::pressure, 1, 1e12, "scale of the barrier pressure")
          .number("friction_velocity", &C::friction_velocity, Unit::speed, 1e-8, 1,
                  "times the time step: elastic slip before friction is fully developed")
          .number("friction_lag_passes", &C::friction_lag_passes, Unit::none, -1, 100,
                  "renewals of normal forces and tangents of friction within a step; -1: until a further renewal would "
                  "move no point faster than `velocity_tolerance`")
          .check([](Section& section, C& contact) {
            if (contact.friction_lag_passes == 0)
              section.fail("friction_lag_passes",
                           "must be a number of passes, or -1: until the friction no longer changes");
          });
  return FIELDS;
}

const Fields<SolverSettings>& solver_fields() {
  using S = SolverSettings;
  static const Fields<S> FIELDS =
      Fields<S>()
          .choice("integrator", &S::integrator, {"implicit_euler", "bdf2"},
                  "`bdf2` is of second order; its first step is implicit Euler's")
          .number("velocity_tolerance", &S::velocity_tolerance, Unit::speed, 1e-9, 1,
                  "Newton stops when its next correction moves no point faster; less where a joint has dry friction")
          .number("max_newton", &S::max_newton, Unit::none, 1, 10000, "Newton iterations per step")
          .choice(
              "preconditioner", &S::preconditioner, {PRECONDITIONER_NAMES.begin(), PRECONDITIONER_NAMES.end()},
              "of conjugate gradients. `factor`: exact sparse factors; `schwarz`: multilevel additive Schwarz on the "
              "device; `automatic`: `schwarz` for factors above 5e9 operations (a compact solid of some 5,000 nodes), "
              "else `factor`")
          .number("cg_tolerance", &S::cg_tolerance, Unit::none, 1e-15, 0.5,
                  "relative residual of conjugate gradients, in the norm of the preconditioner")
          .number("max_cg", &S::max_cg, Unit::none, 1, 1000000, "conjugate-gradient iterations per solve")
          .number("max_step_halvings", &S::max_step_halvings, Unit::none, 0, 20,
                  "a failed step is repeated as two of half the length, at most this many times; then the run ends and "
                  "names the body");
  return FIELDS;
}

const Fields<PairFriction>& pair_friction_fields() {
  using P = PairFriction;
  static const Fields<P> FIELDS = Fields<P>()
                                      .text("first", &P::first, "name of a body")
                                      .required()
                                      .text("second", &P::second, "name of the other body")
                                      .required()
                                      .number("coefficient", &P::coefficient, Unit::none, 0, 10,
                                              "coefficient of friction of this pair; without an entry the geometric "
                                              "mean of both bodies' `friction`")
                                      .required();
  return FIELDS;
}

const Fields<PairRestitution>& pair_restitution_fields() {
  using P = PairRestitution;
  static const Fields<P> FIELDS =
      Fields<P>()
          .text("first", &P::first, "name of a rigid body")
          .required()
          .text("second", &P::second, "name of the other body; one of both moves, without joints")
          .required()
          .number("coefficient", &P::coefficient, Unit::none, 0, 1,
                  "speed of parting over that of meeting; without an entry barrier and time step decide")
          .required();
  return FIELDS;
}

const Fields<SolidMaterial>& solid_material_fields() {
  using M = SolidMaterial;
  static const Fields<M> FIELDS =
      Fields<M>()
          .number("density", &M::density, Unit::density, 1e-6, 1e5, "mass per volume")
          .required()
          .number("youngs_modulus", &M::youngs_modulus, Unit::pressure, 1, 1e12,
                  "as a tensile test of the simulated bar shows it")
          .required()
          .number("poisson_ratio", &M::poisson_ratio, Unit::none, 0, 0.4999, "transverse contraction")
          .required()
          .check([](YamlSection& s, M&) { tell_of_light_density(s, "density"); });
  return FIELDS;
}

const Fields<ClothMaterial>& cloth_material_fields() {
  using M = ClothMaterial;
  static const Fields<M> FIELDS =
      Fields<M>()
          .number("area_density", &M::area_density, Unit::area_density, 1e-6, 1e4, "this or `density`")
          .otherwise("required")
          .number("thickness", &M::thickness, Unit::length, 0, 0.1, "contact acts half of it to each side")
          .sets(
              "density", [](M& m, double value) { m.area_density = m.thickness * value; }, Unit::density, 1e-3, 1e5,
              "times `thickness`: the area density")
          .number("stretch_warp", &M::stretch_warp, Unit::stiffness, 1e-3, STIFFEST,
                  "Young's modulus times thickness along the warp")
          .otherwise("`stretch`")
          .number("stretch_weft", &M::stretch_weft, Unit::stiffness, 1e-3, STIFFEST, "the same along the weft")
          .otherwise("`stretch`")
          .sets(
              "stretch", [](M& m, double value) { m.stretch_warp = m.stretch_weft = value; }, Unit::stiffness, 1e-3,
              STIFFEST, "both of these; this or `youngs_modulus`")
          .otherwise("required")
          .sets(
              "youngs_modulus", [](M& m, double value) { m.stretch_warp = m.stretch_weft = value * m.thickness; },
              Unit::pressure, 1, 1e12, "times `thickness`: `stretch`")
          .number("shear", &M::shear, Unit::stiffness, 1e-3, STIFFEST, "shear modulus times thickness")
          .otherwise("stretch / (2 (1 + nu))")
          .number("poisson_ratio", &M::poisson_ratio, Unit::none, 0, 0.99, "in the plane")
          .number("limit_strain", &M::limit_strain, Unit::none, 0, 10,
                  "beyond this strain the modulus grows by 1 + 6 stiffening (strain - limit)")
          .number("stiffening", &M::stiffening, Unit::none, 0, 1e6, "see `limit_strain`")
          .number("bending_warp", &M::bending_warp, Unit::torque, 0, STIFFEST,
                  "flexural rigidity against bending the warp")
          .otherwise("`bending`")
          .number("bending_weft", &M::bending_weft, Unit::torque, 0, STIFFEST, "the same for the weft")
          .otherwise("`bending`")
          .sets(
              "bending", [](M& m, double value) { m.bending_warp = m.bending_weft = value; }, Unit::torque, 0, STIFFEST,
              "both of these; required with `stretch`")
          .otherwise("E t^3 / (12 (1 - nu^2))")
          .check(complete);
  return FIELDS;
}

const Fields<ClothSection>& cloth_fields() {
  using C = ClothSection;
  const auto shape = [](Section& section, C& read) {
    Section inner = section.section("shape");
    if (inner.has("mesh")) read.mesh = inner.file("mesh");
    read.cloth.mesh = sheet_shapes().read(inner);
  };
  // the mesh itself is not part of a configuration
  const auto nothing = [](Section&, C&) {};
  static const Fields<C> FIELDS =
      Fields<C>()
          .name(
              [](auto& c) -> auto& { return c.cloth.name; }, "of the cloth")
          .custom({"shape", "", "", "one of [these](#shapes-of-cloths)", "its form, in its own frame"}, shape, nullptr)
          .required()
          .file("mesh", &C::mesh, "the file of its shape")
          .only_resolved()
          .custom({"points", "", "", "", ""}, nothing,
                  [](YamlWriter& w, const C& c) { w.entry("points", c.cloth.mesh.points.size()); })
          .only_resolved()
          .custom({"triangles", "", "", "", ""}, nothing,
                  [](YamlWriter& w, const C& c) { w.entry("triangles", c.cloth.mesh.triangles.size()); })
          .only_resolved()
          .section(
              "material", [](auto& c) -> auto& { return c.cloth.material; }, cloth_material_fields(),
              "see the keys below it")
          .required()
          .custom(
              {"rest_angles", "", "`flat`", "`flat`, `mesh`",
               "shape without bending moment; `mesh`: the angles of the mesh"},
              [](Section& s, C& c) {
                c.cloth.rest_is_flat = s.choice("rest_angles", {"flat", "mesh"}) == 0;
              },
              [](YamlWriter& w, const C& c) { w.entry("rest_angles", c.cloth.rest_is_flat ? "flat" : "mesh"); })
          .number(
              "warp", [](auto& c) -> auto& { return c.cloth.warp_direction; }, Unit::none, -1e6, 1e6,
              "direction of the warp in the cloth's frame, projected on each triangle")
          .custom(
              {"pinned", "m", "none", "list of `{low, high}`", "boxes in the cloth's frame; points inside never move"},
              read_pinned, nullptr)
          .custom(
              {"pinned_points", "", "", "", ""},
              [](Section& s, C& c) {
                for (const double point : s.numbers("pinned_points", Unit::none, 0, 1e9))
                  c.cloth.pinned.push_back(std::uint32_t(point));
              },
              [](YamlWriter& w, const C& c) { w.flow("pinned_points", c.cloth.pinned); })
          .only_resolved()
          .number(
              "friction", [](auto& c) -> auto& { return c.cloth.friction; }, Unit::none, 0, 10,
              "coefficient of friction")
          .number(
              "velocity", [](auto& c) -> auto& { return c.cloth.velocity; }, Unit::speed, -1e3, 1e3, "at the start")
          .section("pose", &C::pose, sampled_pose_fields(), "to the world; every number may be a range")
          .text("look", &C::look, "name of a material; without it the cloth is invisible")
          .number("subdivision_levels", &C::subdivision_levels, Unit::none, 0, 4, "of the surface that is seen")
          .check([](Section& section, C& c) {
            if (!(c.cloth.warp_direction.norm() > 1e-9)) section.fail("warp", "must not have the length zero");
          });
  return FIELDS;
}

namespace {

// A hand that grips or lets go is left in peace.
void check_disturbed(const YamlSection& section, const std::vector<std::string>& during) {
  std::vector<std::string> allowed;
  for (const MotionKind& kind : MOTION_KINDS)
    if (kind.given != GivenMotion::gripper_position) allowed.push_back(kind.name);
  if (during.empty()) section.fail("during", "must name at least one motion element");
  for (const std::string& name : during)
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
      section.fail("during", "names `" + name + "`, but must name some of: " + shown_names(allowed));
}

}  // namespace

const Fields<Variation>& variation_fields() {
  using V = Variation;
  using Quantity = V::Quantity;
  const auto shifts = [](const V& v) { return v.quantity == Quantity::camera_position; };
  const auto turns = [](const V& v) { return v.quantity == Quantity::camera_rotation; };
  const auto swaps = [](const V& v) { return v.quantity == Quantity::texture; };
  const auto is_presence = [](const V& v) { return v.quantity == Quantity::presence; };
  const auto pushes = [](const V& v) { return v.quantity == Quantity::disturbance; };
  const auto scales = [=](const V& v) { return !shifts(v) && !turns(v) && !swaps(v) && !is_presence(v) && !pushes(v); };
  static const Fields<V> FIELDS =
      Fields<V>()
          .choice("quantity", &V::quantity,
                  {"size", "mass", "friction", "stiffness", "color", "light", "exposure", "camera_position",
                   "camera_rotation", "focal_length", "texture", "presence", "disturbance"},
                  "what is drawn")
          .required()
          .text("of", &V::of,
                "name of the object, cloth, finger, material, light or camera; `background`, `environment`; of a "
                "disturbance `gripper_base`, of robot NAME `NAME/gripper_base`")
          .required()
          .then([=](V& v) {
            v.range = scales(v) ? Range{1, 1} : Range{0, 0};
          })
          .number("factor", &V::range, Unit::none, 1e-3, 1e3, "`[low, high]`, drawn evenly for each episode")
          .when(scales, "of numbers")
          .otherwise("1")
          .written_when(scales)
          .number("by", &V::range, Unit::length, -1, 1, "`[low, high]`, drawn for each axis of the camera")
          .when(shifts, "of `camera_position`")
          .written_when(shifts)
          .number("by", &V::range, Unit::angle, -1, 1, "`[low, high]`, drawn for each axis of the camera")
          .when(turns, "of `camera_rotation`")
          .written_when(turns)
          .files("files", &V::files,
                 "pictures of a material, of the `background` or of the `environment`; each is drawn as often")
          .when(swaps, "of `texture`")
          .written_when(swaps)
          .number("probability", &V::probability, Unit::none, 0, 1,
                  "how often the object is there, such as a distractor")
          .when(is_presence, "of `presence`")
          .written_when(is_presence)
          .number("by", &V::range, Unit::length, -0.2, 0.2,
                  "`[low, high]`, drawn for each axis of the tool; what of it points along the tool's way is left out")
          .when(pushes, "of `disturbance`")
          .written_when(pushes)
          .number("turn", &V::turn, Unit::angle, -0.5, 0.5, "`[low, high]`, drawn for each axis of the tool")
          .when(pushes, "of `disturbance`")
          .written_when(pushes)
          .number("times", &V::times, Unit::none, 1, 100, "how many in an episode, spread over it; none overlap")
          .when(pushes, "of `disturbance`")
          .written_when(pushes)
          .number("duration", &V::duration, Unit::time, 0.02, 10, "from the way and back to it; a range is drawn")
          .when(pushes, "of `disturbance`")
          .written_when(pushes)
          .text("during", &V::during, "names of motion elements in which it may happen, not `close` and `open`")
          .when(pushes, "of `disturbance`")
          .otherwise(shown_names(V().during))
          .written_when(pushes)
          .check([=](YamlSection& s, const V& v) {
            if (pushes(v)) check_disturbed(s, v.during);
            if (v.quantity == Quantity::texture && v.files.empty()) s.fail("files", "must name at least one picture");
          });
  return FIELDS;
}

}  // namespace pvg
