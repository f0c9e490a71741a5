#include "host/capture/objects/silhouette.hpp"

#include "host/base/error.hpp"
#include "host/render/camera.hpp"

namespace pvg {
namespace {

Mask8 mask_of(const MaskedView& view) {
  Mask8 mask = read_mask_picture(view.mask);
  if (mask.width != view.camera.width || mask.height != view.camera.height)
    throw UsageError(view.mask.string() + " has " + std::to_string(mask.width) + " x " + std::to_string(mask.height) +
                     " pixels, its camera " + std::to_string(view.camera.width) + " x " +
                     std::to_string(view.camera.height) + "; give the intrinsics of this size");
  return mask;
}

}  // namespace

std::vector<Eigen::Vector2d> outline_of(const Mask8& mask) {
  std::vector<Eigen::Vector2d> outline;
  const auto at = [&](int x, int y) { return mask.pixels[std::size_t(y) * std::size_t(mask.width) + std::size_t(x)]; };
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (x + 1 < mask.width && at(x, y) != at(x + 1, y)) outline.emplace_back(x + 0.5, y);
      if (y + 1 < mask.height && at(x, y) != at(x, y + 1)) outline.emplace_back(x, y + 0.5);
    }
  return outline;
}

std::vector<TouchingRay> touching_rays(Device& device, std::span<const MaskedView> views, std::size_t most) {
  Program program(device, "capture/rays.cl");
  Kernel pixel_rays = program.kernel("pixel_rays");
  Buffer<float> pixels(device, 0, "pixels"), directions(device, 0, "directions");
  std::vector<TouchingRay> rays;
  for (std::size_t view = 0; view < views.size(); ++view) {
    const Camera& camera = views[view].camera;
    const std::vector<Eigen::Vector2d> outline = outline_of(mask_of(views[view]));
    if (outline.empty()) throw UsageError(views[view].mask.string() + " is all of one brightness: it has no outline");
    const std::size_t n = std::min(most, outline.size());
    std::vector<float> chosen;
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector2d& pixel = outline[i * outline.size() / n];
      chosen.insert(chosen.end(), {float(pixel.x()), float(pixel.y())});
    }
    pixels.resize(2 * n);
    pixels.write(chosen);
    directions.resize(3 * n);
    pixel_rays(n, u32(n), pinhole_camera(camera, camera.pose.matrix()), pixels, directions);
    const std::vector<float> found = directions.read();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 direction(found[3 * i], found[3 * i + 1], found[3 * i + 2]);
      if (direction.isZero()) continue;  // of a fisheye's black corners
      rays.push_back({camera.pose.translation(), direction.normalized(), 0.5 * (camera.fx + camera.fy), view});
    }
  }
  return rays;
}

}  // namespace pvg
