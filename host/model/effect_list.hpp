// The list of effects: one row each, from which names, checks, the simulator's elements, the candidates of a diagnosis
// and the amended scene follow. An effect that is a number of a term that exists is a row here and nothing else. One
// with a term of its own also has an entry in PVG_EFFECT_TERMS, and its maker in host/physics/energies/effects.cpp.
#pragma once
#include "host/model/effect_row.hpp"

#define PVG_EFFECT_TERMS(X) X(spin_drag) X(push) X(rolling_resistance) X(force_law) X(joint_law)

namespace pvg {

#define PVG_ENUMERATOR(name) name,
enum class EffectTerm : int { PVG_EFFECT_TERMS(PVG_ENUMERATOR) };
#undef PVG_ENUMERATOR

namespace effect_list {

inline constexpr const char* REGRESSED = "regressed";  // the law of those that are given by formulas

// ---- what rows say, by name (effect_list.cpp)

EffectParameter strength(const char* name, const char* unit, double low, double high, double off = 0);
EffectParameter shape(const char* name, const char* unit, double low, double high, double usual);

Joint& joint_of(PhysicalScene& scene, const Effect& effect);
Drive& drive_of(PhysicalScene& scene, const Effect& effect);
RigidBody& rigid_of(PhysicalScene& scene, const Effect& effect);
Vec3 vector(const Effect& effect);  // its parameters x, y, z

// Bends the rest shape in the body's frame: along its longest axis, at s from where it is fastened, by curvature
// s^2 / 2 across it. What holds it keeps its place and direction.
void bend_rest_shape(PhysicalScene& scene, const std::string& target, double curvature_1, double curvature_2);

bool holds_position(const PhysicalScene& scene, const std::string& joint);
bool has_no_armature(const PhysicalScene& scene, const std::string& joint);  // else it is a number that may be wrong
bool is_not_carried(const PhysicalScene& scene, const std::string& body);    // what is carried has its joint's friction
bool is_never_missing(const PhysicalScene& scene, const std::string& target);  // a choice of the model, no cause

double less_common(const PhysicalScene& scene, const std::string& target);
double rare_in_sight(const PhysicalScene& scene, const std::string& body);
double rare_between_stiff_bodies(const PhysicalScene& scene, const std::string& contact);

double tilt_of_a_level_base(const PhysicalScene& scene, const std::string& unit, double mass);
double weight_of_what_slides(const PhysicalScene& scene, const std::string& unit, double mass);
double part_of_the_weight(const PhysicalScene& scene, const std::string& unit, double mass);

inline std::vector<EffectRow> joint_effects() {
  using T = EffectTarget;
  return {
      {.kind = {"joint_viscous_friction",
                T::joint,
                "joint rate",
                "quadratic",
                "a bearing resists in proportion to its rate",
                "effort = -damping q'",
                "a free swing: the amplitude falls exponentially",
                {strength("damping", "N m s/rad", 0, 1e3)}},
       .action = +[](JointNumbers& n, const Effect& e) { n.damping = parameter_of(e, "damping"); }},
      {.kind = {"joint_coulomb_friction",
                T::joint,
                "joint rate",
                "smoothed Coulomb",
                "a bearing resists alike at every rate",
                "effort = -effort sign(q')",
                "a free swing: the amplitude falls by the same angle each time",
                {strength("effort", "N m", 0, 1e3), shape("velocity", "rad/s", 1e-6, 1, 1e-3)}},
       .action =
           +[](JointNumbers& n, const Effect& e) {
             n.coulomb = parameter_of(e, "effort");
             n.velocity = parameter_of(e, "velocity");
           },
       .rounding = "velocity"},
      {.kind = {"joint_stribeck_friction",
                T::joint,
                "joint rate",
                "Stribeck",
                "a bearing sticks harder than it slides",
                "effort = -(effort + extra exp(-(q'/stribeck_velocity)^2)) sign(q')",
                "slow and fast strokes and a reversal",
                {strength("effort", "N m", 0, 1e3), strength("extra", "N m", 0, 1e3),
                 shape("stribeck_velocity", "rad/s", 1e-3, 100, 0.1), shape("velocity", "rad/s", 1e-6, 1, 1e-3)}},
       .action =
           +[](JointNumbers& n, const Effect& e) {
             n.coulomb = parameter_of(e, "effort");
             n.velocity = parameter_of(e, "velocity");
             n.extra = parameter_of(e, "extra");
             n.stribeck_velocity = parameter_of(e, "stribeck_velocity");
           },
       .rounding = "velocity"},
      {.kind = {"backlash",
                T::driven_joint,
                "joint position",
                "dead zone",
                "the drive is loose by a play before it takes hold",
                "effort = stiffness (e - clamp(e, -play/2, play/2)), e = target - q",
                "a slow reversal under both signs of load",
                {strength("play", "rad", 0, 1)}},
       .action = +[](PhysicalScene& s, const Effect& e) { drive_of(s, e).play += parameter_of(e, "play"); },
       .is_possible = holds_position},
      {.kind = {"joint_spring",
                T::joint,
                "joint position",
                "linear and quadratic",
                "a spring, such as a door closer, pulls back",
                "effort = preload - stiffness q",
                "a release from two positions",
                {strength("stiffness", "N m/rad", 0, 1e4), strength("preload", "N m", -1e3, 1e3)}},
       .action =
           +[](JointNumbers& n, const Effect& e) {
             n.stiffness = parameter_of(e, "stiffness");
             n.preload = parameter_of(e, "preload");
           },
       .prior_sigma = weight_of_what_slides},
      {.kind = {"rotor_inertia",
                T::driven_joint,
                "joint acceleration",
                "quadratic",
                "the geared rotor of the drive turns with the joint",
                "effort = -inertia q''",
                "strokes at two accelerations, in two poses of what hangs on the joint",
                {strength("inertia", "kg m^2", 0, 100)}},
       .action = +[](PhysicalScene& s, const Effect& e) { joint_of(s, e).armature += parameter_of(e, "inertia"); },
       .is_possible = has_no_armature,
       .log_prior = less_common},
      {.kind = {"actuator_lag",
                T::driven_joint,
                "command",
                "first-order lag",
                "the drive follows its command late and smoothly",
                "command' = (given - command) / time_constant",
                "a step and a chirp",
                {strength("time_constant", "s", 0, 1)}},
       .action = +[](PhysicalScene& s,
                     const Effect& e) { drive_of(s, e).time_constant += parameter_of(e, "time_constant"); }},
      {.kind = {"actuator_delay",
                T::driven_joint,
                "command",
                "delay",
                "the drive obeys its command some time later",
                "command(t) = given(t - delay)",
                "a step",
                {strength("delay", "s", 0, 1)}},
       .action = +[](PhysicalScene& s, const Effect& e) { drive_of(s, e).delay += parameter_of(e, "delay"); }},
      {.kind = {"actuator_gain",
                T::driven_joint,
                "drive",
                "scale",
                "the drive gives more or less effort than it should",
                "effort = gain x effort of the drive",
                "a static load at two efforts",
                {strength("gain", "1", 0, 5, 1)}},
       .action = +[](PhysicalScene& s, const Effect& e) { drive_of(s, e).gain *= parameter_of(e, "gain"); }},
  };
}

inline std::vector<EffectRow> body_effects() {
  using T = EffectTarget;
  return {
      {.kind = {"payload_mass",
                T::rigid_body,
                "inertia",
                "constant",
                "something is fastened to the body at its centre of mass",
                "mass = given + mass",
                "two poses and an acceleration",
                {strength("mass", "kg", -0.9, 100)}},
       .action = +[](PhysicalScene& s, const Effect& e) { rigid_of(s, e).mass += parameter_of(e, "mass"); },
       .log_prior = less_common},
      {.kind = {"center_of_mass_offset",
                T::rigid_body,
                "inertia",
                "constant",
                "the centre of mass is elsewhere, body frame",
                "c = given + (x, y, z)",
                "rest torque in two poses",
                {strength("x", "m", -1, 1), strength("y", "m", -1, 1), strength("z", "m", -1, 1)}},
       .action = +[](PhysicalScene& s, const Effect& e) { rigid_of(s, e).center_of_mass += vector(e); }},
      {.kind = {"gravity_tilt",
                T::scene,
                "gravity",
                "rotation",
                "the base does not stand level",
                "g = R_y(about_y) R_x(about_x) g_given",
                "free motion in two directions",
                {strength("about_x", "rad", -0.5, 0.5), strength("about_y", "rad", -0.5, 0.5)}},
       .action =
           +[](PhysicalScene& s, const Effect& e) {
             s.gravity = Eigen::AngleAxisd(parameter_of(e, "about_y"), Vec3::UnitY()) *
                         (Eigen::AngleAxisd(parameter_of(e, "about_x"), Vec3::UnitX()) * s.gravity);
           },
       .prior_sigma = tilt_of_a_level_base},
      {.kind = {"linear_drag",
                T::body,
                "body velocity",
                "quadratic",
                "the surroundings resist in proportion to speed",
                "F = -drag v",
                "two speeds",
                {strength("drag", "N s/m", 0, 1e3)}},
       .action = +[](DragNumbers& n, const Effect& e) { n.linear = parameter_of(e, "drag"); },
       .log_prior = rare_in_sight},
      {.kind = {"quadratic_drag",
                T::body,
                "body velocity",
                "cubic",
                "air resists with the square of speed",
                "F = -drag |v| v",
                "two speeds, a heavy body as control",
                {strength("drag", "N s^2/m^2", 0, 1e3)}},
       .action = +[](DragNumbers& n, const Effect& e) { n.quadratic = parameter_of(e, "drag"); }},
      {.kind = {"constant_force",
                T::body,
                "body position",
                "linear",
                "a steady force, such as wind, world frame",
                "F = (x, y, z)",
                "a flight or a rest beside the same without it",
                {strength("x", "N", -1e4, 1e4), strength("y", "N", -1e4, 1e4), strength("z", "N", -1e4, 1e4)}},
       .action = +[](DragNumbers& n, const Effect& e) { n.force = vector(e); },
       .prior_sigma = part_of_the_weight},
      {.kind = {"spin_drag",
                T::rigid_body,
                "body spin",
                "quadratic",
                "the surroundings resist turning",
                "torque = -drag omega",
                "a free spin",
                {strength("drag", "N m s/rad", 0, 100)}},
       .action = EffectTerm::spin_drag,
       .is_possible = is_not_carried},
      {.kind = {"push",
                T::rigid_body,
                "body point",
                "constant from one time to another",
                "a known force on a point of the body and a known torque, such as a push by hand, world frame",
                "F = (x, y, z), torque = (torque_x, torque_y, torque_z), while from < t < to",
                "none: a recording states what was done to a body",
                {strength("from", "s", 0, 1e6), strength("to", "s", 0, 1e6), shape("x", "N", -1e5, 1e5, 0),
                 shape("y", "N", -1e5, 1e5, 0), shape("z", "N", -1e5, 1e5, 0), shape("torque_x", "N m", -1e5, 1e5, 0),
                 shape("torque_y", "N m", -1e5, 1e5, 0), shape("torque_z", "N m", -1e5, 1e5, 0),
                 shape("point_x", "m", -100, 100, 0), shape("point_y", "m", -100, 100, 0),
                 shape("point_z", "m", -100, 100, 0)}},
       .action = EffectTerm::push,
       .is_possible = is_never_missing},
  };
}

inline std::vector<EffectRow> solid_effects() {
  using T = EffectTarget;
  return {
      {.kind = {"kelvin_voigt_damping",
                T::solid,
                "element strain rate",
                "quadratic",
                "the material is viscous beside its elasticity",
                "S = 2 viscosity E'",
                "ringing with two tip masses: high tones die sooner",
                {strength("viscosity", "Pa s", 0, 1e6)}},
       .action = +[](StrainNumbers& n, const Effect& e) { n.viscosity = parameter_of(e, "viscosity"); }},
      {.kind = {"mass_proportional_damping",
                T::deformable,
                "vertex velocity",
                "quadratic",
                "every particle is braked alike",
                "F_i = -rate m_i v_i",
                "ringing with two tip masses: all tones die alike",
                {strength("rate", "1/s", 0, 1e3)}},
       .action = +[](DragNumbers& n, const Effect& e) { n.linear_per_mass = parameter_of(e, "rate"); },
       .log_prior = rare_in_sight},
      {.kind = {"hysteretic_damping",
                T::solid,
                "element strain rate",
                "smoothed Coulomb",
                "the material loses the same share of its energy in every cycle, fast or slow",
                "S = 2 mu loss |E| E'/|E'|",
                "ringing with two tip masses at one amplitude",
                {strength("loss", "1", 0, 2), shape("strain_rate", "1/s", 1e-6, 1, 1e-3)}},
       .action =
           +[](StrainNumbers& n, const Effect& e) {
             n.loss = parameter_of(e, "loss");
             n.strain_rate = parameter_of(e, "strain_rate");
           },
       .rounding = "strain_rate"},
      {.kind = {"strain_stiffening",
                T::solid,
                "element strain",
                "quartic",
                "the material stiffens as it is strained",
                "S = 4 mu stiffening (E:E) E",
                "two amplitudes",
                {strength("stiffening", "1", 0, 1e4)}},
       .action = +[](StrainNumbers& n, const Effect& e) { n.stiffening = parameter_of(e, "stiffening"); }},
      {.kind = {"yeoh_terms",
                T::solid,
                "element strain",
                "cubic in the first invariant",
                "a rubber softens a little at moderate stretch and stiffens where its chains are drawn out",
                "psi = C10 (second y^2 + third y^3), y = J^(-2/3) |F|^2 - 3, C10 = mu / 2",
                "a pull to twice the length and beyond, in steps",
                {strength("second", "1", -0.5, 1e3), strength("third", "1", 0, 1e3)}},
       .action =
           +[](HyperelasticNumbers& n, const Effect& e) {
             n.yeoh_2 = parameter_of(e, "second");
             n.yeoh_3 = parameter_of(e, "third");
           },
       .log_prior = less_common},
      {.kind = {"ogden_term",
                T::solid,
                "element strain",
                "power of the principal stretches",
                "a rubber stiffens by a power of its stretch, in tension more than in compression",
                "psi = 2 mu modulus / exponent^2 sum((J^(-1/3) s_i)^exponent - 1), s_i: principal stretches",
                "a pull and a compression to the same force",
                {strength("modulus", "1", -0.9, 1e3), shape("exponent", "1", 0.5, 40, 8)}},
       .action =
           +[](HyperelasticNumbers& n, const Effect& e) {
             n.ogden = parameter_of(e, "modulus");
             n.exponent = parameter_of(e, "exponent");
           },
       .log_prior = less_common},
      {.kind = {"neo_hookean_logarithm",
                T::solid,
                "element strain",
                "logarithm of the first invariant",
                "the stable neo-Hookean density with its optional logarithm, of the same moduli (share 1)",
                "psi = share mu (|F|^2 / 6 - 1 / 2 - 2/3 log((|F|^2 + 1) / 4) - (J - 1)^2 / 12)",
                "large strains: small ones show no difference",
                {strength("share", "1", 0, 1)}},
       .action = +[](HyperelasticNumbers& n, const Effect& e) { n.logarithm = parameter_of(e, "share"); },
       .is_possible = is_never_missing},
      {.kind = {"rest_shape_error",
                T::solid,
                "rest shape",
                "curvature",
                "the body is bent when nothing acts on it",
                "along its longest axis s from where it is fastened (else its middle), across it: + curvature s^2 / 2",
                "the same body turned over",
                {strength("curvature_1", "1/m", -20, 20), strength("curvature_2", "1/m", -20, 20)}},
       .action =
           +[](PhysicalScene& s, const Effect& e) {
             bend_rest_shape(s, e.target, parameter_of(e, "curvature_1"), parameter_of(e, "curvature_2"));
           }},
      {.kind = {"plastic_yield",
                T::solid,
                "element strain",
                "yield",
                "strained beyond a limit it stays bent",
                "|dev log U| > yield_strain flows",
                "load, unload, wait: some of the bend stays at once",
                {{"yield_strain", "1", 1e-4, 10, 10, true, 10}}},
       .action = +[](FlowNumbers& n, const Effect& e) { n.yield_strain = parameter_of(e, "yield_strain"); }},
      {.kind = {"creep",
                T::solid,
                "element strain",
                "Maxwell flow",
                "held under load it gives way slowly",
                "(dev log U)' = -rate dev log U",
                "load, hold, unload, wait: the bend grows with time",
                {strength("rate", "1/s", 0, 10)}},
       .action = +[](FlowNumbers& n, const Effect& e) { n.rate += parameter_of(e, "rate"); }},
  };
}

inline std::vector<EffectRow> contact_effects() {
  using T = EffectTarget;
  return {
      {.kind = {"velocity_dependent_friction",
                T::contact,
                "contact slip",
                "Stribeck",
                "sliding friction differs from that at rest",
                "mu(v) = mu (1 + change (1 - exp(-v/velocity)))",
                "slides at two speeds",
                {strength("change", "1", -0.95, 5), shape("velocity", "m/s", 1e-4, 10, 0.1)}},
       .action =
           +[](ContactNumbers& n, const Effect& e) {
             n.slip_change = parameter_of(e, "change");
             n.slip_velocity = parameter_of(e, "velocity");
           },
       .log_prior = less_common},
      {.kind = {"anisotropic_friction",
                T::contact,
                "contact slip",
                "smoothed Coulomb",
                "friction differs by direction, first body's x",
                "mu = mu_given sqrt(cos^2 + (1 + change)^2 sin^2) of the angle from x",
                "slides in two directions",
                {strength("change", "1", -0.95, 50)}},
       .action = +[](ContactNumbers& n, const Effect& e) { n.across_change = parameter_of(e, "change"); },
       .log_prior = less_common},
      {.kind = {"adhesion",
                T::contact,
                "contact gap",
                "attraction",
                "the surfaces stick together",
                "energy per area = -energy (1 - g/d)^2 (1 + 2 g/d), g: gap below d",
                "a pull-off",
                {strength("energy", "J/m^2", 0, 1e3)}},
       .action = +[](ContactNumbers& n, const Effect& e) { n.adhesion = parameter_of(e, "energy"); },
       .log_prior = rare_between_stiff_bodies},
      {.kind = {"contact_dissipation",
                T::contact,
                "contact gap rate",
                "quadratic",
                "a touch takes energy from an impact",
                "N = N_elastic (1 - dissipation g')",
                "two drop heights",
                {strength("dissipation", "s/m", 0, 1e3)}},
       .action = +[](ContactNumbers& n, const Effect& e) { n.dissipation = parameter_of(e, "dissipation"); },
       .log_prior = less_common},
      {.kind = {"rolling_resistance",
                T::contact,
                "body spin",
                "smoothed Coulomb",
                "a rolling body is braked by what it presses on",
                "torque = -arm N omega/|omega| on the first body",
                "a roll-out at two speeds",
                {strength("arm", "m", 0, 0.1), shape("velocity", "rad/s", 1e-6, 1, 1e-2)}},
       .action = EffectTerm::rolling_resistance,
       .log_prior = less_common,
       .rounding = "velocity",
       .acts_on_first = true},
  };
}

inline std::vector<EffectRow> regressed_effects() {
  using T = EffectTarget;
  return {
      {.kind = {"regressed_effort",
                T::joint,
                "joint position and rate",
                REGRESSED,
                "a law of the joint's position and rate that a regression found",
                "effort = formula(q, v), v = q'",
                "free swings from several amplitudes",
                {}},
       .action = EffectTerm::joint_law},
      {.kind = {"regressed_force",
                T::rigid_body,
                "body position and velocity",
                REGRESSED,
                "a law of the body's place and velocity that a regression found, at its centre of mass, world frame",
                "F = formulas(x, y, z, vx, vy, vz)",
                "flights through several places at several speeds",
                {}},
       .action = EffectTerm::force_law},
  };
}

}  // namespace effect_list
}  // namespace pvg
