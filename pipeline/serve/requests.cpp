#include "pipeline/serve/requests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/dataset/states_file.hpp"
#include "host/load/fields/target_bounds.hpp"
#include "pipeline/serve/shared_memory.hpp"

namespace pvg {
namespace {

// Cameras whose pictures are asked for: all, some by name, or none.
std::vector<std::size_t> cameras_asked(std::span<const ServedCamera> cameras, const Json& request) {
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
      if (std::none_of(cameras.begin(), cameras.end(), [&](const auto& camera) { return camera.name == name; }))
        throw UsageError("`pictures` names `" + name.get<std::string>() + "`, but there is no camera of that name");
  return asked;
}

// Where arrays go instead of into the answer.
std::optional<SharedMemory> memory_asked(const Json& request, std::size_t n_bytes) {
  if (!request.contains("memory")) return std::nullopt;
  if (!request["memory"].is_string()) throw UsageError("`memory` is the path of a file in memory");
  return SharedMemory(request["memory"].get<std::string>(), n_bytes);
}

std::optional<SharedMemory> memory_of_pictures(std::span<const ServedCamera> cameras, const Json& request) {
  std::size_t n_bytes = 0;
  for (const std::size_t camera : cameras_asked(cameras, request))
    n_bytes += 3 * std::size_t(cameras[camera].width) * std::size_t(cameras[camera].height);
  return memory_asked(request, n_bytes);
}

}  // namespace

std::string wish_of(const Json& request) {
  return request.contains("do") && request["do"].is_string() ? request["do"].get<std::string>() : "";
}

void check_keys(const std::string& kind, const std::vector<std::string>& keys, const Json& request) {
  for (const auto& [key, value] : request.items())
    if (key != "do" && key != "id" && key != "world" && std::find(keys.begin(), keys.end(), key) == keys.end())
      throw UsageError("a " + kind + " has no key `" + key.substr(0, 40) + "`");
}

std::vector<double> numbers(const Json& list, const std::string& key) {
  if (!list.is_array() || !std::all_of(list.begin(), list.end(), [](const Json& each) { return each.is_number(); }))
    throw UsageError("`" + key + "` is a list of numbers");
  return list.get<std::vector<double>>();
}

std::vector<std::vector<double>> rows_of_targets(const Json& request) {
  if (!request["targets"].is_array()) throw UsageError("`targets` is a list of rows");
  std::vector<std::vector<double>> rows;
  for (const Json& row : request["targets"]) rows.push_back(numbers(row, "targets"));
  return rows;
}

void check_targets(const PhysicalScene& scene, std::span<const std::vector<double>> rows) {
  const std::vector<std::size_t> driven = driven_joints(scene);
  for (const std::vector<double>& row : rows) {
    if (row.size() != driven.size())
      throw UsageError("a row of `targets` has a number for each of the " + counted(driven.size(), "joint") +
                       " with a drive, this one has " + std::to_string(row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Joint& joint = scene.joints[driven[i]];
      const double largest = largest_target(joint.type, joint.drive.mode);
      if (!std::isfinite(row[i])) throw UsageError("`targets` holds what is not a finite number");
      if (std::abs(row[i]) > largest)
        throw UsageError(
            fmt::format("the target of joint {} is {:g}, it may be {:g} at most", joint.name, row[i], largest));
    }
  }
}

void check_pictures(std::span<const ServedCamera> cameras, bool renders, const Json& request) {
  memory_of_pictures(cameras, request);
  if (!renders && !cameras_asked(cameras, request).empty())
    throw UsageError("this server makes no pictures: it was started with --no-render");
}

void add_pictures(std::span<const ServedCamera> cameras, const Json& request,
                  const std::function<Picture8(std::size_t)>& picture, Message& message) {
  const std::optional<SharedMemory> memory = memory_of_pictures(cameras, request);
  std::size_t offset = 0;
  for (const std::size_t camera : cameras_asked(cameras, request)) {
    const Picture8 made = picture(camera);
    const std::string name = "pictures/" + cameras[camera].name;
    const std::vector<std::size_t> shape = {std::size_t(made.height), std::size_t(made.width), 3};
    if (!memory) {
      add_array(message, name, shape, std::span<const std::uint8_t>(made.rgb));
      continue;
    }
    memory->write(offset, made.rgb);
    message.head["arrays"].push_back({{"name", name}, {"type", "|u1"}, {"shape", shape}, {"memory_offset", offset}});
    offset += made.rgb.size();
  }
}

void place_arrays(const Json& request, Message& message) {
  const std::optional<SharedMemory> memory = memory_asked(request, message.bytes.size());
  if (!memory || !message.head.contains("arrays")) return;
  memory->write(0, message.bytes);
  message.bytes.clear();
  for (Json& array : message.head["arrays"]) {
    array["memory_offset"] = array["offset"];
    array.erase("offset");
  }
}

Message error_message(const std::string& sentence, const Json& request) {
  Message message;
  if (request.contains("id")) message.head["id"] = request["id"];
  message.head["error"] = sentence;
  return message;
}

}  // namespace pvg
