#include "pipeline/serve/server.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/base/names.hpp"
#include "pipeline/serve/shared_memory.hpp"
#include "pipeline/serve/state_arrays.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;

// The keys that each request may have besides `do`; reading one by `at` names what is missing.
struct RequestKind {
  const char* name;
  std::vector<std::string> keys;
  void (*act)(ServedTask& task, const Json& request, Message& answer);
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

void reset(ServedTask& task, const Json& request, Message& message) {
  check_pictures(task, request);
  const std::uint64_t seed = whole(request, "seed"), episode = whole(request, "episode");
  task.reset(seed, episode);
  message.head["sampled"] = Json::object();
  for (const SampledValue& drawn : task.built().sampled) message.head["sampled"][drawn.name] = drawn.value;
  observe(task, request, message);
}

void step(ServedTask& task, const Json& request, Message& message) {
  check_pictures(task, request);
  const int n = int(request.contains("action")) + int(request.contains("targets")) + int(request.contains("plan"));
  if (n != 1) throw UsageError("a step has one of the keys `action`, `targets` and `plan`");
  if (request.contains("action")) {
    task.act(numbers(request["action"], "action"));
  } else if (request.contains("targets")) {
    if (!request["targets"].is_array()) throw UsageError("`targets` is a list of rows");
    std::vector<std::vector<double>> rows;
    for (const Json& row : request["targets"]) rows.push_back(numbers(row, "targets"));
    task.follow(rows);
  } else {
    if (request["plan"] != true) throw UsageError("`plan` is true where it is given");
    message.head["plan_ended"] = !task.follow_plan();
  }
  observe(task, request, message);
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

const std::vector<RequestKind>& request_kinds() {
  static const std::vector<RequestKind> KINDS = {
      {"reset", {"seed", "episode", "pictures", "memory"}, reset},
      {"step", {"action", "targets", "plan", "pictures", "memory"}, step},
      {"observe", {"pictures", "memory"}, observe},
      {"state", {}, state},
      {"measure", {}, measure},
      {"plan", {}, plan},
      {"close", {}, [](ServedTask&, const Json&, Message&) {}},
  };
  return KINDS;
}

const RequestKind& request_kind(const Json& request) {
  std::string names;
  const std::string wanted =
      request.contains("do") && request["do"].is_string() ? request["do"].get<std::string>() : "";
  for (const RequestKind& kind : request_kinds()) {
    if (wanted == kind.name) return kind;
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  }
  throw UsageError("`do` of a request is one of " + names + ", this one is `" + wanted.substr(0, 40) + "`");
}

void check_keys(const RequestKind& kind, const Json& request) {
  for (const auto& [key, value] : request.items())
    if (key != "do" && key != "id" && std::find(kind.keys.begin(), kind.keys.end(), key) == kind.keys.end())
      throw UsageError("a " + std::string(kind.name) + " has no key `" + key.substr(0, 40) + "`");
}

Message error_message(const std::string& sentence, const Json& request) {
  Message message;
  if (request.contains("id")) message.head["id"] = request["id"];
  message.head["error"] = sentence;
  return message;
}

bool closes(const MotionElement& element) { return kind_of(element).grip == GripChange::closes; }

Json or_null(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

}  // namespace

Message greeting(const ServedTask& served, const std::string& program) {
  const Task& task = served.task();
  const ServedFacts& facts = served.facts();
  Message message;
  message.head = {{"greeting", "phyvisgen serve"},
                  {"protocol", PROTOCOL_VERSION},
                  {"program", program},
                  {"task", task.name},
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

Message answer(ServedTask& task, const Message& request) {
  try {
    const RequestKind& kind = request_kind(request.head);
    check_keys(kind, request.head);
    Message message;
    if (request.head.contains("id")) message.head["id"] = request.head["id"];
    kind.act(task, request.head, message);
    return message;
  } catch (const UsageError& error) {
    return error_message(error.what(), request.head);
  }
}

void serve_stream(ServedTask& task, const std::string& program, int from, int to) {
  write_message(to, greeting(task, program));
  while (true) {
    std::optional<Message> request;
    try {
      request = read_message(from);
    } catch (const UsageError& error) {
      write_message(to, error_message(error.what(), Json::object()));
      continue;
    }
    if (!request) return;
    write_message(to, answer(task, *request));
    if (request->head.value("do", Json()) == "close") return;
  }
}

}  // namespace pvg
