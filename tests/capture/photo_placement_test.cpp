// A photo of a patterned wall that was taken elsewhere than its file says.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/capture/surface_views.hpp"
#include "host/formats/picture_files.hpp"
#include "host/render/camera.hpp"
#include "tests/capture/synthetic_room.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

constexpr double SIDE = 1.6, SPACING = 0.005;  // of the wall z = 0 [m]

Vec3f color_at(const Vec3& p) { return 0.5f * wave_pattern(p) * Vec3f(1, 0.9f, 0.8f); }

CapturedSurface patterned_wall() {
  CapturedSurface out;
  const int n = int(std::lround(SIDE / SPACING)) + 1;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const Vec3 p(SPACING * x - SIDE / 2, SPACING * y - SIDE / 2, 0);
      out.mesh.points.push_back(p.cast<float>());
      out.mesh.colors.push_back(color_at(p));
      if (x + 1 == n || y + 1 == n) continue;
      const std::uint32_t a = std::uint32_t(y * n + x), below = a + std::uint32_t(n);
      out.mesh.triangles.push_back({a, below, a + 1});
      out.mesh.triangles.push_back({a + 1, below, below + 1});
    }
  return out;
}

Camera camera_before_the_wall() {
  Camera camera;
  camera.width = 320, camera.height = 240;
  camera.fx = camera.fy = 300;
  camera.cx = 159.5, camera.cy = 119.5;
  camera.pose.linear() = Eigen::AngleAxisd(0.15, Vec3(1, 0.6, 0.2).normalized()).toRotationMatrix();
  camera.pose.translation() = Vec3(0.05, 0.1, -0.9);
  return camera;
}

Vec3 seen_by(const Camera& camera, double x, double y) {
  const Vec3 ray = camera.pose.linear() * Vec3((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  return camera.pose.translation() - camera.pose.translation().z() / ray.z() * ray;
}

// Two thirds as bright as the surface's colours, and a tenth of it shows something else.
Picture8 photo_of_wall(const Camera& camera) {
  std::vector<float> rgb;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const bool is_foreign = x < 100 && y < 80;
      const Vec3f color = is_foreign ? Vec3f(0.05f, 0.4f, 0.1f) : Vec3f(2 * color_at(seen_by(camera, x, y)) / 3);
      rgb.insert(rgb.end(), color.data(), color.data() + 3);
    }
  return encode_srgb8(rgb, camera.width, camera.height);
}

// how far the wall's points are apart in the pictures of both, mean over the picture [pixels]
double pixels_apart(const Camera& a, const Camera& b) {
  double sum = 0, n = 0;
  for (int y = 0; y < a.height; y += 20)
    for (int x = 0; x < a.width; x += 20, ++n) {
      const Vec3 p = b.pose.inverse() * seen_by(a, x, y);
      sum += std::hypot(b.fx * p.x() / p.z() + b.cx - x, b.fy * p.y() / p.z() + b.cy - y);
    }
  return sum / n;
}

CaptureFrame frame_of(const TestFolder& folder, const Camera& taken_by, const Camera& given) {
  write_picture(folder.path / "photo.png", photo_of_wall(taken_by));
  return {"photo", folder.path / "photo.png", {}, nullptr, given, given};
}

// A known motion of 6 mm and 0.3 degrees.
TEST(PhotoPlacement, AMovedCameraIsFoundAgain) {
  const Camera truth = camera_before_the_wall();
  Camera given = truth;
  given.pose.translation() += Vec3(0.004, -0.003, 0.0035);
  given.pose.linear() *= Eigen::AngleAxisd(0.3 * M_PI / 180, Vec3(0.3, 0.5, 0.8).normalized()).toRotationMatrix();
  const TestFolder folder;
  const CaptureFrame frame = frame_of(folder, truth, given);
  const CapturedSurface surface = patterned_wall();
  Device device;
  Camera placed = given;
  placed.pose = place_photos(device, {&frame, 1}, {&surface, 1}).at(0);
  std::printf("%.3f pixels off before, %.3f after; %.2f mm, %.4f degrees\n", pixels_apart(truth, given),
              pixels_apart(truth, placed), 1e3 * (placed.pose.translation() - truth.pose.translation()).norm(),
              Eigen::AngleAxisd(placed.pose.linear().transpose() * truth.pose.linear()).angle() * 180 / M_PI);
  EXPECT_GT(pixels_apart(truth, given), 1.5);
  EXPECT_LT(pixels_apart(truth, placed), 0.05);
}

TEST(PhotoPlacement, ACameraThatIsRightStays) {
  const Camera truth = camera_before_the_wall();
  const TestFolder folder;
  const CaptureFrame frame = frame_of(folder, truth, truth);
  const CapturedSurface surface = patterned_wall();
  Device device;
  Camera placed = truth;
  placed.pose = place_photos(device, {&frame, 1}, {&surface, 1}).at(0);
  EXPECT_LT(pixels_apart(truth, placed), 0.05);
}

// nothing of the surface is before it
TEST(PhotoPlacement, APhotoOfSomethingElseStaysWhereItWas) {
  Camera away = camera_before_the_wall();
  away.pose.translation().z() = 3;
  const TestFolder folder;
  const CaptureFrame frame = frame_of(folder, camera_before_the_wall(), away);
  const CapturedSurface surface = patterned_wall();
  Device device;
  EXPECT_EQ(place_photos(device, {&frame, 1}, {&surface, 1}).at(0).matrix(), away.pose.matrix());
}

}  // namespace
}  // namespace pvg
