// What rests on something at a window's start. A measured start is a little inside its support or above it; the
// simulator would push the body out or let it fall, friction would act or not meanwhile, and a fit of that start goes
// by kinks. Such a body starts where it comes to rest, and keeps only what its support leaves free.
#pragma once
#include "host/device/device.hpp"
#include "host/identify/data/window.hpp"

namespace pvg::diagnose {

// Lets the bodies of a window come to rest from their measured start, and moves that start along the support's normal
// if it is as near to it as its samples say. Unknowns along the normal are no unknowns any more; on a face those of
// tilting neither. scene: a variant of the problem's.
void settle_on_support(Device& device, const Problem& problem, const PhysicalScene& scene, Window& window);

}  // namespace pvg::diagnose
