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
      if (is_driven(joint)) {
        const double weight = joint.drive.compensates_gravity
                                  ? gravity_feed_forward(nominal[w], joint, carried[w][j], states[w], soft_masses[w])
                                  : 0;
        drives[w][j] = drive_over_step(joint.drive, start, targets[w][driven], targets[w][driven] - previous[w][driven],
                                       weight, h);
        ++driven;
      }
      const auto fill = [&](auto& row) {
        row.stiffness = drives[w][j].stiffness;
        row.target = drives[w][j].target;
        row.feed_forward = drives[w][j].feed_forward;
        row.play = drives[w][j].play;
        row.damping = joint.damping + drives[w][j].damping;
        row.target_change = row.damping > 0 ? drives[w][j].change * drives[w][j].damping / row.damping : 0;
      };
      const JointRows& row = system.joint_rows[w][j];
      const bool turns = joint.type == Joint::Type::revolute;
      if (row.drive >= 0 && turns) {
        fill(system.revolute_drive.rows[row.drive]);
        system.revolute_drive.rows[row.drive].angle0 = start;
      }
      if (row.drive >= 0 && !turns) fill(system.prismatic_drive.rows[row.drive]);
      if (row.limit >= 0 && turns) system.revolute_limit.rows[row.limit].angle0 = start;
      for (const int effect : row.effects)
        if (turns) system.revolute_effect.rows[effect].angle0 = start;
      for (const int law : row.laws)
        if (turns) system.revolute_law.rows[law].angle0 = start;
    }
  }
  potential.update_joints(system);
  for (std::size_t i = 0; i < pressing.size(); ++i) {
    const RollingResistance& rolling = system.rolling_resistance[i];
    system.spin.rows[rolling.spin].torque = rolling.arm * pressing[i];
  }
  if (!pressing.empty()) potential.update_spin(system);
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
        state.joint_effort[j] = is_driven(joint) ? drive_effort(drives[w][j], joint.drive.effort_limit, q) : 0;
        state.joint_stop_effort[j] = stop_effort(joint, q);
        state.joint_damping_effort[j] = -joint.damping * (q - state.joint_position[j]) / h;
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
}  // namespace pvg
