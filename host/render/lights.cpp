#include "host/render/lights.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/error.hpp"
#include "host/render/alias_table.hpp"

namespace pvg {
namespace {

void store(const Vec3f& from, f32 (&to)[3]) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
}

double luminance(const Vec3f& c) { return 0.2126 * c.x() + 0.7152 * c.y() + 0.0722 * c.z(); }  // Rec. 709

void check_radiance(const std::string& name, const Vec3f& radiance) {
  if (!radiance.allFinite() || radiance.minCoeff() < 0 || radiance.maxCoeff() <= 0)
    throw UsageError("light " + name + ": radiance must be positive");
}

Light rectangle(const RectangleLight& light) {
  const Vec3 normal = light.edge_u.cross(light.edge_v);
  if (!(normal.norm() > 0) || !light.corner.allFinite())
    throw UsageError("light " + light.name + ": its edges span no area");
  check_radiance(light.name, light.radiance);
  Light l{};
  l.kind = LIGHT_RECTANGLE;
  store(light.corner.cast<float>(), l.corner);
  store(light.edge_u.cast<float>(), l.edge_u);
  store(light.edge_v.cast<float>(), l.edge_v);
  store(normal.normalized().cast<float>(), l.normal);
  store(light.radiance, l.radiance);
  l.area = float(normal.norm());
  return l;
}

bool is_spot(const SphereLight& light) { return light.outer_angle <= std::numbers::pi; }

Light sphere(const SphereLight& light) {
  if (!(light.radius > 0) || !light.center.allFinite())
    throw UsageError("light " + light.name + ": its radius must be positive");
  check_radiance(light.name, light.radiance);
  Light l{};
  l.kind = LIGHT_SPHERE;
  store(light.center.cast<float>(), l.corner);
  store(light.radiance, l.radiance);
  l.radius = float(light.radius);
  l.area = float(4 * std::numbers::pi * light.radius * light.radius);
  if (!is_spot(light)) {
    l.edge_v[0] = -2;  // below every cosine: 1 in all directions
    l.edge_v[1] = 1;
    return l;
  }
  if (!(light.inner_angle >= 0 && light.inner_angle < light.outer_angle) || !(light.direction.norm() > 0))
    throw UsageError("light " + light.name + ": its inner angle must be below its outer one, its direction no zero");
  store(light.direction.normalized().cast<float>(), l.edge_u);
  l.edge_v[0] = float(std::cos(light.outer_angle));
  l.edge_v[1] = float(1 / (std::cos(light.inner_angle) - std::cos(light.outer_angle)));
  return l;
}

Light triangle(const ShiningMesh& mesh, std::size_t i) {
  Light l{};
  l.kind = LIGHT_TRIANGLE;
  l.instance = mesh.instance;
  l.triangle = mesh.first_triangle + std::uint32_t(i);
  return l;
}

}  // namespace

LightList make_lights(const Appearance& seen, std::span<const ShiningMesh> meshes) {
  LightList list;
  std::vector<double> power;  // radiance times area, up to a factor
  for (const RectangleLight& light : seen.lights) {
    list.lights.push_back(rectangle(light));
    power.push_back(list.lights.back().area * luminance(light.radiance));
  }
  for (const SphereLight& light : seen.sphere_lights) {
    list.lights.push_back(sphere(light));
    const double share = is_spot(light) ? (1 - std::cos(light.outer_angle)) / 2 : 1;
    power.push_back(4 * std::numbers::pi * light.radius * light.radius * luminance(light.radiance) * share);
  }
  for (const ShiningMesh& mesh : meshes) {
    double sum = 0;
    for (const double area : mesh.areas) sum += 2 * area * luminance(mesh.emission);  // both sides
    list.first_of_mesh.push_back(sum > 0 ? std::int32_t(list.lights.size()) : -1);
    if (!(sum > 0)) continue;
    for (std::size_t i = 0; i < mesh.areas.size(); ++i) {
      list.lights.push_back(triangle(mesh, i));
      power.push_back(2 * mesh.areas[i] * luminance(mesh.emission));
    }
  }
  if (seen.environment_map.width > 0 && luminance(seen.environment) > 0) {
    // how far it reaches is not known: as often as all other lights together
    double others = 0;
    for (const double p : power) others += p;
    list.environment = std::int32_t(list.lights.size());
    list.lights.push_back({});
    list.lights.back().kind = LIGHT_ENVIRONMENT;
    power.push_back(others > 0 ? others : 1);
  }
  if (list.lights.empty()) return list;
  const std::vector<AliasEntry> table = alias_table(power);
  for (std::size_t i = 0; i < table.size(); ++i) {
    list.lights[i].probability = float(table[i].probability);
    list.lights[i].keep = float(table[i].keep);
    list.lights[i].other = table[i].other;
  }
  return list;
}

