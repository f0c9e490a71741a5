#include <algorithm>

#include "host/model/display.hpp"
#include "host/physics/energies/body_forces.hpp"
#include "host/physics/step/simulation_impl.hpp"

namespace pvg {

// What drives and stops need to know of this step, which begins at states[w].
void Simulation::Impl::set_joints(double h, const std::vector<std::vector<double>>& previous,
                                  const std::vector<std::vector<double>>& targets) {
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    const PhysicalScene& scene = system.scenes[w];
    std::size_t driven = 0;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      const double start = states[w].joint_position[j];
      const double lead = rate_lead(joint_motion[w][j], start, inertia_length != h), of_rate = inertia_length / h;
      if (is_driven(joint)) {
        const double weight = joint.drive.compensates_gravity
                                  ? gravity_feed_forward(nominal[w], joint, carried[w][j], states[w], soft_masses[w])
                                  : 0;
        drives[w][j] = drive_over_step(joint.drive, start + lead, targets[w][driven],
                                       of_rate * (targets[w][driven] - previous[w][driven]), weight, inertia_length);
        target_change[w][j] = joint.drive.mode == Drive::Mode::position ? targets[w][driven] - previous[w][driven] : 0;
        ++driven;
      }
      const double foreseen = foreseen_change(joint_motion[w][j], start, inertia_length != h, inertia_length);
      const auto fill = [&](auto& row) {
        row.stiffness = drives[w][j].stiffness;
        row.target = drives[w][j].target;
        row.feed_forward = drives[w][j].feed_forward;
        row.play = drives[w][j].play;
        row.cut_damping = drives[w][j].damping / of_rate;
        row.cut_change = lead + drives[w][j].change;
        const StepMotion motion =
            with_armature({joint.damping / of_rate, lead}, joint.armature, foreseen, h, inertia_length);
        row.damping = motion.damping;
        row.target_change = motion.change;
      };
      const JointRows& row = system.joint_rows[w][j];
      const bool turns = joint.type == Joint::Type::revolute;
      if (row.drive >= 0 && turns) {
        fill(system.revolute_drive.rows[row.drive]);
        system.revolute_drive.rows[row.drive].angle0 = start;
      }
      if (row.drive >= 0 && !turns) fill(system.prismatic_drive.rows[row.drive]);
      if (row.limit >= 0 && turns) system.revolute_limit.rows[row.limit].angle0 = start;
      const auto set_rate = [&](auto& of_effect) {
        of_effect.lead = lead;
        of_effect.rate_length = inertia_length;
      };
      for (const int effect : row.effects) {
        if (turns) system.revolute_effect.rows[effect].angle0 = start;
        turns ? set_rate(system.revolute_effect.rows[effect]) : set_rate(system.prismatic_effect.rows[effect]);
      }
      for (const int law : row.laws) {
        if (turns) system.revolute_law.rows[law].angle0 = start;
        turns ? set_rate(system.revolute_law.rows[law]) : set_rate(system.prismatic_law.rows[law]);
      }
    }
  }
  potential.update_joints(system);
  for (std::size_t i = 0; i < pressing.size(); ++i) {
    const RollingResistance& rolling = system.rolling_resistance[i];
    system.spin.rows[rolling.spin].torque = rolling.arm * pressing[i];
  }
  if (!pressing.empty()) potential.update_spin(system);
}

// A push acts by its mean over a time of length h, so that its impulse is exact: that of the step, or about the end of
// a step of BDF2, whose forces are those of that time. A torque T is the forces T x a_k / 2 on the axes a_k, where
// these are at the start of the step: a_k x (T x a_k) sums to 2 T.
void Simulation::Impl::push(double h, bool goes_on) {
  if (system.pushes.empty()) return;
  const bool is_bdf2 = goes_on && solver().integrator == SolverSettings::Integrator::bdf2;
  std::vector<PointForce>& rows = system.point_force.rows;
  for (const Push& push : system.pushes)
    for (u32 k = 0; k < 4; ++k) std::fill_n(rows[push.row + k].force, 3, 0.0);
  for (const Push& push : system.pushes) {
    const double begin = states[push.world].time + (is_bdf2 ? h / 2 : 0);
    const double share = (std::min(push.to, begin + h) - std::max(push.from, begin)) / h;
    if (!(share > 0)) continue;
    const AffineMap& pose = states[push.world].rigid[std::size_t(push.rigid)];
    Eigen::Map<Vec3>(rows[push.row].force) += share * push.force;
    for (Eigen::Index k = 0; k < 3; ++k)
      Eigen::Map<Vec3>(rows[push.row + 1 + u32(k)].force) += share / 2 * push.torque.cross(Vec3(pose.col(k)));
  }
  potential.update_forces(system);
}

