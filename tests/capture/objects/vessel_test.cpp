// Vessels are found again from the masks of their polygons, which are filled without any formula of the fit.
#include "host/capture/objects/vessel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pvg {
namespace {

using Vec2 = Eigen::Vector2d;
constexpr int WIDTH = 640, HEIGHT = 480;
constexpr double FOCAL = 900, HALF_A_PIXEL = 0.5 * 0.5 / FOCAL;  // [pixels, m]

// An Erlenmeyer flask: foot, cone, neck. [m]
const Profile FLASK = {{0, 0}, {0.032, 0}, {0.034, 0.004}, {0.013, 0.07}, {0.013, 0.1}};

// at half a metre around (x, y), looking a little down at it
Camera camera_at(double turn, double height, const Vec2& axis) {
  Camera camera;
  camera.width = WIDTH;
  camera.height = HEIGHT;
  camera.fx = camera.fy = FOCAL;
  camera.cx = 0.5 * (WIDTH - 1);
  camera.cy = 0.5 * (HEIGHT - 1);
  const Vec3 eye(axis.x() + 0.5 * std::cos(turn), axis.y() + 0.5 * std::sin(turn), height);
  const Vec3 z = (Vec3(axis.x(), axis.y(), 0.05) - eye).normalized(), x = z.cross(Vec3::UnitZ()).normalized();
  camera.pose.linear() << x, z.cross(x), z;
  camera.pose.translation() = eye;
  return camera;
}

double side(const Vec2& a, const Vec2& b, const Vec2& p) {
  return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
}

// pixels whose middle is inside one of the projected triangles
Picture8 mask_picture(const TriangleMesh& mesh, const Camera& camera) {
  Picture8 picture{WIDTH, HEIGHT, std::vector<std::uint8_t>(3 * WIDTH * HEIGHT, 0)};
  std::vector<Vec2> seen;
  for (const Vec3& p : mesh.points) {
    const Vec3 q = camera.pose.inverse() * p;
    seen.emplace_back(FOCAL * q.x() / q.z() + camera.cx, FOCAL * q.y() / q.z() + camera.cy);
  }
  for (const Triangle& t : mesh.triangles) {
    const Vec2 a = seen[t[0]], b = seen[t[1]], c = seen[t[2]];
    const Vec2 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    for (int y = int(std::ceil(low.y())); y <= int(high.y()); ++y)
      for (int x = int(std::ceil(low.x())); x <= int(high.x()); ++x) {
        const Vec2 p(x, y);
        const double u = side(a, b, p), v = side(b, c, p), w = side(c, a, p);
        if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))
          for (int k = 0; k < 3; ++k) picture.rgb[std::size_t(3 * (y * WIDTH + x) + k)] = 255;
      }
  }
  return picture;
}

struct Photographed {
  TestFolder folder;
  nlohmann::json transforms = {{"w", WIDTH},
                               {"h", HEIGHT},
                               {"fl_x", FOCAL},
                               {"fl_y", FOCAL},
                               {"cx", 0.5 * WIDTH},
                               {"cy", 0.5 * HEIGHT},
                               {"frames", nlohmann::json::array()}};

  void add(const TriangleMesh& mesh, const Camera& camera) {
    const std::string name = "mask_" + std::to_string(transforms["frames"].size()) + ".png";
    write_picture(folder.path / name, mask_picture(mesh, camera));
    nlohmann::json rows;
    for (int i = 0; i < 4; ++i) {
      nlohmann::json row;
      for (int j = 0; j < 4; ++j) row.push_back(camera.pose.matrix()(i, j) * (j == 1 || j == 2 ? -1 : 1));
      rows.push_back(row);
    }
    transforms["frames"].push_back({{"mask_path", name}, {"transform_matrix", rows}});
  }
  Vessel fit(Device& device) {
    folder.write("transforms.json", transforms.dump());
    return vessel_of_masks(device, read_vessel_views(folder.path), 1);
  }
};

// eight photos, half of them from higher up
void photograph(const Profile& profile, const Vec2& axis, Photographed& photos) {
  TriangleMesh mesh = revolved(closed_outline(profile, 2e-3), 96);
  for (Vec3& p : mesh.points) p.head<2>() += axis;
  for (int k = 0; k < 8; ++k) photos.add(mesh, camera_at(k * 0.8, k % 2 ? 0.12 : 0.3, axis));
}

