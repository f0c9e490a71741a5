// Small scenes for the tests of the renderer.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>

#include "host/render/renderer.hpp"

namespace pvg::test {

// $PVG_OCLGRIND is set where kernels run in a simulator, a thousand times slower: pictures are then small, and tests
// that need many paths skip
inline bool is_simulated() { return std::getenv("PVG_OCLGRIND") != nullptr; }

struct ManyPaths : testing::Test {
  void SetUp() override {
    if (is_simulated()) GTEST_SKIP() << "takes too many paths for a simulated device";
  }
};

// corner, corner + u, corner + u + v, corner + v; outward is cross(u, v); uv (0, 0) at the corner, x along u
inline VisualMesh quad(const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
  VisualMesh mesh;
  mesh.points = {corner, corner + u, corner + u + v, corner + v};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// closed, outward normals, flat
inline VisualMesh box(const Vec3f& lo, const Vec3f& hi) {
  const Vec3f d = hi - lo, x(d.x(), 0, 0), y(0, d.y(), 0), z(0, 0, d.z());
  VisualMesh mesh;
  for (const VisualMesh& side :
       {quad(lo, y, x), quad(lo, x, z), quad(lo, z, y), quad(hi, -x, -y), quad(hi, -z, -x), quad(hi, -y, -z)}) {
    const std::uint32_t first = std::uint32_t(mesh.points.size());
    mesh.points.insert(mesh.points.end(), side.points.begin(), side.points.end());
    for (const Triangle& t : side.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return mesh;
}

// about the origin, smooth normals, n rings
inline VisualMesh sphere(float radius, unsigned n) {
  VisualMesh mesh;
  for (unsigned i = 0; i <= n; ++i)
    for (unsigned j = 0; j <= 2 * n; ++j) {
      const float a = float(M_PI) * float(i) / float(n), b = float(M_PI) * float(j) / float(n);
      mesh.normals.emplace_back(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      mesh.points.push_back(radius * mesh.normals.back());
    }
  for (unsigned i = 0; i < n; ++i)
    for (unsigned j = 0; j < 2 * n; ++j) {
      const unsigned q = i * (2 * n + 1) + j, w = q + 2 * n + 1;
      if (i > 0) mesh.triangles.push_back({q, w, q + 1});
      if (i + 1 < n) mesh.triangles.push_back({q + 1, w, w + 1});
    }
  return mesh;
}

inline VisualMaterial material(VisualMaterial::Kind kind, const Vec3f& color = Vec3f::Ones()) {
  VisualMaterial m;
  m.name = "test";
  m.kind = kind;
  m.color = color;
  if (kind == VisualMaterial::Kind::dielectric) m.roughness = 0;  // clear
  return m;
}

inline Visual& add(Scene& scene, VisualMesh mesh, const VisualMaterial& material, const Vec3& at = Vec3::Zero()) {
  scene.visual_meshes.push_back(std::move(mesh));
  scene.materials.push_back(material);
  Visual visual;
  visual.name = "visual " + std::to_string(scene.visuals.size());
  visual.mesh = int(scene.visual_meshes.size()) - 1;
  visual.material = int(scene.materials.size()) - 1;
  visual.pose.translation() = at;
  scene.visuals.push_back(visual);
  return scene.visuals.back();
}

inline void add_light(Scene& scene, const Vec3& corner, const Vec3& u, const Vec3& v, const Vec3f& radiance) {
  scene.lights.push_back({"light " + std::to_string(scene.lights.size()), corner, u, v, radiance});
}

// focal: [pixels]
inline Camera& look_at(Scene& scene, const Vec3& eye, const Vec3& at, int width, int height, double focal) {
  Camera camera;
  camera.name = "camera";
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  const Vec3 z = (at - eye).normalized();
  const Vec3 up = std::abs(z.z()) > 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 x = z.cross(up).normalized();
  camera.pose.linear().col(0) = x;
  camera.pose.linear().col(1) = z.cross(x);
  camera.pose.linear().col(2) = z;
  camera.pose.translation() = eye;
  scene.cameras.push_back(camera);
  return scene.cameras.back();
}

struct Mean {
  double value = 0, sigma = 0;  // of the mean, from the spread of independent pixels
};

// of one colour over pixels [first, last)
inline Mean mean(const RenderedFrame& frame, int channel, std::size_t first, std::size_t last) {
  double sum = 0, squares = 0;
  const double n = double(last - first);
  for (std::size_t i = first; i < last; ++i) {
    const double x = frame.rgb[3 * i + channel];
    sum += x;
    squares += x * x;
  }
  return {sum / n, std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)) / n)};
}
inline Mean mean(const RenderedFrame& frame, int channel = 0) {
  return mean(frame, channel, 0, std::size_t(frame.width) * frame.height);
}

// Lambert's formula: irradiance of a polygon of radiance L, E = L / 2 sum_i theta_i (g_i . n), g_i the unit normal of
// the edge's plane through the point, theta_i the angle of the edge
inline double irradiance(const std::vector<Vec3>& polygon, const Vec3& point, const Vec3& normal) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = (polygon[i] - point).normalized(), b = (polygon[(i + 1) % polygon.size()] - point).normalized();
    sum += std::acos(a.dot(b)) * a.cross(b).normalized().dot(normal);
  }
  return std::abs(sum) / 2;
}

inline RenderedFrame picture(const Scene& scene, int samples, bool transparent_shadows = true, int max_depth = 64) {
  Device device;
  RenderSettings settings;
  settings.samples = samples;
  settings.max_depth = max_depth;
  settings.transparent_shadows = transparent_shadows;
  return Renderer(device, scene, settings).render(0, 0);
}

}  // namespace pvg::test
