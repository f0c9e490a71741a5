#include "pipeline/serve/scene_arrays.hpp"

#include <limits>

#include "host/dataset/states_file.hpp"
#include "host/physics/energies/joint_anchors.hpp"
#include "pipeline/serve/world_arrays.hpp"

namespace pvg {
namespace {

void add_rigid_bodies(const WorldState& state, const SceneVelocity& velocity, Message& message) {
  std::vector<double> poses, velocities;
  for (const AffineMap& pose : state.rigid) put(poses, pose);
  for (const BodyVelocity& of_body : velocity.rigid) {
    put(velocities, of_body.origin);
    put(velocities, of_body.spin);
  }
  add_numbers(message, "T_rigid", {state.rigid.size(), 3, 4}, poses);
  add_numbers(message, "V_rigid", {state.rigid.size(), 6}, velocities);
}

void add_joints(const ServedScene& served, Message& message) {
  const WorldState& state = served.state();
  add_numbers(message, "joint/position", {state.joint_position.size()}, state.joint_position);
  std::vector<double> q, torque;
  for (const std::size_t joint : driven_joints(served.run().scene)) {
    q.push_back(state.joint_position[joint]);
    torque.push_back(state.joint_effort[joint]);
  }
  add_numbers(message, "q", {q.size()}, q);
  add_numbers(message, "a", {q.size()}, served.targets());
  add_numbers(message, "torque", {q.size()}, torque);
}

void add_nodes(const Scene& scene, const char* letter, const std::vector<std::vector<Vec3>>& soft,
               const std::vector<std::vector<Vec3>>& cloth, Message& message) {
  const std::vector<bool> stitched = is_stitched(scene);
  for (std::size_t i = 0; i < soft.size(); ++i)
    add_points(message, letter + std::string(stitched[i] ? "_gripper/" : "_deform/") + scene.soft_bodies[i].name,
               soft[i]);
  for (std::size_t i = 0; i < cloth.size(); ++i)
    add_points(message, letter + std::string("_deform/") + scene.cloths[i].name, cloth[i]);
}

}  // namespace

void add_scene_state(const ServedScene& served, Message& message) {
  const WorldState& state = served.state();
  const SceneVelocity velocity = served.velocity();
  message.head["time"] = state.time;
  add_rigid_bodies(state, velocity, message);
  add_joints(served, message);
  if (!state.reading.empty()) add_numbers(message, "reading", {state.reading.size()}, state.reading);
  add_nodes(served.run().scene, "X", state.soft, state.cloth, message);
  add_nodes(served.run().scene, "V", velocity.soft, velocity.cloth, message);
}

void add_scene_contacts(const ServedScene& served, Message& message) {
  const WorldState& state = served.state();
  message.head["time"] = state.time;
  add_contacts(state, message);
  std::vector<std::int64_t> kinds, pairs;
  for (const ContactForce& contact : state.contacts) kinds.push_back(std::int64_t(contact.kind));
  std::vector<double> normals, frictions;
  for (const PairForce& pair : state.pair_force) {
    pairs.insert(pairs.end(), {pair.first, pair.second});
    put(normals, pair.normal);
    put(frictions, pair.friction);
  }
  const std::size_t n = state.pair_force.size();
  add_array(message, "contact/kind", {kinds.size()}, std::span<const std::int64_t>(kinds));
  add_array(message, "pair_force/bodies", {n, 2}, std::span<const std::int64_t>(pairs));
  add_numbers(message, "pair_force/normal", {n, 3}, normals);
  add_numbers(message, "pair_force/friction", {n, 3}, frictions);
}

void add_scene_forces(const ServedScene& served, Message& message) {
  const Scene& scene = served.run().scene;
  const WorldState& state = served.state();
  message.head["time"] = state.time;
  std::vector<double> forces, torques, load_forces, load_torques;
  const std::size_t n_bodies = state.rigid.size() + state.soft.size() + state.cloth.size();
  for (std::size_t i = 0; i < n_bodies; ++i) {
    const BodyForce felt = state.body_force.empty() ? BodyForce() : state.body_force[i];  // none before the first step
    put(forces, felt.force);
    put(torques, felt.torque);
  }
  for (const Joint& joint : scene.joints) {
    // directions and offsets hold a prismatic joint, of which no load is known
    JointLoad load{Vec3::Constant(std::numeric_limits<double>::quiet_NaN()),
                   Vec3::Constant(std::numeric_limits<double>::quiet_NaN())};
    if (joint.type != Joint::Type::prismatic)
      load = joint_load(joint, state.rigid[std::size_t(joint.parent)], state.rigid[std::size_t(joint.child)]);
    put(load_forces, load.force);
    put(load_torques, load.torque);
  }
  const std::size_t n_joints = scene.joints.size();
  add_numbers(message, "force/net", {n_bodies, 3}, forces);
  add_numbers(message, "force/torque", {n_bodies, 3}, torques);
  add_numbers(message, "joint/drive", {n_joints}, state.joint_effort);
  add_numbers(message, "joint/stop", {n_joints}, state.joint_stop_effort);
  add_numbers(message, "joint/damping", {n_joints}, state.joint_damping_effort);
  add_numbers(message, "joint/load_force", {n_joints, 3}, load_forces);
  add_numbers(message, "joint/load_torque", {n_joints, 3}, load_torques);
}

}  // namespace pvg
