// What no picture of depth shows: a coarse surface behind the measured one, so that pictures of a capture have no
// holes. Where a photo looks through a hole, the inverse depth is that of a membrane spanned between the hole's borders
// (of a plane the inverse depth is linear, so planes are continued exactly); the completed pictures are fused. It is a
// guess: it is drawn and carries nothing.
#pragma once
#include <functional>

#include "host/capture/frames.hpp"
#include "host/device/device.hpp"
#include "host/geometry/visual_mesh.hpp"

namespace pvg {

// Fills the holes (0) of a picture of depth; what surrounds a hole within `margin` pixels counts by its farthest depth,
// so that things in front do not lean back into it. A picture without any depth stays as it is. Pure.
DepthPicture without_holes(const DepthPicture& picture, int margin);

// The surface behind `measured` that the photos of `frames` look at, without colours; empty where nothing is missing.
// Nothing of it hides `measured` from a photo. Cameras, depths and the result are in the capture's frame.
VisualMesh guess_background(Device& device, const Capture& capture, std::span<const CaptureFrame> frames,
                            const VisualMesh& measured, double max_depth);

}  // namespace pvg