double radius_at(const Profile& profile, double height) {
  for (std::size_t i = 1; i < profile.size(); ++i)
    if (profile[i].y() >= height && profile[i].y() > profile[i - 1].y())
      return profile[i - 1].x() + (profile[i].x() - profile[i - 1].x()) * (height - profile[i - 1].y()) /
                                      (profile[i].y() - profile[i - 1].y());
  return profile.back().x();
}

// Within half a pixel, 0.28 mm at half a metre, but for the foot's corner, which lies between two of the rings.
TEST(Vessel, AFlaskIsFoundFromItsMasks) {
  Device device("", Purpose::rendering);
  const Vec2 axis(0.31, -0.12);
  Photographed photos;
  photograph(FLASK, axis, photos);
  const Vessel vessel = photos.fit(device);
  EXPECT_LT((vessel.axis - axis).norm(), 0.1e-3);
  EXPECT_NEAR(vessel.height, 0.1, 0.2e-3);
  EXPECT_LT(vessel.residual, 0.5);
  for (const Vec2& p : vessel.outside())
    EXPECT_NEAR(p.x(), p.x() > 0 ? radius_at(FLASK, p.y()) : 0, p.y() < 0.006 ? 0.8e-3 : HALF_A_PIXEL) << p.y();
  double worst = 0;  // above the foot's corner
  for (const Vec2& p : vessel.outside())
    if (p.y() > 0.006) worst = std::max(worst, std::abs(p.x() - radius_at(FLASK, p.y())));
  std::printf("axis off by %.3f mm, height by %.3f mm, radii by %.3f mm at most; outlines by %.2f pixels\n",
              1e3 * (vessel.axis - axis).norm(), 1e3 * std::abs(vessel.height - 0.1), 1e3 * worst, vessel.residual);
  const ObjectSource source = turned_object("flask", vessel.outside(), 2e-3);
  EXPECT_TRUE(is_sound(source.mesh));
  EXPECT_NEAR(enclosed_volume(source.mesh) / enclosed_volume(revolved(closed_outline(FLASK, 2e-3), 96)), 1, 0.02);
}

TEST(Vessel, APhotoThatDisagreesIsNamed) {
  Device device("", Purpose::rendering);
  Photographed photos;
  photograph(FLASK, {0, 0}, photos);
  photos.transforms["frames"][3]["transform_matrix"][0][3] =
      photos.transforms["frames"][3]["transform_matrix"][0][3].get<double>() + 0.02;
  expect_error<UsageError>([&] { photos.fit(device); }, {"mask_3.png", "pixels off"});
}

TEST(Vessel, WhatIsNoVesselIsRefused) {
  Device device("", Purpose::rendering);
  TriangleMesh slab = revolved(closed_outline({{0, 0}, {0.04, 0}, {0.04, 0.1}, {0, 0.1}}, 0), 96);
  for (Vec3& p : slab.points) p.y() *= 0.3;
  Photographed photos;
  for (int k = 0; k < 2; ++k) photos.add(slab, camera_at(0.8 * k, 0.2, {0, 0}));
  expect_error<UsageError>([&] { photos.fit(device); }, {"three photos"});
  for (int k = 2; k < 8; ++k) photos.add(slab, camera_at(0.8 * k, 0.2, {0, 0}));
  expect_error<UsageError>([&] { photos.fit(device); }, {"no turned thing", "z = 0"});
  write_picture(photos.folder.path / "mask_1.png", {WIDTH, HEIGHT, std::vector<std::uint8_t>(3 * WIDTH * HEIGHT, 0)});
  expect_error<UsageError>([&] { photos.fit(device); }, {"mask_1.png", "no outline"});
  write_picture(photos.folder.path / "mask_1.png", {8, 8, std::vector<std::uint8_t>(3 * 64, 0)});
  expect_error<UsageError>([&] { photos.fit(device); }, {"mask_1.png", "8 x 8", "640 x 480"});
}

}  // namespace
}  // namespace pvg
