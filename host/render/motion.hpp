// Between two states of a scene. Pure.
#pragma once
#include "host/scene/state.hpp"

namespace pvg {

// share 0: a, 1: b. Points go in straight lines, rigid bodies turn evenly about their moving origin (spherical linear
// interpolation), the strain of affine bodies goes linearly. Both must be of one scene.
SceneState interpolate(const SceneState& a, const SceneState& b, double share);

}  // namespace pvg
