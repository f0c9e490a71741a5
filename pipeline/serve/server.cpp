#include "pipeline/serve/server.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/error.hpp"
#include "host/base/names.hpp"
#include "pipeline/serve/shared_memory.hpp"
#include "pipeline/serve/state_arrays.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;

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

std::vector<double> numbers(const Json& list, const std::string& key) {
  if (!list.is_array() || !std::all_of(list.begin(), list.end(), [](const Json& each) { return each.is_number(); }))
    throw UsageError("`" + key + "` is a list of numbers");
  return list.get<std::vector<double>>();
}

// Cameras whose pictures are asked for: all, some by name, or none.
std::vector<std::size_t> cameras_asked(const ServedTask& task, const Json& request) {
  const std::vector<CameraSection>& cameras = task.task().cameras;
  std::vector<std::size_t> asked;
  if (!request.contains("pictures")) return asked;
  const Json& wish = request["pictures"];
  const auto is_text = [](const Json& each) { return each.is_string(); };
  if (!wish.is_boolean() && !(wish.is_array() && std::all_of(wish.begin(), wish.end(), is_text)))
    throw UsageError("`pictures` is true, false or a list of names of cameras");
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (wish.is_boolean() ? wish.get<bool>() : std::find(wish.begin(), wish.end(), cameras[i].name) != wish.end())
      asked.push_back(i);
  if (wish.is_array())
    for (const Json& name : wish)
      if (!find_named(cameras, name.get<std::string>()))
        throw UsageError("`pictures` names `" + name.get<std::string>() + "`, but the task has no camera of that name");
  return asked;
}

// Where pictures go instead of into the answer.
std::optional<SharedMemory> memory_asked(const ServedTask& task, const Json& request) {
  if (!request.contains("memory")) return std::nullopt;
  if (!request["memory"].is_string()) throw UsageError("`memory` is the path of a file in memory");
  std::size_t n_bytes = 0;
  for (const std::size_t camera : cameras_asked(task, request)) {
    const CameraSection& section = task.task().cameras[camera];
    n_bytes += 3 * std::size_t(section.width) * std::size_t(section.height);
  }
  return SharedMemory(request["memory"].get<std::string>(), n_bytes);
}

// before anything is done: a mistake leaves the episode as it is
void check_pictures(const ServedTask& task, const Json& request) {
  cameras_asked(task, request);
  memory_asked(task, request);
}

void add_pictures(ServedTask& task, const Json& request, Message& message) {
  const std::optional<SharedMemory> memory = memory_asked(task, request);
  std::size_t offset = 0;
  for (const std::size_t camera : cameras_asked(task, request)) {
    const Picture8 picture = task.picture(camera);
    const std::string name = "pictures/" + task.task().cameras[camera].name;
    const std::vector<std::size_t> shape = {std::size_t(picture.height), std::size_t(picture.width), 3};
    if (!memory) {
      add_array(message, name, shape, std::span<const std::uint8_t>(picture.rgb));
      continue;
    }
    memory->write(offset, picture.rgb);
    message.head["arrays"].push_back({{"name", name}, {"type", "|u1"}, {"shape", shape}, {"memory_offset", offset}});
    offset += picture.rgb.size();
  }
}

void observe(ServedTask& task, const Json& request, Message& message) {
  check_pictures(task, request);
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
  add_pictures(task, request, message);
}

void ask_reset(ServedTask& task, const Json& request, Message&) {
  check_pictures(task, request);
  task.ask_reset(whole(request, "seed"), whole(request, "episode"));
}

void tell_reset(ServedTask& task, const Json& request, Message& message) {
  message.head["sampled"] = Json::object();
  for (const SampledValue& drawn : task.built().sampled) message.head["sampled"][drawn.name] = drawn.value;
  observe(task, request, message);
}

void ask_step(ServedTask& task, const Json& request, Message& message) {
  check_pictures(task, request);
  const int n = int(request.contains("action")) + int(request.contains("targets")) + int(request.contains("plan"));
  if (n != 1) throw UsageError("a step has one of the keys `action`, `targets` and `plan`");
  if (request.contains("action")) {
    task.ask_action(numbers(request["action"], "action"));
  } else if (request.contains("targets")) {
    if (!request["targets"].is_array()) throw UsageError("`targets` is a list of rows");
    std::vector<std::vector<double>> rows;
    for (const Json& row : request["targets"]) rows.push_back(numbers(row, "targets"));
    task.ask_targets(std::move(rows));
  } else {
    if (request["plan"] != true) throw UsageError("`plan` is true where it is given");
    message.head["plan_ended"] = !task.ask_plan();
  }
}

void plan(ServedTask& task, const Json&, Message& message) {
  message.head["periods"] = task.n_planned_periods();
  message.head["reason"] = task.reason();
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

std::string wish_of(const Json& request) {
  return request.contains("do") && request["do"].is_string() ? request["do"].get<std::string>() : "";
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

void check_keys(const RequestKind& kind, const Json& request) {
  for (const auto& [key, value] : request.items())
    if (key != "do" && key != "id" && key != "world" &&
        std::find(kind.keys.begin(), kind.keys.end(), key) == kind.keys.end())
      throw UsageError("a " + std::string(kind.name) + " has no key `" + key.substr(0, 40) + "`");
}

Message error_message(const std::string& sentence, const Json& request) {
  Message message;
  if (request.contains("id")) message.head["id"] = request["id"];
  message.head["error"] = sentence;
  return message;
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
      check_keys(*each.kind, *each.request);
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
  write_message(to, greeting(worlds, program));
  while (true) {
    std::optional<Message> request;
    try {
      request = read_message(from);
    } catch (const UsageError& error) {
      write_message(to, error_message(error.what(), Json::object()));
      continue;
    }
    if (!request) return;
    write_message(to, answer(worlds, *request));
    if (request->head.value("do", Json()) == "close") return;
  }
}

}  // namespace pvg
