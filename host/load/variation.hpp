// What differs from episode to episode besides the poses: factors and shifts, drawn evenly for each episode.
//
//   vary:
//     - {quantity: size, of: beaker, factor: [0.98, 1.02]}        also mass, friction, stiffness, color, light,
//     exposure
//     - {quantity: camera_position, of: front, by: [-10 mm, 10 mm]}          and camera_rotation [rad], about each axis
#pragma once
#include <functional>
#include <string>

#include "host/model/task.hpp"

namespace pvg {

// A number in the range, which is on record under the name.
using DrawNumber = std::function<double(const std::string& name, const Range& range)>;

// The task with what `vary` asks for drawn.
Task varied(Task task, const DrawNumber& draw);

}  // namespace pvg
