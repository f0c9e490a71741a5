#include "host/physics/energies/effects.hpp"

#include <algorithm>

#include "host/geometry/tet_mesh.hpp"
#include "host/physics/energies/cloth.hpp"
#include "host/physics/energies/laws.hpp"

namespace pvg {
namespace {

template <class List>
auto named(List& list, const std::string& name) -> decltype(&list.front()) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
  return at == list.end() ? nullptr : &*at;
}

Vec3 vector_of(const Effect& effect) {
  return {parameter_of(effect, "x"), parameter_of(effect, "y"), parameter_of(effect, "z")};
}

// Where along the axis a soft body is fastened: the mean of the nodes of its first stitch. Its middle if it is free.
double fastened_at(const PhysicalScene& scene, const SoftBody& body, Eigen::Index axis, double middle) {
  for (const Stitch& stitch : scene.stitches) {
    if (stitch.soft < 0 || &scene.soft_bodies[std::size_t(stitch.soft)] != &body) continue;
    double sum = 0;
    for (const std::uint32_t node : stitch.nodes) sum += body.mesh.points[node][axis];
    return sum / double(stitch.nodes.size());
  }
  return middle;
}

// Bends the rest shape in the body's frame: along its longest axis, at s from where it is fastened, by curvature
// s^2 / 2 across it. What holds it keeps its place and direction.
void bend_rest_shape(const PhysicalScene& scene, SoftBody& body, double curvature_1, double curvature_2) {
  Vec3 low = body.mesh.points[0], high = low;
  for (const Vec3& point : body.mesh.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const double origin = fastened_at(scene, body, axis, 0.5 * (low[axis] + high[axis]));
  for (Vec3& point : body.mesh.points) {
    const double s = point[axis] - origin;
    point[(axis + 1) % 3] += 0.5 * curvature_1 * s * s;
    point[(axis + 2) % 3] += 0.5 * curvature_2 * s * s;
  }
}

void apply(const Effect& effect, PhysicalScene& scene) {
  const auto value = [&](const char* name) { return parameter_of(effect, name); };
  if (Joint* joint = named(scene.joints, effect.target)) {
    Drive& drive = joint->drive;
    if (effect.name == "backlash") drive.play += value("play");
    if (effect.name == "actuator_gain") drive.gain *= value("gain");
    if (effect.name == "actuator_lag") drive.time_constant += value("time_constant");
    if (effect.name == "actuator_delay") drive.delay += value("delay");
  }
  if (RigidBody* body = named(scene.rigid_bodies, effect.target)) {
    if (effect.name == "payload_mass") body->mass += value("mass");
    if (effect.name == "center_of_mass_offset") body->center_of_mass += vector_of(effect);
  }
  if (effect.name == "gravity_tilt")
    scene.gravity = Eigen::AngleAxisd(value("about_y"), Vec3::UnitY()) *
                    (Eigen::AngleAxisd(value("about_x"), Vec3::UnitX()) * scene.gravity);
  if (effect.name == "rest_shape_error")
    bend_rest_shape(scene, *named(scene.soft_bodies, effect.target), value("curvature_1"), value("curvature_2"));
}

// force and drag of a whole body, shared by its nodes as its mass is
void add_point_force(System& system, u32 first_node, const std::vector<double>& masses, const PointForce& whole) {
  double total = 0;
  for (const double mass : masses) total += mass;
  for (u32 i = 0; i < masses.size(); ++i) {
    PointForce row = whole;
    const double share = masses[i] / total;
    row.site[0] = first_node + i;
    for (double& f : row.force) f *= share;
    row.linear *= share;
    row.quadratic *= share;
    system.point_force.rows.push_back(row);
  }
}

void add_point_force(System& system, std::size_t world, const Effect& effect) {
  const PhysicalScene& scene = system.scenes[world];
  PointForce whole{};
  if (effect.name == "linear_drag") whole.linear = parameter_of(effect, "drag");
  if (effect.name == "quadratic_drag") whole.quadratic = parameter_of(effect, "drag");
  if (effect.name == "constant_force") Eigen::Map<Vec3>(whole.force) = vector_of(effect);
  const auto of_particles = [&](u32 first_node, const std::vector<double>& masses) {
    double total = 0;
    for (const double mass : masses) total += mass;
    if (effect.name == "mass_proportional_damping") whole.linear = parameter_of(effect, "rate") * total;
    add_point_force(system, first_node, masses, whole);
  };
  if (const RigidBody* body = named(scene.rigid_bodies, effect.target)) {
    whole.site[0] = add_point_site(system, world, int(body - scene.rigid_bodies.data()), body->center_of_mass);
    system.point_force.rows.push_back(whole);
  } else if (const SoftBody* solid = named(scene.soft_bodies, effect.target)) {
    of_particles(system.soft_first_node[world][std::size_t(solid - scene.soft_bodies.data())],
                 node_masses(solid->mesh, solid->material.density));
  } else if (const Cloth* cloth = named(scene.cloths, effect.target)) {
    of_particles(system.cloth_first_node[world][std::size_t(cloth - scene.cloths.data())], cloth_node_masses(*cloth));
  }
}

// its row of point_force gets its force before each step
void add_force_law(System& system, std::size_t world, const Effect& effect) {
  const std::vector<Formula> law = law_of(effect);
  const std::string text =
      "(real3)(" + law[0].kernel_text + ", " + law[1].kernel_text + ", " + law[2].kernel_text + ")";
  ForceLaw row{u32(system.point_force.rows.size()), number_of(system.force_laws, text), 0, {}};
  std::copy(effect.parameters.begin(), effect.parameters.end(), row.coefficient);
  system.force_law.push_back(row);
  add_point_force(system, world, effect);
}

void add_spin_drag(System& system, std::size_t world, const Effect& effect) {
  const PhysicalScene& scene = system.scenes[world];
  const std::size_t body = std::size_t(named(scene.rigid_bodies, effect.target) - scene.rigid_bodies.data());
  const u32 first = system.rigid_first_node[world][body];
  system.spin.rows.push_back({{first + 1, first + 2, first + 3}, 0, parameter_of(effect, "drag"), 0, 1, 0});
}

// Calls add(element, number) for each element of the world being added whose first site is one of the solid's nodes.
template <class Rows, class Add>
void for_each_element(const Rows& rows, u32 first_node, std::size_t n_nodes, const Add& add) {
  for (u32 e = rows.world_first.back(); e < rows.rows.size(); ++e)
    if (const u32 node = rows.rows[e].site[0]; node >= first_node && node < first_node + n_nodes) add(rows.rows[e], e);
}

template <class Row, class Element>
Row strain_row(const Element& element, const Effect& effect) {
  Row row{};
  std::copy(std::begin(element.site), std::end(element.site), row.site);
  std::copy_n(element.rest_inverse, 9, row.rest_inverse);
  row.volume = element.volume;
  row.strain_rate = 1;
  if (effect.name == "strain_stiffening") row.stiffening = element.mu * parameter_of(effect, "stiffening");
  if (effect.name == "kelvin_voigt_damping") row.viscosity = parameter_of(effect, "viscosity");
  if (effect.name == "hysteretic_damping") {
    row.hysteresis = 2 * element.mu * parameter_of(effect, "loss");
    row.strain_rate = parameter_of(effect, "strain_rate");
  }
  return row;
}

bool is_flow(const Effect& effect) { return effect.name == "plastic_yield" || effect.name == "creep"; }

const Effect& first_flow(const PhysicalScene& scene, const std::string& target) {
  return *std::find_if(scene.effects.begin(), scene.effects.end(),
                       [&](const Effect& effect) { return is_flow(effect) && effect.target == target; });
}

PlasticFlow flow_of(const PhysicalScene& scene, const std::string& target, u32 world) {
  PlasticFlow flow{0, world, 0, 0, 0};
  for (const Effect& effect : scene.effects) {
    if (effect.target != target || !is_flow(effect)) continue;
    if (effect.name == "creep") flow.rate += parameter_of(effect, "rate");
    if (effect.name == "plastic_yield") flow.yield_strain = parameter_of(effect, "yield_strain");
  }
  return flow;
}

void add_solid_effect(System& system, std::size_t world, const Effect& effect) {
  const PhysicalScene& scene = system.scenes[world];
  const SoftBody* solid = named(scene.soft_bodies, effect.target);
  const u32 first = system.soft_first_node[world][std::size_t(solid - scene.soft_bodies.data())];
  const std::size_t n = solid->mesh.points.size();
  if (is_flow(effect)) {
    if (&effect != &first_flow(scene, effect.target)) return;  // its elements flow by all of them at once
    const PlasticFlow flow = flow_of(scene, effect.target, u32(world));
    const auto add_to = [&](std::vector<PlasticFlow>& flows) {
      return [&flows, flow](const auto&, u32 e) {
        flows.push_back(flow);
        flows.back().element = e;
      };
    };
    for_each_element(system.stable_neo_hookean_4, first, n, add_to(system.plastic_flow_4));
    for_each_element(system.stable_neo_hookean_10, first, n, add_to(system.plastic_flow_10));
    return;
  }
  for_each_element(system.stable_neo_hookean_4, first, n, [&](const StableNeoHookean4& element, u32) {
    system.strain_effect_4.rows.push_back(strain_row<StrainEffect4>(element, effect));
  });
  for_each_element(system.stable_neo_hookean_10, first, n, [&](const StableNeoHookean10& element, u32) {
    system.strain_effect_10.rows.push_back(strain_row<StrainEffect10>(element, effect));
  });
}

int body_number(const PhysicalScene& scene, const std::string& name) {
  for (std::size_t b = 0; b < n_bodies(scene); ++b)
    if (body_name(scene, b) == name) return int(b);
  return -1;
}

std::array<int, 2> pair_of(const PhysicalScene& scene, const std::string& target) {
  const std::array<std::string, 2> sides = sides_of(scene, target).value();  // checked before
  return {body_number(scene, sides[0]), body_number(scene, sides[1])};
}

void add_rolling_resistance(System& system, std::size_t world, const Effect& effect, const std::array<int, 2>& pair) {
  if (std::size_t(pair[0]) >= system.scenes[world].rigid_bodies.size())
    throw UsageError("effect rolling_resistance on " + effect.target + ": the first body must be a rigid one");
  const u32 first = system.rigid_first_node[world][std::size_t(pair[0])];
  system.rolling_resistance.push_back(
      {u32(system.spin.rows.size()), world, pair[0], pair[1], parameter_of(effect, "arm")});
  system.spin.rows.push_back({{first + 1, first + 2, first + 3}, 0, 0, 0, parameter_of(effect, "velocity"), 0});
}

}  // namespace

PhysicalScene with_effects(const PhysicalScene& scene) {
  check_effects(scene);
  PhysicalScene changed = scene;
  for (const Effect& effect : scene.effects) apply(effect, changed);
  return changed;
}

void add_body_effects(System& system, std::size_t world) {
  for (const Effect& effect : system.scenes[world].effects) {
    const std::string& name = effect.name;
    if (name == "linear_drag" || name == "quadratic_drag" || name == "constant_force" ||
        name == "mass_proportional_damping")
      add_point_force(system, world, effect);
    if (name == "regressed_force") add_force_law(system, world, effect);
    if (name == "spin_drag") add_spin_drag(system, world, effect);
    if (name == "kelvin_voigt_damping" || name == "hysteretic_damping" || name == "strain_stiffening" ||
        name == "plastic_yield" || name == "creep")
      add_solid_effect(system, world, effect);
  }
}

void add_contact_effects(System& system, std::size_t world) {
  const PhysicalScene& scene = system.scenes[world];
  const u32 first_body = u32(system.collision.bodies.size() - n_bodies(scene));
  for (const Effect& effect : scene.effects) {
    if (effect_kind(effect.name).target != EffectTarget::contact) continue;
    const auto value = [&](const char* name) { return parameter_of(effect, name); };
    const std::array<int, 2> pair = pair_of(scene, effect.target);
    if (effect.name == "rolling_resistance") {
      add_rolling_resistance(system, world, effect, pair);
      continue;
    }
    ContactEffect contact;
    contact.first = first_body + u32(pair[0]);
    contact.second = first_body + u32(pair[1]);
    if (effect.name == "adhesion") contact.adhesion = value("energy");
    if (effect.name == "contact_dissipation") contact.dissipation = value("dissipation");
    if (effect.name == "anisotropic_friction") contact.across_change = value("change");
    if (effect.name == "velocity_dependent_friction") {
      contact.slip_change = value("change");
      contact.slip_velocity = value("velocity");
    }
    contact.has_direction = std::size_t(pair[0]) < scene.rigid_bodies.size();
    if (contact.has_direction) contact.direction_site = system.rigid_first_node[world][std::size_t(pair[0])] + 1;
    system.collision.effects.push_back(contact);
  }
}

}  // namespace pvg
