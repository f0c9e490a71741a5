#include "pipeline/serve/server.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/error.hpp"
#include "pipeline/serve/requests.hpp"
#include "pipeline/serve/state_arrays.hpp"

namespace pvg {
namespace {

// What a request does: `ask` says what is to be simulated, which is then done, of all requests of one `together` in
// one solve; `tell` answers.
struct RequestKind {
  const char* name;
  std::vector<std::string> keys;  // that it may have besides `do`, `id` and `world`
  void (*ask)(ServedTask& task, const Json& request, Message& answer);
  void (*tell)(ServedTask& task, const Json& request, Message& answer);
};

std::uint64_t whole(const Json& request, const std::string& key) {
  if (!request.contains(key)) throw UsageError("a reset needs the key `" + key + "`, a whole number from 0");
  if (!request[key].is_number_unsigned() && !(request[key].is_number_integer() && request[key] >= 0))
    throw UsageError("`" + key + "` is a whole number from 0, this one is " + request[key].dump().substr(0, 40));
  return request[key].get<std::uint64_t>();
}

std::vector<ServedCamera> cameras_of(const ServedTask& task) {
  std::vector<ServedCamera> cameras;
  for (const CameraSection& camera : task.task().cameras) cameras.push_back({camera.name, camera.width, camera.height});
  return cameras;
}

// before anything is done: a mistake leaves the episode as it is
void check_wish(const ServedTask& task, const Json& request) {
  check_pictures(cameras_of(task), task.renders(), request);
}

void observe(ServedTask& task, const Json& request, Message& message) {
  check_wish(task, request);
  const std::optional<std::string> failure = task.failure();
  Json& head = message.head;
  head["time"] = task.state().time;
  head["n_steps"] = task.n_steps();
  head["over"] = task.is_over();
  head["reason"] = task.reason();
  head["success"] = !failure;
  head["failure"] = failure.value_or("");
  head["events"] = Json::array();
  for (const EpisodeEvent& event : task.events())
    head["events"].push_back({{"name", event.name}, {"of", event.of}, {"time", event.time}});
  const std::vector<double> joints = task.joints(), environment = task.environment();
  add_array(message, "agent_pos", {joints.size()}, std::span<const double>(joints));
  add_array(message, "environment_state", {environment.size()}, std::span<const double>(environment));
  add_pictures(
      cameras_of(task), request, [&](std::size_t camera) { return task.picture(camera); }, message);
}

void ask_reset(ServedTask& task, const Json& request, Message&) {
  check_wish(task, request);
  task.ask_reset(whole(request, "seed"), whole(request, "episode"));
}

void tell_reset(ServedTask& task, const Json& request, Message& message) {
  message.head["sampled"] = Json::object();
  for (const SampledValue& drawn : task.built().sampled) message.head["sampled"][drawn.name] = drawn.value;
  observe(task, request, message);
}

void ask_step(ServedTask& task, const Json& request, Message& message) {
  check_wish(task, request);
  const int n = int(request.contains("action")) + int(request.contains("targets")) + int(request.contains("plan"));
  if (n != 1) throw UsageError("a step has one of the keys `action`, `targets` and `plan`");
  if (request.contains("action")) {
    task.ask_action(numbers(request["action"], "action"));
  } else if (request.contains("targets")) {
    task.ask_targets(rows_of_targets(request));
  } else {
    if (request["plan"] != true) throw UsageError("`plan` is true where it is given");
    message.head["plan_ended"] = !task.ask_plan();
  }
}

void plan(ServedTask& task, const Json&, Message& message) {
  message.head["periods"] = task.n_planned_periods();
  message.head["reason"] = task.why_unplanned();
}

void state(ServedTask& task, const Json&, Message& message) { add_state_arrays(task, message); }

void measure(ServedTask& task, const Json&, Message& message) {
  const Measured measured = task.measured();
  Json& head = message.head["measured"] = Json::object();
  for (const Measured::Number& number : measured.numbers)
    head[number.name] = std::isfinite(number.value) ? Json(number.value) : Json(nullptr);
  head["finger_deformation_m"] = measured.finger_deformation;
}

void intersection(ServedTask& task, const Json&, Message& message) { message.head["bodies"] = task.intersection(); }

void nothing(ServedTask&, const Json&, Message&) {}

const std::vector<RequestKind>& request_kinds() {
  static const std::vector<RequestKind> KINDS = {
      {"reset", {"seed", "episode", "pictures", "memory"}, ask_reset, tell_reset},
      {"step", {"action", "targets", "plan", "pictures", "memory"}, ask_step, observe},
      {"observe", {"pictures", "memory"}, nothing, observe},
      {"state", {}, nothing, state},
      {"measure", {}, nothing, measure},
      {"plan", {}, nothing, plan},
      {"intersection", {}, nothing, intersection},
      {"close", {}, nothing, nothing},
  };
  return KINDS;
}

const RequestKind& request_kind(const Json& request) {
  std::string names;
  const std::string wanted = wish_of(request);
  for (const RequestKind& kind : request_kinds()) {
    if (wanted == kind.name) return kind;
    names += std::string(kind.name) + ", ";
  }
  throw UsageError("`do` of a request is one of " + names + "together, this one is `" + wanted.substr(0, 40) + "`");
}

// A request of one world, from when it is read until it is answered.
struct Asked {
  const Json* request;
  std::size_t world = 0;
  const RequestKind* kind = nullptr;
  Message message;
  std::string error;
};

std::size_t world_of(const ServedWorlds& worlds, const Json& request) {
  if (!request.contains("world")) return 0;
  const Json& wish = request["world"];
  if (!wish.is_number_integer() || wish < 0 || wish >= worlds.size())
    throw UsageError("`world` is a whole number from 0 to " + std::to_string(worlds.size() - 1) + ", this one is " +
                     wish.dump().substr(0, 40));
  return wish.get<std::size_t>();
}

// What is wrong with one is its own error; the others are done.
void answer_all(ServedWorlds& worlds, std::vector<Asked>& all) {
  std::vector<char> is_asked(worlds.size());
  std::vector<ServedTask*> tasks;
  std::vector<Asked*> asking;
  const auto try_to = [](Asked& each, const auto& act) {
    try {
      act();
    } catch (const UsageError& error) {
      each.error = error.what();
    }
  };
  for (Asked& each : all)
    try_to(each, [&] {
      each.kind = &request_kind(*each.request);
      check_keys(each.kind->name, each.kind->keys, *each.request);
      each.world = world_of(worlds, *each.request);
      if (std::exchange(is_asked[each.world], true))
        throw UsageError("`together` has two requests of world " + std::to_string(each.world));
      each.kind->ask(worlds[each.world], *each.request, each.message);
      tasks.push_back(&worlds[each.world]);
      asking.push_back(&each);
    });
  const std::vector<std::string> errors = ServedTask::advance_together(tasks);
  for (std::size_t i = 0; i < asking.size(); ++i) {
    Asked& each = *asking[i];
    each.error = errors[i];
    if (each.error.empty()) try_to(each, [&] { each.kind->tell(worlds[each.world], *each.request, each.message); });
  }
  for (Asked& each : all) {
    if (!each.error.empty())
      each.message = error_message(each.error, *each.request);
    else if (each.request->contains("id"))
      each.message.head["id"] = (*each.request)["id"];
  }
}

// Several requests, each of another world; their arrays lie one after the other.
Message answer_together(ServedWorlds& worlds, const Json& request) {
  for (const auto& [key, value] : request.items())
    if (key != "do" && key != "id" && key != "requests")
      throw UsageError("a together has no key `" + key.substr(0, 40) + "`");
  const auto is_object = [](const Json& each) { return each.is_object(); };
  if (!request.contains("requests") || !request["requests"].is_array() ||
      !std::all_of(request["requests"].begin(), request["requests"].end(), is_object))
    throw UsageError("a together needs the key `requests`, a list of requests");
  std::vector<Asked> all;
  for (const Json& each : request["requests"]) {
    if (wish_of(each) == "close") throw UsageError("a close cannot be among the `requests` of a together");
    all.push_back({&each, 0, nullptr, {}, {}});
  }
  answer_all(worlds, all);
  Message message;
  if (request.contains("id")) message.head["id"] = request["id"];
  message.head["answers"] = Json::array();
  for (Asked& each : all) {
    if (each.message.head.contains("arrays"))
      for (Json& array : each.message.head["arrays"])
        if (array.contains("offset")) array["offset"] = array["offset"].get<std::size_t>() + message.bytes.size();
    message.bytes.insert(message.bytes.end(), each.message.bytes.begin(), each.message.bytes.end());
    message.head["answers"].push_back(std::move(each.message.head));
  }
  return message;
}

bool closes(const MotionElement& element) { return kind_of(element).grip == GripChange::closes; }

Json or_null(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

}  // namespace

Message greeting(const ServedWorlds& worlds, const std::string& program) {
  const ServedTask& served = worlds.front();
  const Task& task = served.task();
  const ServedFacts& facts = served.facts();
  Message message;
  message.head = {{"greeting", "phyvisgen serve"},
                  {"protocol", PROTOCOL_VERSION},
                  {"program", program},
                  {"task", task.name},
                  {"worlds", worlds.size()},
                  {"time_step", task.solver.time_step},
                  {"frames_per_second", task.render.frames_per_second},
                  {"steps_per_period", facts.steps_per_period},
                  {"grasps", std::any_of(task.motion.begin(), task.motion.end(), closes)},
                  {"columns", Json::array()},
                  {"driven", facts.driven},
                  {"objects", facts.objects},
                  {"cloths", Json::array()},
                  {"environment", Json::array()},
                  {"cameras", Json::array()}};
  for (const ServedColumn& column : facts.columns)
    message.head["columns"].push_back({{"name", column.packed.name},
                                       {"unit", column.packed.is_width ? "m" : "rad"},
                                       {"joints", column.packed.joints},
                                       {"low", or_null(column.low)},
                                       {"high", or_null(column.high)}});
  for (const ClothKeypoints& cloth : facts.cloths)
    message.head["cloths"].push_back({{"name", cloth.name}, {"keypoints", cloth.vertices}});
  for (const EnvironmentColumn& column : environment_columns(facts.objects, facts.cloths))
    message.head["environment"].push_back(column.name);
  for (const CameraSection& camera : task.cameras)
    message.head["cameras"].push_back({{"name", camera.name}, {"width", camera.width}, {"height", camera.height}});
  return message;
}

Message answer(ServedWorlds& worlds, const Message& request) {
  try {
    if (wish_of(request.head) == "together") return answer_together(worlds, request.head);
  } catch (const UsageError& error) {
    return error_message(error.what(), request.head);
  }
  std::vector<Asked> only = {{&request.head, 0, nullptr, {}, {}}};
  answer_all(worlds, only);
  return std::move(only.front().message);
}

void serve_stream(ServedWorlds& worlds, const std::string& program, int from, int to) {
  serve_stream(
      greeting(worlds, program), [&](const Message& request) { return answer(worlds, request); }, from, to);
}

}  // namespace pvg
