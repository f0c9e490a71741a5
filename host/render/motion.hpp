// Between two states of a scene. Pure.
#pragma once
#include <span>

#include "host/model/state.hpp"

namespace pvg {

// share 0: a, 1: b. Points go in straight lines, rigid bodies turn evenly about their moving origin (spherical linear
// interpolation), the strain of affine bodies goes linearly. Both must be of one scene.
SceneState interpolate(const SceneState& a, const SceneState& b, double share);

// At a time, from states of ascending times, at least one; before the first and after the last: those.
SceneState state_at(std::span<const SceneState> states, double time);

}  // namespace pvg
