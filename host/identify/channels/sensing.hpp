// How what is measured differs from what is there. The defaults do not.
#pragma once
#include <vector>

#include "host/geometry/mesh.hpp"

namespace pvg::diagnose {

// What a camera does otherwise than the scene says.
struct CameraError {
  double k1 = 0;    // added to that of its lens' distortion
  double gain = 1;  // of all pixels, in linear light
  double v1 = 0;    // added to that of its vignetting
};

struct Sensing {
  double clock_offset = 0;             // the recording's clock shows the true time less this [s]
  double clock_rate = 0;               // true seconds per second of the recording, less one
  double length_scale = 0;             // measured lengths over true ones, less one
  Vec3 frame_rotation = Vec3::Zero();  // rotation vector of the measurement's frame [rad]
  std::vector<double> latency;         // [n_channels, s] empty: none
  std::vector<Vec3> bias;              // [n_channels, SI] added to what is measured
  std::vector<CameraError> camera;     // [n_cameras of Problem::seen] empty: none
  std::vector<Vec3> marker_offset;     // [n_channels, m] of a marker from where it is said to be, in the body's frame
};

}  // namespace pvg::diagnose
