#include "host/physics/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/geometry/tet_mesh.hpp"
#include "host/physics/conjugate_gradients.hpp"
#include "host/physics/extrapolation.hpp"
#include "host/physics/joint.hpp"
#include "host/physics/potential.hpp"
#include "host/physics/time_integration.hpp"

namespace pvg {
namespace {

constexpr int MAX_LINE_SEARCH = 40;  // halvings of one Newton step
constexpr int MAX_LAG_PASSES = 50;   // renewals of the lagged normal forces, where they are to converge

std::vector<ContactSettings> contact_settings(const System& system) {
  std::vector<ContactSettings> settings;
  for (const Scene& scene : system.scenes) settings.push_back(scene.contact);
  return settings;
}

std::vector<Vec3> to_points(const std::vector<double>& values) {
  std::vector<Vec3> points(values.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = Eigen::Map<const Vec3>(&values[3 * i]);
  return points;
}

std::string body_name(const System& system, u32 body) {
  for (const Scene& scene : system.scenes) {
    if (body < n_bodies(scene)) return body_name(scene, body);
    body -= u32(n_bodies(scene));
  }
  return "?";
}

}  // namespace

struct Simulation::Impl {
  Impl(Device& device, std::span<const Scene> worlds);

  // one step of length h toward `targets`, from `previous` targets; throws StepFailure with x, v as they were before
  void advance(double h, const std::vector<std::vector<double>>& previous,
               const std::vector<std::vector<double>>& targets);
  // the same, halving where it fails
  void advance_or_halve(double h, const std::vector<std::vector<double>>& previous,
                        const std::vector<std::vector<double>>& targets, int halvings_left);

  void refuse_start_conflicts();
  void set_drives(const std::vector<std::vector<double>>& previous, const std::vector<std::vector<double>>& targets);
  void move_to_first_guess(double h);
  void move(const std::vector<double>& length);  // trial = x + length dx, per world
  // Newton; true where the first correction was within the tolerance already
  bool minimize(double h);
  std::vector<double> find_direction();  // dx, and the largest speed of a point per world, times h [m]
  void line_search(const std::vector<double>& certified);
  void read_state(double h);
  void read_joints(double h);

  double h() const { return system.scenes[0].solver.time_step; }
  const SolverSettings& solver() const { return system.scenes[0].solver; }

  Device& device;
  System system;
  Potential potential;
  Program nodes_program;
  Kernel move_along;
  Buffer<u32> node_world;
  Buffer<f64> dx, gradient, step, largest;
  TimeIntegrator integrator;
  Positions x, start, predicted, trial;
  ContactSet contacts;
  ConjugateGradients cg;
  WorldReduce reduce;
  WorldChunks speed_chunks;
  Positions direction;

