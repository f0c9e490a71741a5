#include "pipeline/serve/state_arrays.hpp"

#include <algorithm>

#include "host/dataset/states_file.hpp"
#include "pipeline/serve/world_arrays.hpp"

namespace pvg {
namespace {

using Numbers = std::vector<double>;

void add_joints(const ServedTask& task, Message& message) {
  const WorldState& state = task.state();
  Numbers q, torque;
  for (const std::size_t joint : driven_joints(task.built().scene)) {
    q.push_back(state.joint_position[joint]);
    torque.push_back(state.joint_effort[joint]);
  }
  add_numbers(message, "q", {q.size()}, q);
  add_numbers(message, "a", {q.size()}, task.targets());
  add_numbers(message, "torque", {q.size()}, torque);
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
  add_numbers(message, "T_link", {links.size() / 12, 3, 4}, links);
  add_numbers(message, "T_rigid", {rigids.size() / 12, 3, 4}, rigids);
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

}  // namespace

void add_state_arrays(const ServedTask& task, Message& message) {
  message.head["time"] = task.state().time;
  add_joints(task, message);
  add_bodies(task, message);
  add_contacts(task.state(), message);
  if (!task.state().reading.empty())
    add_numbers(message, "reading", {task.state().reading.size()}, task.state().reading);
}

}  // namespace pvg
