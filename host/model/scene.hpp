// What is simulated and what is seen of it: the meeting point of the loaders (above) and of physics and rendering
// (beside). Physics reads PhysicalScene alone, so that no simulation copies pictures.
#pragma once
#include "host/model/appearance.hpp"
#include "host/model/physical_scene.hpp"

namespace pvg {

struct Scene : PhysicalScene, Appearance {};

}  // namespace pvg
