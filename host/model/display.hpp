// What a scale shows. Its load is what presses on it along gravity, as a mass:
//   m = sum_i max(0, f_i . g / |g|) / |g| - tare,   f_i: contact force of body i on the scale [N]
// A body that carries the scale pushes against gravity and does not count. The reading r follows as the electronics of
// a scale do, by a first-order lag:  dr/dt = (m - r) / time_constant, exact for a load that is constant over a step.
#pragma once
#include <string>

#include "host/model/scene.hpp"
#include "host/model/world_state.hpp"

namespace pvg {

// m [kg]; without gravity: -tare
double load_on(const Display& display, const PhysicalScene& scene, const WorldState& state);

// the reading a time h [s] after `reading` [kg]
double settled(const Display& display, double reading, double load, double h);

// Of an unloaded scale: [n_displays, kg]
std::vector<double> unloaded_readings(const PhysicalScene& scene);

// The reading in grams, rounded to the resolution, such as "104.2"; what has more places than there are is dashes.
std::string shown_figures(const Display& display, double reading);

// Its face with these figures, as emission and nothing else: lit segments white, all else black.
Texture face_picture(const Display& display, const std::string& figures);

}  // namespace pvg
