// The scene file of the next experiment: where bodies start, and what drives are told.
#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/report/report.hpp"

namespace pvg::diagnose {
namespace {

std::vector<double> numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// roll, pitch, yaw about the fixed axes x, y, z in this order [rad]
std::vector<double> roll_pitch_yaw(const Mat3& rotation) {
  const Vec3 turned = rotation.eulerAngles(2, 1, 0);
  return {turned[2], turned[1], turned[0]};
}

void write_start(YAML::Node& root, const PhysicalScene& before, const PhysicalScene& scene) {
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b) {
    const RigidBody &body = scene.rigid_bodies[b], &was = before.rigid_bodies[b];
    if (!can_move(body)) continue;
    YAML::Node entry = entry_named(root["bodies"], body.name);
    if (!entry.IsDefined() || !entry.IsMap()) continue;
    if (!body.pose.isApprox(was.pose, 1e-12)) {
      entry["pose"]["position"] = numbers(body.pose.translation());
      entry["pose"]["rotation"] = roll_pitch_yaw(body.pose.linear());
    }
    if (body.velocity != was.velocity) entry["velocity"] = numbers(body.velocity);
    if (body.angular_velocity != was.angular_velocity) entry["angular_velocity"] = numbers(body.angular_velocity);
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    YAML::Node entry = entry_named(root["joints"], scene.joints[j].name);
    if (entry.IsDefined() && entry.IsMap() && scene.joints[j].initial != before.joints[j].initial)
      entry["initial"] = scene.joints[j].initial;
  }
}

void write_commands(YAML::Node& root, const PhysicalScene& scene, const PlannedMotion& motion) {
  constexpr const char* MODES[] = {"position", "velocity", "torque"};
  std::size_t driven = 0;
  for (const Joint& joint : scene.joints) {
    if (!is_driven(joint)) continue;
    const TargetTable& table = motion.targets[driven++];
    YAML::Node entry = entry_named(root["joints"], joint.name);
    if (!entry.IsDefined() || !entry.IsMap()) continue;
    entry["drive"]["mode"] = MODES[int(joint.drive.mode)];
    entry["drive"]["target"] = table.value;
    entry["drive"]["target_times"] = table.time;
  }
}

}  // namespace

std::string next_run(const Problem& problem, const PlannedMotion& motion) {
  using nlohmann::json;
  const PhysicalScene& scene = problem.scene.scene;
  json run = {
      {"seconds", motion.seconds}, {"initial", json::object()}, {"commands", json::object()}, {"set", json::object()}};
  for (const int j : problem.coordinates) {
    const std::string joint = "joint/" + scene.joints[std::size_t(j)].name;
    run["initial"][joint + "/position"] = motion.initial.position[std::size_t(j)];
    run["initial"][joint + "/velocity"] = motion.initial.rate[std::size_t(j)];
  }
  for (const int b : problem.free_bodies) {
    const std::string body = "body/" + scene.rigid_bodies[std::size_t(b)].name;
    run["initial"][body + "/position"] = numbers(motion.initial.pose[std::size_t(b)].translation());
    run["initial"][body + "/velocity"] = numbers(motion.initial.velocity[std::size_t(b)]);
    run["initial"][body + "/angular_velocity"] = numbers(motion.initial.spin[std::size_t(b)]);
  }
  std::size_t driven = 0;
  for (const Joint& joint : scene.joints)
    if (is_driven(joint)) {
      const TargetTable& table = motion.targets[driven++];
      run["commands"]["joint/" + joint.name] = {{"time", table.time}, {"value", table.value}};
    }
  if (motion.load > 0) run["set"]["body/" + motion.loaded + "/load"] = motion.load;
  return run.dump();
}

std::string next_scene(const Problem& problem, const Diagnosis& diagnosis, const std::filesystem::path& folder) {
  const PlannedMotion& motion = diagnosis.next_motion.value();
  YAML::Node root = scene_file_in(problem, folder);
  PhysicalScene scene = problem.scene.scene;
  start_at(problem, motion.initial, scene);
  write_start(root, problem.scene.scene, scene);
  write_commands(root, scene, motion);
  if (motion.load > 0) write_effect(root, {"payload_mass", motion.loaded, {motion.load}});
  root["duration"] = motion.seconds;
  YAML::Emitter out;
  out.SetDoublePrecision(17);
  out << root;
  return "# the next experiment: " + diagnosis.next_experiment + "\n" + out.c_str() + "\n";
}

}  // namespace pvg::diagnose