  std::vector<std::vector<Carried>> carried;                  // [n_worlds][n_joints]
  std::vector<std::vector<std::vector<double>>> soft_masses;  // [n_worlds][n_soft][n_nodes, kg]
  std::vector<std::vector<double>> feed_forward;              // [n_worlds][n_joints], of this step
  std::vector<std::vector<double>> target, target_change;     // [n_worlds][n_joints]
  std::vector<std::vector<double>> last_targets;              // as given to step
  std::vector<char> is_active;                                // worlds that have not converged in this step
  std::vector<WorldState> states;
  std::vector<StepReport> reports;
};

Simulation::Impl::Impl(Device& device_, std::span<const Scene> worlds)
    : device(device_),
      system(make_system(worlds)),
      potential(device, system),
      nodes_program(device, "solve/nodes.cl"),
      move_along(nodes_program.kernel("move_along")),
      node_world(device, system.node_world, "world"),
      dx(device, system.x.size(), "dx"),
      gradient(device, system.x.size(), "gradient"),
      step(device, worlds.size(), "step"),
      largest(device, worlds.size(), "largest"),
      integrator(device, system),
      x(device, system.n_nodes(), system.sites.size(), "x"),
      start(device, system.n_nodes(), system.sites.size(), "x0"),
      predicted(device, system.n_nodes(), system.sites.size(), "predicted"),
      trial(device, system.n_nodes(), system.sites.size(), "trial"),
      contacts([&] {
        x.node.write(system.x);
        potential.update_sites(x);
        return ContactSet(device, system.collision, contact_settings(system), to_points(x.site.read()));
      }()),
      cg(device, system.node_world, worlds.size(), system.node_ranges),
      reduce(device, worlds.size()),
      speed_chunks(device, worlds.size()),
      direction(device, system.n_nodes(), system.sites.size(), "direction") {
  speed_chunks.set(system.speed_ranges);
  const std::size_t n = worlds.size();
  states.resize(n);
  reports.resize(n);
  for (std::size_t w = 0; w < n; ++w) {
    const Scene& scene = system.scenes[w];
    if (scene.solver.time_step != system.scenes[0].solver.time_step)
      throw UsageError("worlds that are simulated together must have the same time step");
    carried.push_back(carried_bodies(scene));
    soft_masses.emplace_back();
    for (const SoftBody& body : scene.soft_bodies)
      soft_masses[w].push_back(node_masses(body.mesh, body.material.density));
    const std::size_t n_joints = scene.joints.size();
    feed_forward.emplace_back(n_joints, 0);
    target.emplace_back(n_joints, 0);
    target_change.emplace_back(n_joints, 0);
    states[w].joint_position.resize(n_joints);
    states[w].joint_effort.resize(n_joints);
    last_targets.emplace_back();
    for (std::size_t j = 0; j < n_joints; ++j) {
      states[w].joint_position[j] = scene.joints[j].initial;
      if (scene.joints[j].drive.stiffness > 0 || scene.joints[j].drive.damping > 0)
        last_targets[w].push_back(scene.joints[j].initial);
    }
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
                   "; move them apart");
}

void Simulation::Impl::set_drives(const std::vector<std::vector<double>>& previous,
                                  const std::vector<std::vector<double>>& targets) {
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    const Scene& scene = system.scenes[w];
    std::size_t driven = 0;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      if (!(joint.drive.stiffness > 0 || joint.drive.damping > 0)) continue;
      target[w][j] = targets[w][driven];
      target_change[w][j] = targets[w][driven] - previous[w][driven];
      ++driven;
      feed_forward[w][j] = joint.drive.compensates_gravity
                               ? gravity_feed_forward(scene, joint, carried[w][j], states[w], soft_masses[w])
                               : 0;
      const auto fill = [&](auto& row) {
        row.target = target[w][j];
        row.target_change = target_change[w][j];
        row.feed_forward = feed_forward[w][j];
      };
      if (const int row = system.revolute_row[w][j]; row >= 0) {
        fill(system.revolute_drive.rows[row]);
        system.revolute_drive.rows[row].angle0 = states[w].joint_position[j];
      }
      if (const int row = system.prismatic_row[w][j]; row >= 0) fill(system.prismatic_drive.rows[row]);
    }
  }
  potential.set_drives(system.revolute_drive.rows, system.prismatic_drive.rows);
}

// From the start of the step to where the velocities lead, as far as no contact is in the way.
void Simulation::Impl::move_to_first_guess(double h) {
  dx.write(extrapolated_motion(system, x.node.read(), integrator.velocity().read(), h));
  move(std::vector<double>(is_active.size(), 1.0));
  contacts.find_candidates(x.site, trial.site);
  std::vector<double> certified = contacts.largest_step(x.site, trial.site);
  // a guess that ends just short of touching would start Newton where the barrier is steepest
  for (double& length : certified)
    if (length < 1) length *= 0.5;
  move(certified);
  std::swap(x, trial);
}

// trial = x + length dx, per world
void Simulation::Impl::move(const std::vector<double>& length) {
  step.write(length);
  const u32 n = u32(system.n_nodes());
  move_along(n, n, node_world, step, x.node, dx, trial.node);
  potential.update_sites(trial);
}

std::vector<double> Simulation::Impl::find_direction() {
  contacts.find_contacts(x.site);
  potential.differentiate(x, contacts.contacts(), gradient);
  potential.factorize(is_active);
  const CgReport report =
      cg.solve([&](const Buffer<f64>& p, Buffer<f64>& out) { potential.product(p, out); }, potential.preconditioner(),
               gradient, is_active, solver().cg_tolerance, solver().max_cg, dx);
  for (std::size_t w = 0; w < reports.size(); ++w) {
    reports[w].cg += report.iterations[w];
    reports[w].newton += is_active[w];
    if (is_active[w] && !report.has_converged[w])
      throw StepFailure("conjugate gradients did not converge within " + std::to_string(solver().max_cg) +
                        " iterations in scene " + system.scenes[w].name);
  }
  direction.node.copy_from(dx);
  potential.update_sites(direction);
  reduce.largest_length(speed_chunks, direction.site, largest);
  return largest.read();
}

// Halves each world's step until its energy does not rise. Contact was certified by `certified`, so no pair touches.
void Simulation::Impl::line_search(const std::vector<double>& certified) {
  const std::vector<double> before = potential.energy(x, contacts.candidates());
  std::vector<double> length = certified;
  for (int halving = 0; halving < MAX_LINE_SEARCH; ++halving) {
    move(length);
    const std::vector<double> after = potential.energy(trial, contacts.candidates());
    bool all_fell = true;
    for (std::size_t w = 0; w < length.size(); ++w) {
      // a rise within rounding counts as none
      const bool fell = after[w] <= before[w] + 1e-12 * std::abs(before[w]);
      if (fell) continue;
      all_fell = false;
      length[w] /= 2;
    }
    if (all_fell) {
      std::swap(x, trial);
      return;
    }
  }
  for (std::size_t w = 0; w < length.size(); ++w)
    if (length[w] < certified[w] * std::ldexp(1.0, 1 - MAX_LINE_SEARCH))
      throw StepFailure("the line search found no decrease of the energy in scene " + system.scenes[w].name);
}

