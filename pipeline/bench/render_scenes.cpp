#include "pipeline/bench/render_scenes.hpp"

#include <cmath>
#include <cstring>
#include <random>

namespace pvg {
namespace {

constexpr int WIDTH = 640, HEIGHT = 360, TILE_SIZE = 8;
constexpr float PI = float(M_PI);

// mt19937 is the same everywhere, the standard's distributions are not
struct Chance {
  std::mt19937 generator{1};
  float operator()() { return float(generator() >> 8) * 0x1p-24f; }  // [0, 1)
};

void add_quad(VisualMesh& mesh, const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
  const std::uint32_t first = std::uint32_t(mesh.points.size());
  for (const Vec3f& p : {corner, Vec3f(corner + u), Vec3f(corner + u + v), Vec3f(corner + v)}) mesh.points.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

// the six inner faces, or the six outer ones
void add_box(VisualMesh& mesh, const Vec3f& lo, const Vec3f& hi, bool is_inside) {
  const Vec3f d = hi - lo, x(d.x(), 0, 0), y(0, d.y(), 0), z(0, 0, d.z());
  const auto face = [&](const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
    is_inside ? add_quad(mesh, corner, v, u) : add_quad(mesh, corner, u, v);
  };
  face(lo, y, x);
  face(lo, x, z);
  face(lo, z, y);
  face(hi, -x, -y);
  face(hi, -z, -x);
  face(hi, -y, -z);
}

// points (i, j) of a grid of n x m cells, already in the mesh from `first` on
void add_grid_triangles(VisualMesh& mesh, std::uint32_t first, int n, int m) {
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const std::uint32_t a = first + std::uint32_t(j * (n + 1) + i), b = a + std::uint32_t(n) + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
}

void add_floor(VisualMesh& mesh, int n, Chance& chance) {
  const std::uint32_t first = std::uint32_t(mesh.points.size());
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const float x = -5 + 10 * float(i) / float(n), y = -5 + 10 * float(j) / float(n);
      mesh.points.emplace_back(x, y, 0.08f * std::sin(3 * x) * std::cos(2.5f * y) + 0.01f * chance());
    }
  add_grid_triangles(mesh, first, n, n);
}

void add_ball(VisualMesh& mesh, int n, Chance& chance) {
  const std::uint32_t first = std::uint32_t(mesh.points.size());
  const float x = -4.2f + 8.4f * chance(), y = -4.2f + 8.4f * chance(), size = chance();
  const float radius = 0.15f + 0.6f * size * size;
  const float z = 0.8f * radius + (chance() < 0.3f ? 1.5f * chance() : 0.0f);
  const float waves = 3 + std::floor(6 * chance()), phase = 2 * PI * chance();
  const int m = n / 2;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const float a = PI * float(j) / float(m), b = 2 * PI * float(i) / float(n);
      const float r = radius * (1 + 0.12f * std::sin(waves * b + phase) * std::sin(a) * std::cos(waves * a));
      mesh.points.emplace_back(x + r * std::sin(a) * std::cos(b), y + r * std::sin(a) * std::sin(b),
                               z + r * std::cos(a));
    }
  add_grid_triangles(mesh, first, n, m);
}

struct HitPoint {
  Vec3f point, normal;  // [m]; unit, toward the ray's origin
};

HitPoint hit_point(const VisualMesh& mesh, const BenchRays& rays, const F32x4& hit, std::size_t i) {
  std::uint32_t triangle;
  static_assert(sizeof triangle == sizeof hit.v[3]);
  std::memcpy(&triangle, &hit.v[3], sizeof triangle);
  const Triangle& t = mesh.triangles.at(triangle);
  const Vec3f p = mesh.points[t[0]], d = Eigen::Map<const Vec3f>(rays.direction[i].v);
  Vec3f normal = (mesh.points[t[1]] - p).cross(mesh.points[t[2]] - p).normalized();
  if (normal.dot(d) > 0) normal = -normal;
  return {Eigen::Map<const Vec3f>(rays.origin[i].v) + hit.v[0] * d + 1e-3f * normal, normal};
}

bool is_hit(const F32x4& hit) { return std::isfinite(hit.v[0]); }

void add_ray(BenchRays& rays, const Vec3f& origin, const Vec3f& direction) {
  rays.origin.push_back({{origin.x(), origin.y(), origin.z(), 0}});
  rays.direction.push_back({{direction.x(), direction.y(), direction.z(), 0}});
}

Camera bench_camera(const Vec3& eye, const Vec3& at, double horizontal_field_of_view) {
  Camera camera;
  camera.name = "bench";
  camera.width = WIDTH;
  camera.height = HEIGHT;
  camera.fx = camera.fy = 0.5 * WIDTH / std::tan(0.5 * horizontal_field_of_view);
  camera.cx = 0.5 * (WIDTH - 1);
  camera.cy = 0.5 * (HEIGHT - 1);
  const Vec3 z = (at - eye).normalized(), x = z.cross(Vec3::UnitZ()).normalized();
  camera.pose.linear() << x, z.cross(x), z;
  camera.pose.translation() = eye;
  return camera;
}

void add_visual(Scene& scene, const std::string& name, VisualMesh mesh, VisualMaterial material) {
  material.name = name;
  Visual visual;
  visual.name = name;
  visual.mesh = int(scene.visual_meshes.size());
  visual.material = int(scene.materials.size());
  scene.visual_meshes.push_back(std::move(mesh));
  scene.materials.push_back(std::move(material));
  scene.visuals.push_back(visual);
}

void add_diffuse(Scene& scene, const std::string& name, VisualMesh mesh, const Vec3f& color) {
  VisualMaterial material;
  material.color = color;
  add_visual(scene, name, std::move(mesh), material);
}

VisualMesh one_quad(const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
  VisualMesh mesh;
  add_quad(mesh, corner, u, v);
  return mesh;
}

VisualMesh turned_block(const Vec3f& size, float angle, const Vec3f& at) {
  VisualMesh mesh;
  add_box(mesh, Vec3f(-0.5f * size.x(), -0.5f * size.y(), 0), Vec3f(0.5f * size.x(), 0.5f * size.y(), size.z()), false);
  const Eigen::AngleAxisf turn(angle, Vec3f::UnitZ());
  for (Vec3f& p : mesh.points) p = turn * p + at;
  return mesh;
}

// 64 x 32 cells, smooth normals
VisualMesh ball(float radius, const Vec3f& at) {
  VisualMesh mesh;
  for (int j = 0; j <= 32; ++j)
    for (int i = 0; i <= 64; ++i) {
      const float a = PI * float(j) / 32, b = 2 * PI * float(i) / 64;
      mesh.normals.emplace_back(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      mesh.points.push_back(at + radius * mesh.normals.back());
    }
  add_grid_triangles(mesh, 0, 64, 32);
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);  // outward: i runs around z, j down
  return mesh;
}

}  // namespace

