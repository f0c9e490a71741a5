// What requests about tasks and about scenes have in common: their keys, cameras, pictures, memory.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/model/physical_scene.hpp"
#include "host/pictures/picture.hpp"
#include "pipeline/serve/protocol.hpp"

namespace pvg {

using Json = nlohmann::ordered_json;

// A camera whose pictures can be asked for.
struct ServedCamera {
  std::string name;
  int width = 0, height = 0;  // [pixels]
};

// What `do` of a request says; empty where it is no text.
std::string wish_of(const Json& request);

// A UsageError where a request of this kind has a key that is neither among these nor `do`, `id` or `world`.
void check_keys(const std::string& kind, const std::vector<std::string>& keys, const Json& request);

// The value of a key; a UsageError where it is no list of numbers.
std::vector<double> numbers(const Json& list, const std::string& key);

// `targets` of a request.  [n_steps][n_driven]
std::vector<std::vector<double>> rows_of_targets(const Json& request);

// A UsageError unless each row has a number for each joint with a drive, none larger than a scene file may say.
void check_targets(const PhysicalScene& scene, std::span<const std::vector<double>> rows);

// A UsageError where pictures are asked for that there are not, or `memory` cannot take them. Before anything is done:
// a mistake leaves all as it is.
void check_pictures(std::span<const ServedCamera> cameras, bool renders, const Json& request);

// Adds the pictures that are asked for, made by `picture`, or puts them into the request's memory.
void add_pictures(std::span<const ServedCamera> cameras, const Json& request,
                  const std::function<Picture8(std::size_t)>& picture, Message& message);

// Moves all arrays of a message into the request's memory, where it names one. A MemoryTooSmall where it is.
void place_arrays(const Json& request, Message& message);

// An answer with the request's id and what is wrong.
Message error_message(const std::string& sentence, const Json& request);

}  // namespace pvg
