#include "pipeline/serve/state_arrays.hpp"

#include <algorithm>

#include "host/dataset/states_file.hpp"

namespace pvg {
namespace {

using Numbers = std::vector<double>;

void put(Numbers& numbers, const Vec3& v) { numbers.insert(numbers.end(), v.data(), v.data() + 3); }

void put(Numbers& numbers, const AffineMap& map) {
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 4; ++j) numbers.push_back(map(i, j));
}

void add(Message& message, const std::string& name, const std::vector<std::size_t>& shape, const Numbers& numbers) {
  add_array(message, name, shape, std::span<const double>(numbers));
}

void add_points(Message& message, const std::string& name, const std::vector<Vec3>& points) {
  Numbers numbers;
  for (const Vec3& point : points) put(numbers, point);
  add(message, name, {points.size(), 3}, numbers);
}

void add_joints(const ServedTask& task, Message& message) {
  const WorldState& state = task.state();
  Numbers q, torque;
  for (const std::size_t joint : driven_joints(task.built().scene)) {
    q.push_back(state.joint_position[joint]);
    torque.push_back(state.joint_effort[joint]);
  }
  add(message, "q", {q.size()}, q);
  add(message, "a", {q.size()}, task.targets());
  add(message, "torque", {q.size()}, torque);
}

void add_bodies(const ServedTask& task, Message& message) {
  const Scene& scene = task.built().scene;
  const WorldState& state = task.state();
  const std::vector<std::string>& objects = task.facts().objects;
  Numbers links, rigids;
  for (const char* names : {"links", "rigids", "bodies"}) message.head[names] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < scene.rigid_bodies.size(); ++i) {
    const std::string& name = scene.rigid_bodies[i].name;
    const bool is_object = std::find(objects.begin(), objects.end(), name) != objects.end();
    put(is_object ? rigids : links, state.rigid[i]);
    message.head[is_object ? "rigids" : "links"].push_back(name);
    message.head["bodies"].push_back(name);
  }
  add(message, "T_link", {links.size() / 12, 3, 4}, links);
  add(message, "T_rigid", {rigids.size() / 12, 3, 4}, rigids);
  const std::vector<bool> stitched = is_stitched(scene);
  for (std::size_t i = 0; i < scene.soft_bodies.size(); ++i) {
    const std::string& name = scene.soft_bodies[i].name;
    add_points(message, (stitched[i] ? "X_gripper/" : "X_deform/") + name, state.soft[i]);
    message.head["bodies"].push_back(name);
  }
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    add_points(message, "X_deform/" + scene.cloths[i].name, state.cloth[i]);
    message.head["bodies"].push_back(scene.cloths[i].name);
  }
}

void add_contacts(const WorldState& state, Message& message) {
  const std::size_t n = state.contacts.size();
  Numbers points, normals, frictions, gaps, normal_forces;
  std::vector<std::int64_t> bodies;
  for (const ContactForce& contact : state.contacts) {
    put(points, contact.point);
    put(normals, contact.normal);
    put(frictions, contact.friction_force);
    gaps.push_back(contact.gap);
    normal_forces.push_back(contact.normal_force);
    bodies.insert(bodies.end(), {contact.first, contact.second});
  }
  add(message, "contact/points", {n, 3}, points);
  add(message, "contact/normal", {n, 3}, normals);
  add(message, "contact/friction_force", {n, 3}, frictions);
  add(message, "contact/gap", {n}, gaps);
  add(message, "contact/normal_force", {n}, normal_forces);
  add_array(message, "contact/bodies", {n, 2}, std::span<const std::int64_t>(bodies));
}

}  // namespace

void add_state_arrays(const ServedTask& task, Message& message) {
  message.head["time"] = task.state().time;
  add_joints(task, message);
  add_bodies(task, message);
  add_contacts(task.state(), message);
  if (!task.state().reading.empty()) add(message, "reading", {task.state().reading.size()}, task.state().reading);
}

}  // namespace pvg
