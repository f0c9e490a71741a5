// One texture for a captured surface: each piece of it is cut from the photo that saw it best, exposures equalised and
// seams levelled.
#pragma once
#include "host/capture/colors.hpp"
#include "host/capture/frames.hpp"

namespace pvg {

// mesh: with the mean colours of its points (color_surface), which stay where no photo sees a triangle; tolerance as of
// color_surface [m]. The result has the same triangles in another order, and a point once for each chart. A Failure
// where the texture would be larger than 16384 pixels.
CapturedSurface texture_surface(Device& device, const Photos& photos, const VisualMesh& mesh, double tolerance);

}  // namespace pvg
