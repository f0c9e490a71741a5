// What the path tracer makes of one instant: light and exact ground truth, pixel by pixel. Pure.
#pragma once
#include <cstdint>
#include <vector>

namespace pvg {

struct RenderedFrame {
  int width = 0, height = 0;
  std::vector<float> rgb;       // linear Rec. 709, exposure applied  [height x width x 3]
  std::vector<float> depth;     // z in the camera's frame at the pixel's centre, lights included, infinite where
                                // nothing is hit [m]
  std::vector<float> distance;  // from the camera, likewise [m]
  std::vector<std::uint32_t> instance;  // 1 + index of the Visual at the pixel's centre, 0: nothing or a light  [h x w]
  std::vector<float> normal;  // of the surface at the pixel's centre, unit, world, toward the camera, or 0  [h x w x 3]
  // Empty unless asked for: means over the pixel's samples, as its light is, of the first surface that scatters, seen
  // through clear glass and in mirrors.  [h x w x 3]
  std::vector<float> albedo;          // its colour, in [0, 1]
  std::vector<float> mean_normal;     // its unit normals, world, toward the path
  std::uint32_t dropped_samples = 0;  // samples that were not finite and were left out
  std::uint64_t rays = 0;             // path segments traced, shadow rays not counted
};

// Where the points of a picture's pixel centres are in another picture of the same camera.
struct FlowFrame {
  std::vector<float> flow;          // [height x width x 2, pixels] right and down; 0 where nothing can be said
  std::vector<std::uint8_t> state;  // [height x width] 0: seen there, 1: hidden by something, 2: outside the picture
};

}  // namespace pvg