// The normal forces that rolling resistance goes by in the next step.
void Simulation::Impl::read_pressing() {
  for (std::size_t i = 0; i < pressing.size(); ++i) {
    const RollingResistance& rolling = system.rolling_resistance[i];
    if (!is_intact[rolling.world]) continue;
    pressing[i] = 0;
    for (const PairForce& pair : states[rolling.world].pair_force)
      if (std::minmax(pair.first, pair.second) == std::minmax(rolling.first, rolling.second))
        pressing[i] = pair.normal.norm();
  }
}

void Simulation::Impl::read_displays(std::size_t w, double h) {
  const PhysicalScene& scene = nominal[w];
  for (std::size_t i = 0; i < scene.displays.size(); ++i) {
    double& reading = states[w].reading[i];
    reading = settled(scene.displays[i], reading, load_on(scene.displays[i], scene, states[w]), h);
  }
}

void Simulation::Impl::read_joints(double h) {
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    if (!is_intact[w]) continue;
    WorldState& state = states[w];
    for (std::size_t j = 0; j < system.scenes[w].joints.size(); ++j) {
      const Joint& joint = system.scenes[w].joints[j];
      double q = joint_coordinate(joint, state.rigid[joint.parent], state.rigid[joint.child]);
      if (joint.type == Joint::Type::revolute) q = unwrap_angle(q, state.joint_position[j]);
      if (h > 0) {
        const double start = state.joint_position[j];
        const double rate = (q - start - rate_lead(joint_motion[w][j], start, inertia_length != h)) / inertia_length;
        state.joint_effort[j] =
            is_driven(joint) ? drive_effort(drives[w][j], joint.drive.effort_limit, q, rate, inertia_length) : 0;
        state.joint_stop_effort[j] = stop_effort(joint, q);
        state.joint_damping_effort[j] = -joint.damping * rate;
        joint_motion[w][j] = after_step(joint_motion[w][j], start, q, inertia_length != h, inertia_length);
        joint_motion[w][j].target_change = target_change[w][j];
      }
      state.joint_position[j] = q;
    }
  }
}

void Simulation::Impl::read_state(double h) {
  const DeviceCounts before = device.counts();
  const std::vector<double> positions = knows_motion ? nodes : x.node.read();
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    if (!is_intact[w]) continue;
    WorldState& state = states[w];
    const PhysicalScene& scene = system.scenes[w];
    state.time += h;
    state.rigid.resize(scene.rigid_bodies.size());
    for (std::size_t b = 0; b < state.rigid.size(); ++b) {
      const double* node = &positions[3 * system.rigid_first_node[w][b]];
      for (int k = 0; k < 4; ++k) state.rigid[b].col((k + 3) % 4) = Eigen::Map<const Vec3>(node + 3 * k);
    }
    state.soft.resize(scene.soft_bodies.size());
    for (std::size_t b = 0; b < state.soft.size(); ++b) {
      state.soft[b].resize(scene.soft_bodies[b].mesh.points.size());
      for (std::size_t i = 0; i < state.soft[b].size(); ++i)
        state.soft[b][i] = Eigen::Map<const Vec3>(&positions[3 * (system.soft_first_node[w][b] + i)]);
    }
    state.cloth.resize(scene.cloths.size());
    for (std::size_t b = 0; b < state.cloth.size(); ++b) {
      state.cloth[b].resize(scene.cloths[b].mesh.points.size());
      for (std::size_t i = 0; i < state.cloth[b].size(); ++i)
        state.cloth[b][i] = Eigen::Map<const Vec3>(&positions[3 * (system.cloth_first_node[w][b] + i)]);
    }
  }
  read_joints(h);
  if (h > 0) read_contacts(h);
  counts.recording += device.counts() - before;
}

void Simulation::Impl::read_contacts(double h) {
  contacts.find_contacts(x.site);
  std::vector<std::vector<ContactForce>> forces = contacts.forces(x.site, start.site, h);
  contacts.start_lag_friction(x.site);  // of the next step
  const std::vector<double> gap = contacts.min_gap(x.site);
  u32 first_body = 0;
  for (std::size_t w = 0; w < system.n_worlds(); first_body += u32(n_bodies(system.scenes[w])), ++w) {
    if (!is_intact[w]) continue;
    for (ContactForce& force : forces[w]) {
      force.first -= int(first_body);
      force.second -= int(first_body);
    }
    states[w].contacts = std::move(forces[w]);
    sum_forces(system.scenes[w], states[w]);
    read_displays(w, h);
    reports[w].contacts = int(states[w].contacts.size());
    reports[w].min_gap = gap[w];
  }
  read_pressing();
}

