// Pictures of depth become one surface: signed distances in sparse blocks of voxels on the device (kernels/capture), of
// which marching cubes makes triangles. First every picture marks the blocks that its surface touches, then memory for
// exactly those is taken, then every picture is integrated.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "capture/voxels.h"
#include "host/capture/frames.hpp"
#include "host/device/device.hpp"
#include "host/geometry/bvh.hpp"

namespace pvg {

// Standard deviation of a depth z: base + growth (z - nearest)^2.
struct DepthNoise {
  double base = 0.0012, growth = 0.0019, nearest = 0.4;  // [m, 1/m, m]; first Kinect, Nguyen et al. 2012
};

struct FusionSettings {
  double voxel = 5e-3;    // [m]
  double truncation = 0;  // [m]; 0: four voxels
  double max_depth = 4;   // [m]
  DepthNoise noise;
  double least_weight = 0.03;  // of a sample, in pictures from 1 m that look straight on; less is no surface
  std::size_t max_bytes = std::size_t(2) << 30;  // of device memory for voxels
  std::size_t n_lanes = 0;                       // pixels or samples of a work-item, 1 or 16; 0: 16 on a CPU, else 1
};

struct FusedSurface {
  std::vector<Vec3f> points;        // [n, m] in the capture's frame
  std::vector<float> sureness;      // [n] weight of the samples beside the point
  std::vector<Triangle> triangles;  // outward: toward free space
};

// Sums of Gauss-Newton over the pixels of a picture whose camera may turn about itself and move, both along the axes of
// the capture's frame; rotation before translation (kernels/capture/registration.cl).
struct RegistrationSums {
  Eigen::Matrix<double, 6, 6> hessian;   // [1/rad^2, 1/(rad m), 1/m^2]
  Eigen::Matrix<double, 6, 1> gradient;  // [1/rad, 1/m]
  double squares = 0, weight = 0;        // of the distances, and [1/m^2]
  double n_pixels = 0;                   // of the picture, that lie near the surface
};

class Fusion {
 public:
  // box: of everything that may be seen, in the capture's frame. A UsageError where the grid of blocks is too large,
  // which names a voxel size that is not.
  Fusion(Device& device, const FusionSettings& settings, const Box& box);
  ~Fusion();
  void mark(const Camera& camera, const DepthPicture& picture);
  // Memory for the marked blocks. A UsageError where they need more than max_bytes, or where there is none.
  void allocate();
  void integrate(const Camera& camera, const DepthPicture& picture);
  // Undoes an integration with the same camera.
  void take_out(const Camera& camera, const DepthPicture& picture);
  // Of a picture against what is fused.
  RegistrationSums registration(const Camera& camera, const DepthPicture& picture);
  FusedSurface surface();
  std::size_t n_blocks() const;
  std::size_t voxel_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Box of the points that a picture shows up to max_depth.
Box seen_box(const Camera& camera, const DepthPicture& picture, double max_depth);

// Vertices of edges for every case of a cell, 16 bytes each (see marching_cubes.cl): along every face, each run of
// inside corners is cut off by one segment; the segments of six faces close to loops, each a fan of triangles.
std::vector<std::uint8_t> marching_cubes_cases();

}  // namespace pvg