VisualMesh bench_room(std::size_t n) {
  Chance chance;
  VisualMesh mesh;
  add_box(mesh, Vec3f(-5, -5, -0.5f), Vec3f(5, 5, 4), true);
  add_floor(mesh, int(std::sqrt(0.1 * double(n))), chance);
  const int ball_cells = 2 * int(0.5 * std::sqrt(0.8 * double(n) / 60));
  for (int i = 0; i < 60; ++i) add_ball(mesh, ball_cells, chance);
  return mesh;
}

BenchRays primary_rays(int samples) {
  Chance chance;
  const Camera camera = bench_camera(Vec3(-4.3, -4.0, 2.2), Vec3(0.5, 0.6, 0.4), 91.5 * M_PI / 180);
  const Vec3f eye = camera.pose.translation().cast<float>();
  BenchRays rays;
  for (int tile = 0; tile < WIDTH / TILE_SIZE * (HEIGHT / TILE_SIZE); ++tile)
    for (int in_tile = 0; in_tile < TILE_SIZE * TILE_SIZE; ++in_tile)
      for (int sample = 0; sample < samples; ++sample) {
        const int x = tile % (WIDTH / TILE_SIZE) * TILE_SIZE + in_tile % TILE_SIZE;
        const int y = tile / (WIDTH / TILE_SIZE) * TILE_SIZE + in_tile / TILE_SIZE;
        const double px = x - 0.5 + chance(), py = y - 0.5 + chance();
        const Vec3 d((px - camera.cx) / camera.fx, (py - camera.cy) / camera.fy, 1);
        add_ray(rays, eye, (camera.pose.linear() * d.normalized()).cast<float>());
      }
  return rays;
}