VisualMesh light_square() {
  VisualMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

VisualMesh light_sphere() {
  constexpr int N = 24;  // rings
  std::vector<Vec3> points;
  VisualMesh mesh;
  for (int i = 0; i <= N; ++i)
    for (int j = 0; j < 2 * N; ++j) {
      const double a = std::numbers::pi * i / N, b = std::numbers::pi * j / N;
      points.emplace_back(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), i == 0 ? 1 : i == N ? -1 : std::cos(a));
    }
  double area = 0;
  const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    mesh.triangles.push_back({p, q, r});
    area += (points[q] - points[p]).cross(points[r] - points[p]).norm() / 2;
  };
  for (std::uint32_t i = 0; i < N; ++i)
    for (std::uint32_t j = 0; j < 2 * N; ++j) {
      const std::uint32_t p = i * 2 * N + j, q = i * 2 * N + (j + 1) % (2 * N);
      if (i > 0) add(p, p + 2 * N, q);
      if (i + 1 < N) add(q, p + 2 * N, q + 2 * N);
    }
  // the mean area that a convex body shows is a quarter of its surface (Cauchy): that of the sphere
  const double scale = std::sqrt(4 * std::numbers::pi / area);
  for (const Vec3& point : points) mesh.points.push_back((scale * point).cast<float>());
  return mesh;
}

std::vector<EnvironmentCell> environment_cells(const EnvironmentMap& map) {
  if (map.width == 0) return {};
  if (map.width < 1 || map.height < 1 || map.rgb.size() != std::size_t(map.width) * map.height * 3)
    throw UsageError("the environment's picture has " + std::to_string(map.rgb.size()) + " values for " +
                     std::to_string(map.width) + " x " + std::to_string(map.height) + " pixels");
  constexpr std::size_t W = ENVIRONMENT_COLUMNS, H = ENVIRONMENT_ROWS;
  std::vector<double> power(W * H), solid_angle(H);
  double sum = 0;
  for (std::size_t k = 0; k < H; ++k) {
    solid_angle[k] = 2 * std::numbers::pi / W *
                     (std::cos(std::numbers::pi * double(k) / H) - std::cos(std::numbers::pi * double(k + 1) / H));
    for (std::size_t i = 0; i < W; ++i) {
      // every pixel that the cell touches, at least one
      const std::size_t x0 = i * map.width / W, x1 = std::max(x0 + 1, ((i + 1) * map.width + W - 1) / W);
      const std::size_t y0 = k * map.height / H, y1 = std::max(y0 + 1, ((k + 1) * map.height + H - 1) / H);
      double mean = 0;
      for (std::size_t y = y0; y < y1; ++y)
        for (std::size_t x = x0; x < x1; ++x) {
          const float* c = &map.rgb[3 * (y * map.width + x)];
          for (int n = 0; n < 3; ++n)
            if (!std::isfinite(c[n]) || c[n] < 0)
              throw UsageError("the environment's picture holds a value that is negative or not finite at pixel " +
                               std::to_string(x) + ", " + std::to_string(y));
          mean += luminance({c[0], c[1], c[2]});
        }
      power[k * W + i] = mean / double((x1 - x0) * (y1 - y0)) * solid_angle[k];
      sum += power[k * W + i];
    }
  }
  if (!(sum > 0)) sum = 1;  // all black: evenly
  // interpolation carries light over the border of a dark cell
  for (std::size_t k = 0; k < H; ++k)
    for (std::size_t i = 0; i < W; ++i) power[k * W + i] += 0.02 * sum * solid_angle[k] / (4 * std::numbers::pi);
  const std::vector<AliasEntry> table = alias_table(power);
  std::vector<EnvironmentCell> cells(W * H);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].keep = float(table[i].keep);
    cells[i].other = table[i].other;
    cells[i].density = float(table[i].probability / solid_angle[i / W]);
  }
  return cells;
}

}  // namespace pvg
