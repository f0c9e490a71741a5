// What differs from episode to episode besides the poses: factors and shifts, drawn evenly for each episode.
//
//   vary:
//     - {quantity: size, of: beaker, factor: [0.98, 1.02]}        also mass, friction, stiffness, color, light,
//     exposure, focal_length
//     - {quantity: camera_position, of: front, by: [-10 mm, 10 mm]}          and camera_rotation [rad], about each axis
//     - {quantity: texture, of: background, files: [a.png, b.png]}           or of a material or the environment
//     - {quantity: presence, of: mug, probability: 0.5}                      an object that is not always there
//     - {quantity: disturbance, of: gripper_base, by: [-10 mm, 10 mm], times: 3}     pushes of a hand off its way
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