namespace {

Mat3 axes_rate(const double* velocity) {
  Mat3 rate;
  for (int k = 0; k < 3; ++k) rate.col(k) = Eigen::Map<const Vec3>(velocity + 3 * (k + 1));
  return rate;
}

// Velocity of the origin and spin of an affine body whose nodes (p, a1, a2, a3) move like this [12, m/s].
BodyVelocity velocity_of(const AffineMap& map, const double* velocity) {
  const Mat3 turning = axes_rate(velocity) * map.leftCols<3>().inverse();
  const Vec3 spin(turning(2, 1) - turning(1, 2), turning(0, 2) - turning(2, 0), turning(1, 0) - turning(0, 1));
  return {Eigen::Map<const Vec3>(velocity), 0.5 * spin};
}

// the same of its centre of mass
Twist twist_of(const RigidBody& body, const AffineMap& map, const double* velocity) {
  const BodyVelocity moves = velocity_of(map, velocity);
  return {moves.origin + axes_rate(velocity) * body.center_of_mass, moves.spin};
}

// Adds a rigid change of motion to the velocities of the nodes.
void add_twist(const AffineMap& map, const Vec3& center, const Twist& change, double* velocity) {
  Eigen::Map<Vec3>(velocity) += change.velocity + change.spin.cross(map.col(3) - center);
  for (int k = 0; k < 3; ++k) Eigen::Map<Vec3>(velocity + 3 * (k + 1)) += change.spin.cross(map.col(k));
}

}  // namespace

void Simulation::Impl::restitute() {
  for (std::size_t w = 0; w < system.n_worlds(); ++w) {
    if (!is_intact[w]) continue;
    const PhysicalScene& scene = system.scenes[w];
    std::vector<Meeting> meetings;
    for (const ContactForce& c : states[w].contacts)
      for (const RestitutionPair& pair : restitution[w])
        if (std::minmax(c.first, c.second) == std::minmax(pair.first, pair.second) && c.normal_force > 0)
          meetings.push_back(
              {c.first, c.second, c.point, c.normal, c.normal_force * length, pair.coefficient, pair.friction});
    if (meetings.empty()) continue;
    const std::size_t n_bodies = scene.rigid_bodies.size(), first = system.rigid_first_node[w][0];
    std::vector<double> now = integrator.velocity().read(3 * first, 12 * n_bodies);
    const std::vector<double> before = integrator.velocity_before().read(3 * first, 12 * n_bodies);
    const std::vector<double> from = start.node.read(3 * first, 12 * n_bodies);
    std::vector<MovingBody> bodies(n_bodies);
    for (std::size_t b = 0; b < n_bodies; ++b) {
      const RigidBody& body = scene.rigid_bodies[b];
      const AffineMap& map = states[w].rigid[b];
      const Mat3 turn = map.leftCols<3>();
      const Vec3 center = turn * body.center_of_mass + map.col(3);
      const bool moves = !body.is_fixed && !body.is_prescribed;
      bodies[b] = {center,
                   moves ? body.mass : 0,
                   turn * body.inertia * turn.transpose(),
                   twist_of(body, map, &before[12 * b]),
                   twist_of(body, map, &now[12 * b]),
                   Vec3::Zero()};
      Vec3 was = Eigen::Map<const Vec3>(&from[12 * b]);
      for (int k = 0; k < 3; ++k) was += body.center_of_mass[k] * Eigen::Map<const Vec3>(&from[12 * b + 3 * (k + 1)]);
      bodies[b].path = center - was;
    }
    const auto changed = restituted(bodies, meetings, scene.gravity, length);
    if (!changed) continue;
    for (std::size_t b = 0; b < n_bodies; ++b) {
      const Twist &to = (*changed)[b], &was = bodies[b].after;
      add_twist(states[w].rigid[b], bodies[b].center, {to.velocity - was.velocity, to.spin - was.spin}, &now[12 * b]);
    }
    integrator.change_velocity(w, first, now, scene.solver.integrator);
    knows_motion = false;
  }
}

SceneVelocity Simulation::velocity(std::size_t world) const {
  const System& system = impl_->system;
  const PhysicalScene& scene = system.scenes.at(world);
  const std::vector<double> of_nodes = impl_->integrator.velocity().read();
  const auto points = [&](std::size_t first, std::size_t n) {
    std::vector<Vec3> points(n);
    for (std::size_t i = 0; i < n; ++i) points[i] = Eigen::Map<const Vec3>(&of_nodes[3 * (first + i)]);
    return points;
  };
  SceneVelocity velocity;
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    velocity.rigid.push_back(
        velocity_of(impl_->states[world].rigid[b], &of_nodes[3 * system.rigid_first_node[world][b]]));
  for (std::size_t b = 0; b < scene.soft_bodies.size(); ++b)
    velocity.soft.push_back(points(system.soft_first_node[world][b], scene.soft_bodies[b].mesh.points.size()));
  for (std::size_t b = 0; b < scene.cloths.size(); ++b)
    velocity.cloth.push_back(points(system.cloth_first_node[world][b], scene.cloths[b].mesh.points.size()));
  return velocity;
}

}  // namespace pvg
