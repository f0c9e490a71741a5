#include "tests/capture/synthetic_room.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "host/formats/picture_files.hpp"
#include "host/render/renderer.hpp"

namespace pvg {
namespace {

// axis-aligned boxes of the room: a floor, two walls, a table top with a leg and two things on it  [m]
struct Block {
  Vec3 low, high;
  Vec3f color;
};
const std::vector<Block> BLOCKS = {{{-1.5, -1.5, -0.8}, {1.5, 1.5, -0.7}, {0.5f, 0.4f, 0.3f}},
                                   {{-1.5, 1.4, -0.8}, {1.5, 1.5, 1.2}, {0.6f, 0.6f, 0.5f}},
                                   {{-1.5, -1.5, -0.8}, {-1.4, 1.5, 1.2}, {0.4f, 0.5f, 0.6f}},
                                   {{-0.6, -0.4, -0.04}, {0.6, 0.4, 0}, {0.7f, 0.5f, 0.3f}},
                                   {{-0.05, -0.05, -0.7}, {0.05, 0.05, -0.04}, {0.2f, 0.2f, 0.2f}},
                                   {{-0.4, -0.2, 0}, {-0.2, 0.1, 0.15}, {0.8f, 0.2f, 0.2f}},
                                   {{0.2, 0.05, 0}, {0.35, 0.2, 0.25}, {0.2f, 0.7f, 0.3f}}};

// signed, negative inside
double box_distance(const Block& b, const Vec3& p) {
  const Vec3 d = (p - 0.5 * (b.low + b.high)).cwiseAbs() - 0.5 * (b.high - b.low);
  return d.cwiseMax(0.0).norm() + std::min(0.0, d.maxCoeff());
}

}  // namespace

double distance_to_room(const Vec3& p) {
  double nearest = INFINITY;
  for (const Block& b : BLOCKS) nearest = std::min(nearest, box_distance(b, p));
  return std::abs(nearest);
}

namespace {

VisualMesh room_mesh() {
  VisualMesh mesh;
  for (const Block& b : BLOCKS) {
    const std::uint32_t first = std::uint32_t(mesh.points.size());
    for (int k = 0; k < 8; ++k) {
      mesh.points.emplace_back(float((k & 1 ? b.high : b.low).x()), float((k & 2 ? b.high : b.low).y()),
                               float((k & 4 ? b.high : b.low).z()));
      mesh.colors.push_back(b.color);
    }
    for (const auto& q : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
      for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 2, 3}})
        mesh.triangles.push_back(
            {first + std::uint32_t(q[t[0]]), first + std::uint32_t(q[t[1]]), first + std::uint32_t(q[t[2]])});
  }
  return mesh;
}

std::vector<Camera> walk(int n, int width, int height) {
  std::vector<Camera> cameras;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n, radius = 0.7 + 0.2 * (i % 3);
    Camera camera;
    camera.name = "camera " + std::to_string(i);
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = 585.0 * width / 640;
    camera.cx = 0.5 * (width - 1);
    camera.cy = 0.5 * (height - 1);
    camera.pose.translation() = Vec3(radius * std::cos(angle), radius * std::sin(angle) - 0.1, 0.55 + 0.15 * (i % 4));
    const Vec3 z = (Vec3(0.1 * std::sin(3 * angle), 0.1, -0.15 * (i % 3)) - camera.pose.translation()).normalized(),
               x = z.cross(Vec3::UnitZ()).normalized();
    camera.pose.linear().col(0) = x;
    camera.pose.linear().col(1) = z.cross(x);
    camera.pose.linear().col(2) = z;
    cameras.push_back(camera);
  }
  return cameras;
}

}  // namespace

float wave_pattern(const Vec3& p) {
  double sum = 0;
  for (int k = 0; k < 6; ++k) {
    const Vec3 direction(std::sin(1.3 * k), std::cos(2.1 * k), std::sin(0.7 + 2.9 * k));
    sum += std::sin(2 * M_PI * direction.normalized().dot(p) / (0.06 + 0.03 * k) + k);
  }
  return float(0.75 + 0.1 * sum);
}

namespace {

void paint_pattern(RenderedFrame& frame, const Camera& camera) {
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(frame.width) + std::size_t(x);
      const double z = double(frame.depth[i]);
      if (!std::isfinite(z)) continue;
      const float shade =
          wave_pattern(camera.pose * Vec3((x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z));
      for (std::size_t k = 0; k < 3; ++k) frame.rgb[3 * i + k] *= shade;
    }
}

}  // namespace

DepthPicture with_kinect_noise(const DepthPicture& exact, std::mt19937& random) {
  std::normal_distribution<double> unit(0, 1);
  DepthPicture picture{exact.width, exact.height, std::vector<float>(exact.depth.size(), 0.0f)};
  for (std::size_t i = 0; i < picture.depth.size(); ++i) {
    const double z = double(exact.depth[i]);
    if (!std::isfinite(z) || z < 0.4 || z > 5) continue;
    const double noisy = z + unit(random) * (0.0012 + 0.0019 * (z - 0.4) * (z - 0.4));
    picture.depth[i] = float(std::round(noisy * 1e3) * 1e-3);
  }
  return picture;
}

void write_frames(const std::filesystem::path& folder, int n, int width, int height, const Pose& from_room,
                  bool is_patterned) {
  Scene scene;
  VisualMaterial material;
  material.name = "room";
  material.kind = VisualMaterial::Kind::shadow_receiver;
  material.color = Vec3f::Ones();
  scene.materials.push_back(material);
  scene.visual_meshes.push_back(room_mesh());
  Visual visual;
  visual.name = "room";
  visual.mesh = visual.material = 0;
  scene.visuals.push_back(visual);
  scene.cameras = walk(n, width, height);
  Device device;
  RenderSettings settings;
  settings.samples = 2;
  settings.max_depth = 1;
  Renderer renderer(device, scene, settings);
  renderer.set_state(initial_state(scene));
  std::mt19937 random(3);
  const Camera& c = scene.cameras[0];
  std::ofstream(folder / "camera-intrinsics.txt")
      << c.fx << " 0 " << c.cx << "\n0 " << c.fy << ' ' << c.cy << "\n0 0 1\n";
  for (int i = 0; i < n; ++i) {
    RenderedFrame frame = renderer.render(i, 0);
    if (is_patterned) paint_pattern(frame, scene.cameras[std::size_t(i)]);
    char name[32];
    std::snprintf(name, sizeof name, "frame-%06d", i);
    write_depth_picture(folder / (std::string(name) + ".depth.png"),
                        with_kinect_noise({width, height, frame.depth}, random), 1e-3);
    write_picture(folder / (std::string(name) + ".color.png"), encode_srgb8(frame.rgb, width, height));
    std::ofstream pose(folder / (std::string(name) + ".pose.txt"));
    pose.precision(17);
    pose << (from_room * scene.cameras[std::size_t(i)].pose).matrix() << '\n';
  }
}

Pose some_frame() {
  Pose pose = Pose::Identity();
  pose.linear() = (Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(-1.1, Vec3::UnitZ())).toRotationMatrix();
  pose.translation() = Vec3(0.4, -2, 0.7);
  return pose;
}

}  // namespace pvg
