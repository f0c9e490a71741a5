// A thing on a table, cut out of the surface that depth pictures around it gave: what rises above the plane where the
// cameras look, closed below by its footprint on the plane.
#pragma once
#include <functional>
#include <span>

#include "host/capture/objects/object.hpp"
#include "host/capture/room.hpp"

namespace pvg {

struct StandingSettings {
  double voxel = 2e-3;     // [m]
  double max_depth = 1.5;  // farther depths are left out [m]
};

struct StandingThing {
  VisualMesh mesh;           // its foot at z = 0; open where no camera saw it
  std::size_t n_things = 0;  // on the plane, this one with them
};

// surface: z up, the plane at z = 0 and width x height around the origin [m]. clearance: what is lower belongs to the
// plane [m]. middle: where the cameras look; the thing beside it is taken. The strip below the clearance goes straight
// down, and the foot is the convex hull of its outline: hollow feet are filled. A Failure where nothing stands there.
StandingThing standing_thing(const VisualMesh& surface, double width, double height, double clearance,
                             const Vec3& middle);

// The point nearest to the optical axes of all cameras, by least squares [m].
Vec3 where_cameras_look(std::span<const CaptureFrame> frames);

// The thing that stands on the largest plane of the capture, without a name; say is told of each step. UsageErrors name
// the frame.
ObjectSource read_standing_object(Device& device, const Capture& capture, const StandingSettings& settings,
                                  const std::function<void(const std::string&)>& say);

}  // namespace pvg
