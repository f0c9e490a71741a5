#include "pipeline/serve/scene_server.hpp"

#include <algorithm>

#include "host/base/error.hpp"
#include "pipeline/serve/requests.hpp"
#include "pipeline/serve/scene_arrays.hpp"
#include "pipeline/serve/shared_memory.hpp"

namespace pvg {
namespace {

constexpr std::uint64_t MOST_STEPS_AT_ONCE = 1000000;  // of one request, which cannot be stopped

struct SceneRequest {
  const char* name;
  std::vector<std::string> keys;  // that it may have besides `do` and `id`
  void (*answer)(ServedScene& scene, const Json& request, Message& message);
};

std::vector<ServedCamera> cameras_of(const ServedScene& scene) {
  std::vector<ServedCamera> cameras;
  for (const Camera& camera : scene.shown().cameras) cameras.push_back({camera.name, camera.width, camera.height});
  return cameras;
}

// before anything is done: a mistake leaves the scene as it is
void check_wish(const ServedScene& scene, const Json& request) {
  check_pictures(cameras_of(scene), scene.renders(), request);
}

void add_time(const ServedScene& scene, Message& message) {
  message.head["time"] = scene.state().time;
  message.head["n_steps"] = scene.n_steps();
}

void observe(ServedScene& scene, const Json& request, Message& message) {
  check_wish(scene, request);
  add_time(scene, message);
  add_pictures(
      cameras_of(scene), request, [&](std::size_t camera) { return scene.picture(camera); }, message);
}

void reset(ServedScene& scene, const Json& request, Message& message) {
  check_wish(scene, request);
  scene.reset();
  observe(scene, request, message);
}

std::size_t steps_asked(const Json& request) {
  if (!request.contains("n")) return 1;
  const Json& n = request["n"];
  if (!n.is_number_integer() || n < 1 || n > MOST_STEPS_AT_ONCE)
    throw UsageError("`n` of a step is a whole number from 1 to " + std::to_string(MOST_STEPS_AT_ONCE) +
                     ", this one is " + n.dump().substr(0, 40));
  return n.get<std::size_t>();
}

void step(ServedScene& scene, const Json& request, Message& message) {
  check_wish(scene, request);
  if (request.contains("n") && request.contains("targets"))
    throw UsageError("a step has `n` or `targets`, which are as many steps as it has rows; leave one out");
  if (request.contains("targets"))
    scene.step(rows_of_targets(request));
  else
    scene.step(steps_asked(request));
  const StepReport& report = scene.report();
  message.head["solver"] = {{"newton", report.newton}, {"contacts", report.contacts}, {"retries", report.retries}};
  observe(scene, request, message);
}

void state(ServedScene& scene, const Json& request, Message& message) {
  add_scene_state(scene, message);
  place_arrays(request, message);
}

void contacts(ServedScene& scene, const Json& request, Message& message) {
  add_scene_contacts(scene, message);
  place_arrays(request, message);
}

void forces(ServedScene& scene, const Json& request, Message& message) {
  add_scene_forces(scene, message);
  place_arrays(request, message);
}

void find_intersection(ServedScene& scene, const Json&, Message& message) {
  message.head["bodies"] = scene.intersection();
}

void end(ServedScene&, const Json&, Message&) {}

const SceneRequest& request_kind(const std::string& wanted) {
  static const std::vector<SceneRequest> KINDS = {
      {"reset", {"pictures", "memory"}, reset},     {"step", {"n", "targets", "pictures", "memory"}, step},
      {"observe", {"pictures", "memory"}, observe}, {"state", {"memory"}, state},
      {"contacts", {"memory"}, contacts},           {"forces", {"memory"}, forces},
      {"intersection", {}, find_intersection},      {"close", {}, end},
  };
  std::string names;
  for (const SceneRequest& kind : KINDS) {
    if (wanted == kind.name) return kind;
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  }
  throw UsageError("`do` of a request about a scene is one of " + names + ", this one is `" + wanted.substr(0, 40) +
                   "`");
}

const char* kind_of(const RigidBody& body) {
  if (body.is_half_space) return "half_space";
  if (body.is_prescribed) return "moving";
  return body.is_fixed ? "static" : "rigid";
}

Json bodies_of(const Scene& scene) {
  Json bodies = Json::array();
  const auto add = [&](const std::string& name, const char* kind, std::size_t n_nodes) {
    bodies.push_back({{"name", name}, {"kind", kind}, {"nodes", n_nodes}});
  };
  for (const RigidBody& body : scene.rigid_bodies) add(body.name, kind_of(body), 0);
  for (const SoftBody& body : scene.soft_bodies) add(body.name, "soft", body.mesh.points.size());
  for (const Cloth& cloth : scene.cloths) add(cloth.name, "cloth", cloth.mesh.points.size());
  return bodies;
}

Json joints_of(const Scene& scene) {
  constexpr const char* TYPES[] = {"fixed", "revolute", "prismatic", "spherical"};
  constexpr const char* MODES[] = {"position", "velocity", "torque"};
  Json joints = Json::array();
  for (const Joint& joint : scene.joints)
    joints.push_back({{"name", joint.name},
                      {"type", TYPES[std::size_t(joint.type)]},
                      {"parent", scene.rigid_bodies[std::size_t(joint.parent)].name},
                      {"child", scene.rigid_bodies[std::size_t(joint.child)].name},
                      {"drive", is_driven(joint) ? Json(MODES[std::size_t(joint.drive.mode)]) : Json(nullptr)}});
  return joints;
}

}  // namespace

Message greeting(const ServedScene& served, const std::string& program) {
  const Scene& scene = served.run().scene;
  Message message;
  message.head = {{"greeting", "phyvisgen serve"},
                  {"protocol", PROTOCOL_VERSION},
                  {"program", program},
                  {"scene", scene.name},
                  {"time_step", scene.solver.time_step},
                  {"duration", served.run().duration},
                  {"gravity", {scene.gravity.x(), scene.gravity.y(), scene.gravity.z()}},
                  {"bodies", bodies_of(scene)},
                  {"joints", joints_of(scene)},
                  {"driven", served.driven()},
                  {"cameras", Json::array()}};
  for (const ServedCamera& camera : cameras_of(served))
    message.head["cameras"].push_back({{"name", camera.name}, {"width", camera.width}, {"height", camera.height}});
  return message;
}

Message answer(ServedScene& scene, const Message& request) {
  const Json& head = request.head;
  Message message;
  try {
    const SceneRequest& kind = request_kind(wish_of(head));
    if (head.contains("world")) throw UsageError("a scene has one world; leave `world` out");
    check_keys(kind.name, kind.keys, head);
    kind.answer(scene, head, message);
    if (head.contains("id")) message.head["id"] = head["id"];
    return message;
  } catch (const MemoryTooSmall& error) {
    message = error_message(error.what(), head);
    message.head["bytes"] = error.needed;
  } catch (const UsageError& error) {
    message = error_message(error.what(), head);
  } catch (const StepFailure& failure) {
    message = error_message(failure.what(), head);
    add_time(scene, message);
  }
  return message;
}

}  // namespace pvg
