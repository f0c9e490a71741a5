// The surface that Gaussian splats show from around, by fusion of their depths.
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "host/base/error.hpp"
#include "host/capture/fusion.hpp"
#include "host/capture/objects/splats.hpp"
#include "host/capture/surface.hpp"

namespace pvg {
namespace {

constexpr float OPAQUE = 0.1f;         // less opacity is no part of the thing's size
constexpr float MEDIAN = 0.5f;         // share of the light that is absorbed in front of the surface
constexpr float FIRST_SURFACE = 0.1f;  // of TSGS, which trains its depth where at most 0.2 is absorbed (Li et al. 2025)
constexpr int N_VIEWS = 48, PICTURE_SIDE = 384;
constexpr double DISTANCE = 3;     // of the views, in radii of the thing
constexpr double VOXELS = 160;     // along the thing's diameter
constexpr double COLOR_REACH = 3;  // voxels from which splats colour a point

struct Ball {
  Vec3 center = Vec3::Zero();
  double radius = 0;
};

// around 98 % of what is opaque, so that stray splats do not count
Ball ball_around(const Splats& splats) {
  std::vector<float> along[3];
  for (const Splat& s : splats.splats)
    if (s.opacity >= OPAQUE)
      for (int k = 0; k < 3; ++k) along[k].push_back(s.center[k]);
  if (along[0].empty()) throw UsageError("no splat is opaque: is `opacity` a logit, as 3DGS writes it?");
  Vec3 low, high;
  for (int k = 0; k < 3; ++k) {
    std::sort(along[k].begin(), along[k].end());
    const std::size_t n = along[k].size();
    low[k] = double(along[k][n / 100]);
    high[k] = double(along[k][n - 1 - n / 100]);
  }
  const double radius = 0.5 * (high - low).norm();
  if (!(radius > 0)) throw UsageError("all splats are at one point");
  return {0.5 * (low + high), 1.1 * radius};
}

// on a ball, evenly (golden angle), each looking at its middle
Camera view_of(const Ball& ball, int i) {
  const double z = 1 - 2 * (i + 0.5) / N_VIEWS, angle = i * M_PI * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
  const Vec3 out(r * std::cos(angle), r * std::sin(angle), z);
  Camera camera;
  camera.name = "view " + std::to_string(i);
  camera.width = camera.height = PICTURE_SIDE;
  camera.cx = camera.cy = 0.5 * (PICTURE_SIDE - 1);
  // the ball fills the picture
  camera.fx = camera.fy = 0.5 * PICTURE_SIDE * std::sqrt(DISTANCE * DISTANCE - 1);
  const Vec3 right = out.cross(Vec3(0.123, 0.456, 0.881)).normalized();
  camera.pose.linear().col(0) = right;
  camera.pose.linear().col(1) = right.cross(out);
  camera.pose.linear().col(2) = -out;
  camera.pose.translation() = ball.center + DISTANCE * ball.radius * out;
  return camera;
}

// Means of the splats within COLOR_REACH voxels, by opacity and distance; of the nearest ones there where there are
// none.
std::vector<Vec3f> colors_at(const std::vector<Vec3f>& points, const Splats& splats, float voxel) {
  const float cell = float(COLOR_REACH) * voxel;
  const auto key = [&](int x, int y, int z) {
    return std::uint64_t(x + (1 << 20)) << 42 | std::uint64_t(y + (1 << 20)) << 21 | std::uint64_t(z + (1 << 20));
  };
  const auto index = [&](float x) { return int(std::floor(std::clamp(x / cell, -1e6f, 1e6f))); };
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> in;
  for (std::uint32_t i = 0; i < splats.splats.size(); ++i) {
    const float* c = splats.splats[i].center;
    if (splats.splats[i].opacity >= OPAQUE) in[key(index(c[0]), index(c[1]), index(c[2]))].push_back(i);
  }
  std::vector<Vec3f> colors;
  for (const Vec3f& p : points) {
    Vec3f sum = Vec3f::Zero();
    float weights = 0;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const auto found = in.find(key(index(p.x()) + dx, index(p.y()) + dy, index(p.z()) + dz));
          if (found == in.end()) continue;
          for (const std::uint32_t i : found->second) {
            const Splat& s = splats.splats[i];
            const float d2 = (Vec3f(s.center[0], s.center[1], s.center[2]) - p).squaredNorm();
            const float w = s.opacity * std::exp(-0.5f * d2 / (voxel * voxel)) + 1e-12f;
            sum += w * splats.colors[i];
            weights += w;
          }
        }
    colors.push_back(weights > 0 ? Vec3f(sum / weights) : Vec3f::Constant(0.5f));
  }
  return colors;
}

}  // namespace

VisualMesh surface_of_splats(Device& device, const Splats& splats) {
  const Ball ball = ball_around(splats);
  const float share = splats.format == "TSGS" ? FIRST_SURFACE : MEDIAN;
  FusionSettings settings;
  settings.voxel = 2 * ball.radius / VOXELS;
  settings.max_depth = (DISTANCE + 1) * ball.radius;  // stray splats behind are left out
  settings.noise = {0.3 * settings.voxel, 0, 0};
  settings.least_weight = 0.5;
  Box box;
  for (const double side : {-1.0, 1.0}) box.add((ball.center + Vec3::Constant(side * ball.radius)).cast<float>());
  Fusion fusion(device, settings, box);
  std::vector<DepthPicture> depths;
  for (int i = 0; i < N_VIEWS; ++i) {
    depths.push_back(splat_depth(device, splats, view_of(ball, i), share));
    fusion.mark(view_of(ball, i), depths.back());
  }
  fusion.allocate();
  for (int i = 0; i < N_VIEWS; ++i) fusion.integrate(view_of(ball, i), depths[std::size_t(i)]);
  const FusedSurface fused = without_unused(fusion.surface());
  FusedSurface surface = without_small_pieces(fused, 0.01 * surface_area(fused.points, fused.triangles));
  VisualMesh mesh;
  mesh.colors = colors_at(surface.points, splats, float(settings.voxel));
  mesh.points = std::move(surface.points);
  mesh.triangles = std::move(surface.triangles);
  return mesh;
}

}  // namespace pvg
