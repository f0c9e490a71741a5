#include "host/physics/step/simulation.hpp"

#include "host/base/counted.hpp"
#include "host/geometry/tet_mesh.hpp"
#include "host/model/display.hpp"
#include "host/physics/energies/prescribed_motion.hpp"
#include "host/physics/step/checkpoint_worlds.hpp"
#include "host/physics/step/newton_tolerance.hpp"
#include "host/physics/step/separate_bodies.hpp"
#include "host/physics/step/simulation_impl.hpp"

namespace pvg {
namespace {

std::vector<ContactSettings> contact_settings(const System& system) {
  std::vector<ContactSettings> settings;
  for (const PhysicalScene& scene : system.scenes) settings.push_back(scene.contact);
  return settings;
}

std::vector<Vec3> to_points(const std::vector<double>& values) {
  std::vector<Vec3> points(values.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = Eigen::Map<const Vec3>(&values[3 * i]);
  return points;
}

std::vector<PhysicalScene> separated(std::span<const PhysicalScene> worlds) {
  std::vector<PhysicalScene> scenes(worlds.begin(), worlds.end());
  for (PhysicalScene& scene : scenes)
    if (scene.separates_start) separate_bodies(scene);
  return scenes;
}

std::string body_name(const System& system, u32 body) {
  for (const PhysicalScene& scene : system.scenes) {
    if (body < n_bodies(scene)) return body_name(scene, body);
    body -= u32(n_bodies(scene));
  }
  return "?";
}

std::vector<std::vector<NodePair>> node_pairs(const std::vector<std::vector<double>>& worlds, std::size_t n_nodes) {
  std::vector<std::vector<NodePair>> pairs(worlds.size());
  for (std::size_t w = 0; w < worlds.size(); ++w)
    for (std::size_t i = 0; i + 1 < worlds[w].size(); i += 2) {
      const double a = worlds[w][i], b = worlds[w][i + 1];
      if (!(a >= 0) || !(b >= 0) || !(a < double(n_nodes)) || !(b < double(n_nodes)))
        throw UsageError("the checkpoint couples nodes that the scene does not have");
      pairs[w].push_back({u32(a), u32(b)});
    }
  return pairs;
}

// with which Newton's method may end [m]
double largest_correction(const System& system) {
  double largest = 0;
  for (const PhysicalScene& scene : system.scenes)
    largest = std::max(largest, newton_tolerance(scene) * scene.solver.time_step);
  return largest;
}

// One solve steps all worlds, so what rules it is the same in all.
void demand_common_settings(std::span<const PhysicalScene> worlds) {
  const PhysicalScene& first = worlds.front();
  for (const PhysicalScene& scene : worlds) {
    const SolverSettings &a = first.solver, &b = scene.solver;
    const std::pair<const char*, bool> settings[] = {
        {"time_step", a.time_step == b.time_step},
        {"solver.integrator", a.integrator == b.integrator},
        {"solver.preconditioner", a.preconditioner == b.preconditioner},
        {"solver.cg_tolerance", a.cg_tolerance == b.cg_tolerance},
        {"solver.max_cg", a.max_cg == b.max_cg},
        {"solver.max_newton", a.max_newton == b.max_newton},
        {"solver.max_step_halvings", a.max_step_halvings == b.max_step_halvings},
        {"contact.friction_lag_passes", first.contact.friction_lag_passes == scene.contact.friction_lag_passes}};
    for (const auto& [name, is_common] : settings)
      if (!is_common)
        throw UsageError("scene " + scene.name + " has another `" + name + "` than scene " + first.name +
                         ", with which it is to be simulated; give both the same, or simulate them apart");
  }
}

}  // namespace
Simulation::Impl::Impl(Device& device_, std::span<const PhysicalScene> worlds)
    : device(device_),
      clock(device_),
      nominal(separated(worlds)),
      system(make_system(nominal)),
      potential(device, system),
      nodes_program(device, "solve/nodes.cl"),
      newton_program(device, "solve/newton.cl"),
      move_along(nodes_program.kernel("move_along")),
      place_nodes(nodes_program.kernel("place_nodes")),
      halve_and_move(nodes_program.kernel("halve_and_move")),
      move_certified(newton_program.kernel("move_certified")),
      measure_and_move(newton_program.kernel("measure_and_move")),
      node_world(device, system.node_world, "world"),
      is_active_on_device(device, worlds.size(), "is_active"),
      prescribed_nodes(device, 0, "prescribed nodes"),
      dx(device, system.x.size(), "dx"),
      gradient(device, system.x.size(), "gradient"),
      step(device, worlds.size(), "step"),
      halved_step(device, worlds.size(), "halved step"),
      full_step(device, worlds.size(), "full step"),
      largest(device, worlds.size(), "largest"),
      tolerance(device, worlds.size(), "tolerance"),
      energy_before(device, worlds.size(), "energy before"),
      integrator(device, system),
      x(device, system.n_nodes(), system.sites.size(), "x"),
      start(device, system.n_nodes(), system.sites.size(), "x0"),
      predicted(device, system.n_nodes(), system.sites.size(), "predicted"),
      trial(device, system.n_nodes(), system.sites.size(), "second x"),        // changes places with x
      before_guess(device, system.n_nodes(), system.sites.size(), "third x"),  // and with trial
      contacts([&] {
        x.node.write(system.x);
        potential.update_sites(x);
        return ContactSet(device, system.collision, contact_settings(system), to_points(x.site.read()),
                          largest_correction(system));
      }()),
      cg(device, system.node_world, worlds.size(), system.node_ranges),
      reduce(device, worlds.size()),
      speed_chunks(device, worlds.size()),
      largest_move(worlds.size()),
      moved_energy(worlds.size()),
      longest(worlds.size()),
      certified(worlds.size()),
      nodes(system.x.size()),
      velocities(system.x.size()),
      velocities_before(system.x.size()),
      velocities_two_before(system.x.size()),
      start_nodes(system.x.size()),
      nodes_before(system.x.size()),
      prescribed_values(device, 0, "prescribed values") {
  for (const PhysicalScene& scene : system.scenes) least_stop.push_back(newton_tolerance(scene));
  tolerance.write(least_stop);
  has_prescribed = has_prescribed_bodies(system);
  std::vector<u32> own;
  for_each_prescribed([&](u32 first) {
    for (u32 k = 0; k < 4; ++k) own.push_back(first / 3 + k);
  });
  prescribed_nodes.resize(own.size());
  prescribed_nodes.write(own);
  prescribed_values.resize(3 * own.size());
  speed_chunks.set(system.speed_ranges);
  is_retired.assign(worlds.size(), false);
  is_intact.assign(worlds.size(), true);
  is_active = is_unsettled = is_intact;
  const std::size_t n = worlds.size();
  states.resize(n);
  expected.resize(n);
  energy.resize(n);
  pressing.resize(system.rolling_resistance.size());
  reports.resize(n);
  for (std::size_t w = 0; w < n; ++w) {
    const PhysicalScene& scene = system.scenes[w];
    carried.push_back(carried_bodies(scene));
    soft_masses.emplace_back();
    for (const SoftBody& body : nominal[w].soft_bodies)
      soft_masses[w].push_back(node_masses(body.mesh, body.material.density));
    const std::size_t n_joints = scene.joints.size();
    drives.emplace_back(n_joints);
    states[w].reading = unloaded_readings(nominal[w]);
    states[w].joint_position.resize(n_joints);
    states[w].joint_effort.resize(n_joints);
    states[w].joint_stop_effort.resize(n_joints);
    states[w].joint_damping_effort.resize(n_joints);
    last_targets.emplace_back();
    for (std::size_t j = 0; j < n_joints; ++j) {
      states[w].joint_position[j] = scene.joints[j].initial;
      if (is_driven(scene.joints[j]))
        last_targets[w].push_back(scene.joints[j].drive.mode == Drive::Mode::position ? scene.joints[j].initial : 0);
    }
    actuators.emplace_back(scene, last_targets[w]);
    joint_motion.push_back(initial_motion(scene));
    target_change.emplace_back(n_joints, 0.0);
    restitution.push_back(restitution_pairs(scene));
  }
  start.node.copy_from(x.node);
  potential.update_sites(start);
  read_state(0);
  refuse_start_conflicts();
}
void Simulation::Impl::refuse_start_conflicts() {
  const auto conflict = contacts.find_start_conflict(to_points(x.site.read()));
  if (!conflict) return;
  const std::string first = body_name(system, conflict->first_body), second = body_name(system, conflict->second_body);
  throw UsageError("bodies " + first + " and " + second + " of scene " + system.scenes[conflict->world].name +
                   (conflict->intersects ? " intersect at the start" : " start closer than their contact offsets") +
                   "; move them apart (`pose`)");
}
Simulation::Simulation(Device& device, std::span<const PhysicalScene> worlds) {
  if (worlds.empty()) throw UsageError("a simulation needs at least one scene");
  demand_common_settings(worlds);
  impl_ = std::make_unique<Impl>(device, worlds);
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

std::vector<StepReport> Simulation::step(std::span<const std::vector<double>> targets) {
  Impl& impl = *impl_;
  if (targets.size() != n_worlds())
    throw UsageError("step was given targets for " + counted(targets.size(), "world") + ", there are " +
                     std::to_string(n_worlds()));
  for (std::size_t w = 0; w < n_worlds(); ++w)
    if (!impl.is_retired[w] && targets[w].size() != impl.last_targets[w].size())
      throw UsageError("scene " + impl.system.scenes[w].name + " has " +
                       counted(impl.last_targets[w].size(), "driven joint") + ", was given " +
                       counted(targets[w].size(), "target"));
  impl.reports.assign(n_worlds(), StepReport{});
  std::vector<std::vector<double>> wanted;
  for (std::size_t w = 0; w < n_worlds(); ++w)
    wanted.push_back(impl.is_retired[w] ? impl.last_targets[w]
                                        : impl.actuators[w].command(targets[w], impl.last_targets[w]));
  std::vector<char> stepping(n_worlds());
  for (std::size_t w = 0; w < n_worlds(); ++w) stepping[w] = !impl.is_retired[w];
  const std::vector<char> failed =
      impl.advance_or_halve(impl.h(), impl.last_targets, wanted, stepping, impl.solver().max_step_halvings);
  std::vector<StepEvent> last_events;
  std::string message;
  for (std::size_t w = 0; w < n_worlds(); ++w) {
    if (!stepping[w]) continue;
    if (!failed[w]) {
      impl.last_targets[w] = wanted[w];
      impl.actuators[w].accept(targets[w]);
      continue;
    }
    last_events.push_back(impl.reports[w].events.back());
    message += (message.empty() ? "" : "; ") + describe(last_events.back(), impl.system.scenes[w].name);
  }
  impl.expected.assign(n_worlds(), {});
  if (!last_events.empty()) throw StepFailure(message, last_events);
  return impl.reports;
}

void Simulation::expect(std::size_t world, std::vector<double> motion) {
  const WorldRange& range = impl_->system.node_ranges.at(world);
  if (motion.size() != 3 * std::size_t(range.end - range.begin))
    throw UsageError("a motion of " + counted(motion.size() / 3, "node") + " is expected of a world of " +
                     std::to_string(range.end - range.begin));
  impl_->expected.at(world) = std::move(motion);
}

const std::vector<StepReport>& Simulation::reports() const { return impl_->reports; }

void Simulation::retire(std::size_t world) { impl_->is_retired.at(world) = true; }
void Simulation::resume(std::size_t world) { impl_->is_retired.at(world) = false; }

Checkpoint Simulation::checkpoint() const {
  Checkpoint checkpoint{impl_->x.node.read(),
                        impl_->integrator.history(),
                        impl_->contacts.lagged().anchors(),
                        {},
                        {},
                        impl_->last_targets,
                        {},
                        {},
                        impl_->pressing,
                        {},
                        impl_->potential.flowed(),
                        {}};
  for (const Actuators& actuators : impl_->actuators) checkpoint.past_targets.push_back(actuators.past());
  for (const std::vector<NodePair>& pairs : impl_->potential.couplings()) {
    checkpoint.couplings.emplace_back();
    for (const auto& [a, b] : pairs)
      checkpoint.couplings.back().insert(checkpoint.couplings.back().end(), {double(a), double(b)});
  }
  for (const WorldState& state : impl_->states) {
    checkpoint.time.push_back(state.time);
    checkpoint.joint_position.push_back(state.joint_position);
    checkpoint.joint_motion.push_back(to_numbers(impl_->joint_motion[checkpoint.time.size() - 1]));
    checkpoint.reading.push_back(state.reading);
  }
  return checkpoint;
}

void Simulation::restore(const Checkpoint& checkpoint) {
  Impl& impl = *impl_;
  const MotionHistory& history = checkpoint.history;
  bool fits = checkpoint.time.size() == n_worlds() && checkpoint.joint_position.size() == n_worlds() &&
              checkpoint.targets.size() == n_worlds() && checkpoint.anchors.size() == n_worlds() &&
              checkpoint.joint_motion.size() == n_worlds() && checkpoint.couplings.size() == n_worlds() &&
              checkpoint.reading.size() == n_worlds() && checkpoint.past_targets.size() == n_worlds() &&
              checkpoint.pressing.size() == impl.pressing.size() &&
              checkpoint.flowed.size() == impl.potential.flowed().size() && history.length_before.size() == n_worlds();
  for (const std::vector<double>* nodes : {&checkpoint.position, &history.velocity, &history.position_before,
                                           &history.velocity_before, &history.velocity_two_before})
    fits = fits && nodes->size() == impl.x.node.size();
  for (std::size_t w = 0; fits && w < n_worlds(); ++w)
    fits = checkpoint.joint_position[w].size() == impl.system.scenes[w].joints.size() &&
           checkpoint.joint_motion[w].size() == 4 * impl.system.scenes[w].joints.size() &&
           checkpoint.reading[w].size() == impl.nominal[w].displays.size() &&
           checkpoint.targets[w].size() == impl.last_targets[w].size() &&
           impl.actuators[w].restore(checkpoint.past_targets[w]);
  if (!fits) throw UsageError("the checkpoint was made from another scene; resume with the scene that it came from");
  impl.x.node.write(checkpoint.position);
  impl.potential.update_sites(impl.x);
  impl.integrator.restore(checkpoint.history);
  impl.knows_motion = false;
  impl.contacts.lagged().restore_anchors(checkpoint.anchors);
  impl.last_targets = checkpoint.targets;
  impl.pressing = checkpoint.pressing;
  impl.potential.restore_flowed(checkpoint.flowed);
  impl.potential.restore_couplings(node_pairs(checkpoint.couplings, impl.system.n_nodes()));
  for (std::size_t w = 0; w < n_worlds(); ++w) {
    impl.states[w].time = checkpoint.time[w];
    impl.states[w].joint_position = checkpoint.joint_position[w];
    impl.joint_motion[w] = to_motion(checkpoint.joint_motion[w]);
    impl.states[w].reading = checkpoint.reading[w];
    impl.states[w].contacts.clear();
    impl.is_intact[w] = true;
  }
  impl.read_state(0);
}

SolverCounts Simulation::counts() const {
  SolverCounts counts = impl_->counts;
  counts.all = impl_->device.counts() - impl_->counted_from;
  counts.phases = impl_->clock.counts;
  return counts;
}
void Simulation::restart_counts() {
  impl_->counts = {};
  impl_->clock.counts = {};
  impl_->counted_from = impl_->device.counts();
}

std::vector<Checkpoint> Simulation::world_checkpoints() const { return split(checkpoint(), impl_->system); }

void Simulation::restore_worlds(std::span<const std::optional<Checkpoint>> worlds) {
  Checkpoint whole = checkpoint();
  if (!put(whole, worlds, impl_->system))
    throw UsageError("a world's checkpoint was made from another scene; resume with the scene that it came from");
  restore(whole);
}

void Simulation::measure_phases() {
  impl_->clock.is_on = true;
  impl_->clock.seconds = {};
}
const PhaseSeconds& Simulation::phase_seconds() const { return impl_->clock.seconds; }

std::size_t Simulation::n_worlds() const { return impl_->system.n_worlds(); }
const WorldState& Simulation::state(std::size_t world) const { return impl_->states[world]; }

}  // namespace pvg