bool Simulation::Impl::minimize(double h) {
  std::fill(is_active.begin(), is_active.end(), true);
  contacts.find_candidates(x.site, x.site);
  for (int iteration = 0; iteration < solver().max_newton; ++iteration) {
    const std::vector<double> largest_move = find_direction();
    move(std::vector<double>(is_active.size(), 1.0));
    contacts.find_candidates(x.site, trial.site);
    const std::vector<double> certified = contacts.largest_step(x.site, trial.site);
    line_search(certified);
    for (std::size_t w = 0; w < is_active.size(); ++w) {
      if (!is_active[w]) continue;
      reports[w].residual = largest_move[w] / h;
      if (!std::isfinite(largest_move[w]))
        throw StepFailure("a position of scene " + system.scenes[w].name + " is not finite");
      if (reports[w].residual <= system.scenes[w].solver.velocity_tolerance) is_active[w] = false;
    }
    if (std::none_of(is_active.begin(), is_active.end(), [](char a) { return a; })) return iteration == 0;
  }
  for (std::size_t w = 0; w < is_active.size(); ++w)
    if (is_active[w])
      throw StepFailure("Newton's method did not converge within " + std::to_string(solver().max_newton) +
                        " iterations in scene " + system.scenes[w].name + ": the last correction moved a point at " +
                        std::to_string(reports[w].residual) + " m/s");
  return false;
}

void Simulation::Impl::advance(double h, const std::vector<std::vector<double>>& previous,
                               const std::vector<std::vector<double>>& targets) {
  start.node.copy_from(x.node);
  potential.update_sites(start);
  const double inertia_h = integrator.predict(start.node, h, solver().integrator, predicted.node);
  potential.update_sites(predicted);
  potential.begin_step(start, predicted, h, inertia_h);
  set_drives(previous, targets);
  try {
    const int wanted = system.scenes[0].contact.friction_lag_passes;
    for (int pass = 0; pass < (wanted < 0 ? MAX_LAG_PASSES : std::max(1, wanted)); ++pass) {
      contacts.find_candidates(x.site, x.site);
      contacts.find_contacts(x.site);
      contacts.lag_friction(x.site);
      potential.set_friction(contacts.friction());
      if (pass == 0) move_to_first_guess(h);
      const bool was_there = minimize(h);
      if (wanted < 0 && pass > 0 && was_there) break;
    }
  } catch (const StepFailure&) {
    x.node.copy_from(start.node);
    potential.update_sites(x);
    throw;
  }
  integrator.accept(start.node, x.node);
  read_state(h);
}

void Simulation::Impl::advance_or_halve(double h, const std::vector<std::vector<double>>& previous,
                                        const std::vector<std::vector<double>>& targets, int halvings_left) {
  try {
    advance(h, previous, targets);
  } catch (const StepFailure& failure) {
    if (halvings_left == 0)
      throw StepFailure(std::string(failure.what()) + ", at " + std::to_string(states[0].time) + " s");
    for (StepReport& report : reports) ++report.retries;
    std::vector<std::vector<double>> middle = targets;
    for (std::size_t w = 0; w < middle.size(); ++w)
      for (std::size_t j = 0; j < middle[w].size(); ++j) middle[w][j] = 0.5 * (previous[w][j] + targets[w][j]);
    advance_or_halve(h / 2, previous, middle, halvings_left - 1);
    advance_or_halve(h / 2, middle, targets, halvings_left - 1);
  }
}

void Simulation::Impl::read_joints(double h) {
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    WorldState& state = states[w];
    for (std::size_t j = 0; j < system.scenes[w].joints.size(); ++j) {
      const Joint& joint = system.scenes[w].joints[j];
      double q = joint_coordinate(joint, state.rigid[joint.parent], state.rigid[joint.child]);
      if (joint.type == Joint::Type::revolute) q = unwrap_angle(q, state.joint_position[j]);
      if (h > 0 && (joint.drive.stiffness > 0 || joint.drive.damping > 0))
        state.joint_effort[j] = drive_effort(joint.drive, state.joint_position[j], q, target[w][j], target_change[w][j],
                                             feed_forward[w][j], h);
      state.joint_position[j] = q;
    }
  }
}

