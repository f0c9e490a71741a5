#include "host/physics/energies/effects.hpp"

#include <algorithm>

#include "host/geometry/tet_mesh.hpp"
#include "host/model/effect_list.hpp"
#include "host/physics/energies/cloth.hpp"
#include "host/physics/energies/laws.hpp"

namespace pvg {
namespace {

template <class List>
auto named(List& list, const std::string& name) -> decltype(&list.front()) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
  return at == list.end() ? nullptr : &*at;
}

// force and drags of a whole body, shared by its nodes as its mass is
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
  DragNumbers numbers;
  add_numbers(effect, numbers);
  PointForce whole{};
  Eigen::Map<Vec3>(whole.force) = numbers.force;
  whole.linear = numbers.linear;
  whole.quadratic = numbers.quadratic;
  const auto of_particles = [&](u32 first_node, const std::vector<double>& masses) {
    double total = 0;
    for (const double mass : masses) total += mass;
    whole.linear += numbers.linear_per_mass * total;
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

template <EffectTerm>
void add_term(System&, std::size_t world, const Effect&);  // a term without a maker does not link

// its row of point_force gets its force before each step
template <>
void add_term<EffectTerm::force_law>(System& system, std::size_t world, const Effect& effect) {
  const std::vector<Formula> law = law_of(effect);
  const std::string text =
      "(real3)(" + law[0].kernel_text + ", " + law[1].kernel_text + ", " + law[2].kernel_text + ")";
  ForceLaw row{u32(system.point_force.rows.size()), number_of(system.force_laws, text), 0, {}};
  std::copy(effect.parameters.begin(), effect.parameters.end(), row.coefficient);
  system.force_law.push_back(row);
  add_point_force(system, world, effect);
}

// pushes of one point share their rows
template <>
void add_term<EffectTerm::push>(System& system, std::size_t world, const Effect& effect) {
  const PhysicalScene& scene = system.scenes[world];
  const auto of = [&](const std::string& name) { return parameter_of(effect, name); };
  const auto vector_of = [&](const std::string& name) { return Vec3(of(name + "x"), of(name + "y"), of(name + "z")); };
  Push push{world,
            int(named(scene.rigid_bodies, effect.target) - scene.rigid_bodies.data()),
            vector_of("point_"),
            of("from"),
            of("to"),
            vector_of(""),
            vector_of("torque_"),
            0};
  const auto same = std::find_if(system.pushes.begin(), system.pushes.end(), [&](const Push& other) {
    return other.world == world && other.rigid == push.rigid && other.point == push.point;
  });
  push.row = same != system.pushes.end() ? same->row : u32(system.point_force.rows.size());
  if (same == system.pushes.end()) {
    const u32 first = system.rigid_first_node[world][std::size_t(push.rigid)];
    for (const u32 site : {add_point_site(system, world, push.rigid, push.point), first + 1, first + 2, first + 3}) {
      PointForce row{};
      row.site[0] = site;
      system.point_force.rows.push_back(row);
    }
  }
  system.pushes.push_back(push);
}

template <>
void add_term<EffectTerm::spin_drag>(System& system, std::size_t world, const Effect& effect) {
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
Row strain_row(const Element& element, const StrainNumbers& numbers) {
  Row row{};
  std::copy(std::begin(element.site), std::end(element.site), row.site);
  std::copy_n(element.rest_inverse, 9, row.rest_inverse);
  row.volume = element.volume;
  row.stiffening = element.mu * numbers.stiffening;
  row.viscosity = numbers.viscosity;
  row.hysteresis = 2 * element.mu * numbers.loss;
  row.strain_rate = numbers.strain_rate;
  return row;
}

template <class Row, class Element>
Row hyperelastic_row(const Element& element, const HyperelasticNumbers& numbers) {
  Row row{};
  std::copy(std::begin(element.site), std::end(element.site), row.site);
  std::copy_n(element.rest_inverse, 9, row.rest_inverse);
  row.volume = element.volume;
  row.yeoh_2 = 0.5 * element.mu * numbers.yeoh_2;
  row.yeoh_3 = 0.5 * element.mu * numbers.yeoh_3;
  row.ogden = element.mu * numbers.ogden;
  row.exponent = numbers.exponent;
  row.logarithm = element.mu * numbers.logarithm;
  return row;
}

bool is_flow(const Effect& effect) {
  FlowNumbers ignored;
  return add_numbers(effect, ignored);
}

const Effect& first_flow(const PhysicalScene& scene, const std::string& target) {
  return *std::find_if(scene.effects.begin(), scene.effects.end(),
                       [&](const Effect& effect) { return is_flow(effect) && effect.target == target; });
}

PlasticFlow flow_of(const PhysicalScene& scene, const std::string& target, u32 world) {
  FlowNumbers numbers;
  for (const Effect& effect : scene.effects)
    if (effect.target == target) add_numbers(effect, numbers);
  PlasticFlow flow{0, world, 0, 0, 0};
  flow.rate = numbers.rate;
  flow.yield_strain = numbers.yield_strain;
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
  if (HyperelasticNumbers numbers; add_numbers(effect, numbers)) {
    for_each_element(system.stable_neo_hookean_4, first, n, [&](const StableNeoHookean4& element, u32) {
      system.hyperelastic_4.rows.push_back(hyperelastic_row<Hyperelastic4>(element, numbers));
    });
    for_each_element(system.stable_neo_hookean_10, first, n, [&](const StableNeoHookean10& element, u32) {
      system.hyperelastic_10.rows.push_back(hyperelastic_row<Hyperelastic10>(element, numbers));
    });
    return;
  }
  StrainNumbers numbers;
  add_numbers(effect, numbers);
  for_each_element(system.stable_neo_hookean_4, first, n, [&](const StableNeoHookean4& element, u32) {
    system.strain_effect_4.rows.push_back(strain_row<StrainEffect4>(element, numbers));
  });
  for_each_element(system.stable_neo_hookean_10, first, n, [&](const StableNeoHookean10& element, u32) {
    system.strain_effect_10.rows.push_back(strain_row<StrainEffect10>(element, numbers));
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

template <>
void add_term<EffectTerm::rolling_resistance>(System& system, std::size_t world, const Effect& effect) {
  const std::array<int, 2> pair = pair_of(system.scenes[world], effect.target);
  if (std::size_t(pair[0]) >= system.scenes[world].rigid_bodies.size())
    throw UsageError("effect rolling_resistance on " + effect.target + ": the first body must be a rigid one");
  const u32 first = system.rigid_first_node[world][std::size_t(pair[0])];
  system.rolling_resistance.push_back(
      {u32(system.spin.rows.size()), world, pair[0], pair[1], parameter_of(effect, "arm")});
  system.spin.rows.push_back({{first + 1, first + 2, first + 3}, 0, 0, 0, parameter_of(effect, "velocity"), 0});
}

template <>
void add_term<EffectTerm::joint_law>(System&, std::size_t, const Effect&) {}  // added with its joint (joint.cpp)

void add_term_of(System& system, std::size_t world, const Effect& effect, EffectTerm term) {
#define PVG_MAKER(name) add_term<EffectTerm::name>,
  static constexpr void (*MAKERS[])(System&, std::size_t, const Effect&) = {PVG_EFFECT_TERMS(PVG_MAKER)};
#undef PVG_MAKER
  MAKERS[std::size_t(term)](system, world, effect);
}

void add_contact(System& system, std::size_t world, const Effect& effect, const ContactNumbers& numbers) {
  const PhysicalScene& scene = system.scenes[world];
  const u32 first_body = u32(system.collision.bodies.size() - n_bodies(scene));
  const std::array<int, 2> pair = pair_of(scene, effect.target);
  ContactEffect contact;
  contact.first = first_body + u32(pair[0]);
  contact.second = first_body + u32(pair[1]);
  contact.adhesion = numbers.adhesion;
  contact.dissipation = numbers.dissipation;
  contact.across_change = numbers.across_change;
  contact.slip_change = numbers.slip_change;
  contact.slip_velocity = numbers.slip_velocity;
  contact.has_direction = std::size_t(pair[0]) < scene.rigid_bodies.size();
  if (contact.has_direction) contact.direction_site = system.rigid_first_node[world][std::size_t(pair[0])] + 1;
  system.collision.effects.push_back(contact);
}

bool is_on_contact(const Effect& effect) { return effect_kind(effect.name).target == EffectTarget::contact; }

}  // namespace

PhysicalScene with_effects(const PhysicalScene& scene) {
  check_effects(scene);
  PhysicalScene changed = scene;
  for (const Effect& effect : scene.effects) add_numbers(effect, changed);
  return changed;
}

void add_body_effects(System& system, std::size_t world) {
  for (const Effect& effect : system.scenes[world].effects) {
    if (is_on_contact(effect)) continue;
    const EffectAction& action = effect_row(effect.name).action;
    if (const EffectTerm* term = std::get_if<EffectTerm>(&action)) add_term_of(system, world, effect, *term);
    if (std::holds_alternative<void (*)(DragNumbers&, const Effect&)>(action)) add_point_force(system, world, effect);
    if (std::holds_alternative<void (*)(StrainNumbers&, const Effect&)>(action) ||
        std::holds_alternative<void (*)(HyperelasticNumbers&, const Effect&)>(action) || is_flow(effect))
      add_solid_effect(system, world, effect);
  }
}

void add_contact_effects(System& system, std::size_t world) {
  for (const Effect& effect : system.scenes[world].effects) {
    if (!is_on_contact(effect)) continue;
    ContactNumbers numbers;
    if (add_numbers(effect, numbers)) add_contact(system, world, effect, numbers);
    if (const EffectTerm* term = std::get_if<EffectTerm>(&effect_row(effect.name).action))
      add_term_of(system, world, effect, *term);
  }
}

}  // namespace pvg
