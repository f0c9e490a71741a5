// When Newton's method may stop.
#pragma once
#include "host/model/physical_scene.hpp"

namespace pvg {

// Speed below which every point's next correction must be [m/s]: what the solver's settings say, and with dry friction
// in a joint a tenth of the speed over which it is smoothed, whatever is less.
double newton_tolerance(const PhysicalScene& scene);

}  // namespace pvg