void Simulation::Impl::read_state(double h) {
  const std::vector<double> nodes = x.node.read();
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    WorldState& state = states[w];
    const Scene& scene = system.scenes[w];
    state.time += h;
    state.rigid.resize(scene.rigid_bodies.size());
    for (std::size_t b = 0; b < state.rigid.size(); ++b) {
      const double* node = &nodes[3 * system.rigid_first_node[w][b]];
      for (int k = 0; k < 4; ++k) state.rigid[b].col((k + 3) % 4) = Eigen::Map<const Vec3>(node + 3 * k);
    }
    state.soft.resize(scene.soft_bodies.size());
    for (std::size_t b = 0; b < state.soft.size(); ++b) {
      state.soft[b].resize(scene.soft_bodies[b].mesh.points.size());
      for (std::size_t i = 0; i < state.soft[b].size(); ++i)
        state.soft[b][i] = Eigen::Map<const Vec3>(&nodes[3 * (system.soft_first_node[w][b] + i)]);
    }
    state.cloth.resize(scene.cloths.size());
    for (std::size_t b = 0; b < state.cloth.size(); ++b) {
      state.cloth[b].resize(scene.cloths[b].mesh.points.size());
      for (std::size_t i = 0; i < state.cloth[b].size(); ++i)
        state.cloth[b][i] = Eigen::Map<const Vec3>(&nodes[3 * (system.cloth_first_node[w][b] + i)]);
    }
  }
  read_joints(h);
  if (h == 0) return;
  contacts.find_contacts(x.site);
  std::vector<std::vector<ContactForce>> forces = contacts.forces(x.site, start.site, h);
  const std::vector<double> gap = contacts.min_gap(x.site);
  u32 first_body = 0;
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    for (ContactForce& force : forces[w]) {
      force.first -= int(first_body);
      force.second -= int(first_body);
    }
    states[w].contacts = std::move(forces[w]);
    reports[w].contacts = int(states[w].contacts.size());
    reports[w].min_gap = gap[w];
    first_body += u32(n_bodies(system.scenes[w]));
  }
}

Simulation::Simulation(Device& device, std::span<const Scene> worlds) {
  if (worlds.empty()) throw UsageError("a simulation needs at least one scene");
  impl_ = std::make_unique<Impl>(device, worlds);
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

std::vector<StepReport> Simulation::step(std::span<const std::vector<double>> targets) {
  Impl& impl = *impl_;
  if (targets.size() != n_worlds())
    throw UsageError("step was given targets for " + std::to_string(targets.size()) + " worlds, there are " +
                     std::to_string(n_worlds()));
  for (std::size_t w = 0; w < n_worlds(); ++w)
    if (targets[w].size() != impl.last_targets[w].size())
      throw UsageError("scene " + impl.system.scenes[w].name + " has " + std::to_string(impl.last_targets[w].size()) +
                       " driven joints, was given " + std::to_string(targets[w].size()) + " targets");
  impl.is_active.assign(n_worlds(), true);
  impl.reports.assign(n_worlds(), StepReport{});
  const std::vector<std::vector<double>> wanted(targets.begin(), targets.end());
  impl.advance_or_halve(impl.h(), impl.last_targets, wanted, impl.solver().max_step_halvings);
  impl.last_targets = wanted;
  return impl.reports;
}

Checkpoint Simulation::checkpoint() const {
  Checkpoint checkpoint{impl_->x.node.read(), impl_->integrator.history(), {}, {}, impl_->last_targets};
  for (const WorldState& state : impl_->states) {
    checkpoint.time.push_back(state.time);
    checkpoint.joint_position.push_back(state.joint_position);
  }
  return checkpoint;
}

void Simulation::restore(const Checkpoint& checkpoint) {
  Impl& impl = *impl_;
  bool fits = checkpoint.position.size() == impl.x.node.size() && checkpoint.time.size() == n_worlds();
  for (std::size_t w = 0; fits && w < n_worlds(); ++w)
    fits = checkpoint.joint_position[w].size() == impl.system.scenes[w].joints.size() &&
           checkpoint.targets[w].size() == impl.last_targets[w].size();
  if (!fits) throw UsageError("the checkpoint was made from another scene; resume with the scene that it came from");
  impl.x.node.write(checkpoint.position);
  impl.potential.update_sites(impl.x);
  impl.integrator.restore(checkpoint.history);
  impl.last_targets = checkpoint.targets;
  for (std::size_t w = 0; w < n_worlds(); ++w) {
    impl.states[w].time = checkpoint.time[w];
    impl.states[w].joint_position = checkpoint.joint_position[w];
    impl.states[w].contacts.clear();
  }
  impl.read_state(0);
}

std::size_t Simulation::n_worlds() const { return impl_->system.n_worlds(); }
const WorldState& Simulation::state(std::size_t world) const { return impl_->states[world]; }

}  // namespace pvg
