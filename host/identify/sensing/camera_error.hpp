// What a camera does otherwise than the scene says; the default does not.
#pragma once

namespace pvg::diagnose {

struct CameraError {
  double k1 = 0;    // added to that of its lens' distortion
  double gain = 1;  // of all pixels, in linear light
  double v1 = 0;    // added to that of its vignetting
};

}  // namespace pvg::diagnose