BenchRays diffuse_rays(const VisualMesh& mesh, const BenchRays& primary, const std::vector<F32x4>& hit) {
  Chance chance;
  BenchRays rays;
  for (std::size_t i = 0; i < primary.size(); ++i) {
    if (!is_hit(hit[i])) continue;
    const HitPoint from = hit_point(mesh, primary, hit[i], i);
    const float r2 = chance(), r = std::sqrt(r2), angle = 2 * PI * chance();
    const Vec3f x = from.normal.unitOrthogonal(), y = from.normal.cross(x);
    add_ray(rays, from.point,
            r * std::cos(angle) * x + r * std::sin(angle) * y + std::sqrt(std::max(0.0f, 1 - r2)) * from.normal);
  }
  return rays;
}

BenchRays shadow_rays(const VisualMesh& mesh, const BenchRays& primary, const std::vector<F32x4>& hit) {
  Chance chance;
  BenchRays rays;
  for (std::size_t i = 0; i < primary.size(); ++i) {
    if (!is_hit(hit[i])) continue;
    const HitPoint from = hit_point(mesh, primary, hit[i], i);
    const float x = -2 + 4 * chance(), y = -2 + 4 * chance();
    add_ray(rays, from.point, Vec3f(x, y, 3.9f) - from.point);
  }
  return rays;
}

Scene cornell_glass() {
  const Vec3f white(0.73f, 0.73f, 0.73f), red(0.65f, 0.05f, 0.05f), green(0.12f, 0.45f, 0.15f);
  const Vec3f x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
  Scene scene;
  scene.name = "cornell_glass";
  add_diffuse(scene, "floor", one_quad({-1, -1, 0}, x, y), white);
  add_diffuse(scene, "ceiling", one_quad({-1, -1, 2}, y, x), white);
  add_diffuse(scene, "back", one_quad({-1, 1, 0}, x, z), white);
  add_diffuse(scene, "left", one_quad({-1, -1, 0}, y, z), red);
  add_diffuse(scene, "right", one_quad({1, -1, 0}, z, y), green);
  add_diffuse(scene, "block", turned_block({0.6f, 0.6f, 1.2f}, 0.3f, {-0.35f, 0.3f, 0}), white);
  VisualMaterial glass;
  glass.kind = VisualMaterial::Kind::dielectric;
  glass.color = Vec3f::Ones();
  add_visual(scene, "glass", ball(0.3f, {0.4f, -0.2f, 0.3f}), glass);
  scene.lights.push_back(
      {"light", Vec3(-0.25, -0.25, 1.99), Vec3(0, 0.5, 0), Vec3(0.5, 0, 0), Vec3f(15, 13.5f, 10.5f)});
  scene.cameras.push_back(bench_camera(Vec3(0, -3.9, 1), Vec3(0, 0, 1), 39 * M_PI / 180));
  return scene;
}

Scene textured_room(std::size_t n) {
  constexpr int SIZE = 4096;
  Scene scene;
  scene.name = "textured_room";
  VisualMesh mesh = bench_room(n);
  for (const Vec3f& p : mesh.points) mesh.uvs.emplace_back(0.1f * p.x(), 0.1f * p.y() + 0.2f * p.z());
  add_diffuse(scene, "room", std::move(mesh), Vec3f::Ones());
  scene.materials.back().texture = 0;
  Texture texture;
  texture.width = texture.height = SIZE;
  texture.rgba.resize(4 * std::size_t(SIZE) * SIZE, 255);
  for (std::size_t i = 0; i < texture.rgba.size(); i += 4)
    for (int c = 0; c < 3; ++c) texture.rgba[i + c] = std::uint8_t(60 + (i / 4 * (7 + c) + i / 4 / SIZE * 13) % 180);
  scene.textures.push_back(std::move(texture));
  scene.lights.push_back({"light", Vec3(-2, -2, 3.9), Vec3(0, 4, 0), Vec3(4, 0, 0), Vec3f(2, 2, 2)});
  scene.cameras.push_back(bench_camera(Vec3(-4.3, -4.0, 2.2), Vec3(0.5, 0.6, 0.4), 91.5 * M_PI / 180));
  return scene;
}

}  // namespace pvg
