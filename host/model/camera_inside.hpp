// Cameras that see nothing but the inside of a thing: a slip of a pose, or of metres and millimetres.
#pragma once
#include <string>
#include <vector>

#include "host/model/scene.hpp"

namespace pvg {

// A sentence for each camera that is inside of a body's closed opaque mesh at the start. What no body moves, such as a
// room, may be around a camera.
std::vector<std::string> cameras_inside(const Scene& scene);

}  // namespace pvg
