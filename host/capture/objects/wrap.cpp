#include "host/capture/objects/wrap.hpp"

#include <meshoptimizer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "host/base/error.hpp"
#include "host/capture/fusion.hpp"
#include "host/capture/objects/edge_collapse.hpp"
#include "host/capture/objects/surface_distance.hpp"
#include "host/capture/surface.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/mesh_checks.hpp"
#include "host/geometry/segment_distance.hpp"

namespace pvg {
namespace {

constexpr double MOST_SAMPLES = 4e7;
constexpr float FAR = 1e30f;

struct Samples {
  Vec3 origin;
  double spacing = 0;
  std::array<int, 3> n;
  std::vector<float> distance;  // [n[0] n[1] n[2]] to the triangles, not signed; FAR: beyond the band [m]
  std::size_t index(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(n[1]) + std::size_t(y)) * std::size_t(n[0]) + std::size_t(x);
  }
  Vec3 place(int x, int y, int z) const { return origin + spacing * Vec3(x, y, z); }
};

Samples make_samples(const TriangleMesh& soup, const WrapSettings& s) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t corner : t) {
      if (!soup.points[corner].allFinite()) throw UsageError("a point of the mesh is not finite; export it again");
      low = low.cwiseMin(soup.points[corner]);
      high = high.cwiseMax(soup.points[corner]);
    }
  Samples out;
  out.spacing = s.spacing;
  const double margin = 2 * s.bridge + 3 * s.spacing;
  double n = 1;
  // a shift that no coordinate of a modelled part shares, so that samples do not fall onto its faces
  out.origin = low - Vec3::Constant(margin) + s.spacing * Vec3(0.127, 0.311, 0.439);
  for (int axis = 0; axis < 3; ++axis) {
    const double count = std::ceil((high[axis] - low[axis] + 2 * margin) / s.spacing) + 1;
    n *= count;
    out.n[std::size_t(axis)] = int(std::min(count, 1e6));
  }
  if (n > MOST_SAMPLES)
    throw UsageError("samples of " + std::to_string(s.spacing * 1e3) +
                     " mm are too fine for this size; take --detail " +
                     std::to_string(s.spacing * std::cbrt(n / MOST_SAMPLES) * 1.02e3));
  out.distance.assign(std::size_t(n), FAR);
  return out;
}

// exact in a band of this width around every triangle
void add_distances(const TriangleMesh& soup, double band, Samples& samples) {
  for (const Triangle& t : soup.triangles) {
    const Vec3 &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
    std::array<int, 3> first, last;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = std::min({a[axis], b[axis], c[axis]}) - band - samples.origin[axis];
      const double high = std::max({a[axis], b[axis], c[axis]}) + band - samples.origin[axis];
      first[std::size_t(axis)] = std::max(0, int(std::ceil(low / samples.spacing)));
      last[std::size_t(axis)] = std::min(samples.n[std::size_t(axis)] - 1, int(std::floor(high / samples.spacing)));
    }
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y)
        for (int x = first[0]; x <= last[0]; ++x) {
          const double d = point_triangle_distance(samples.place(x, y, z), a, b, c);
          float& kept = samples.distance[samples.index(x, y, z)];
          if (d <= band) kept = std::min(kept, float(d));
        }
  }
}

constexpr int STEPS[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

// where the middle of a ball of this radius gets from the border
std::vector<bool> reached(const Samples& s, double radius) {
  std::vector<bool> is_reached(s.distance.size(), false);
  std::vector<std::array<int, 3>> open = {{0, 0, 0}};
  is_reached[0] = true;
  while (!open.empty()) {
    const std::array<int, 3> at = open.back();
    open.pop_back();
    for (const auto& step : STEPS) {
      std::array<int, 3> next;
      bool is_in = true;
      for (std::size_t k = 0; k < 3; ++k) {
        next[k] = at[k] + step[k];
        is_in = is_in && next[k] >= 0 && next[k] < s.n[k];
      }
      if (!is_in) continue;
      const std::size_t i = s.index(next[0], next[1], next[2]);
      if (is_reached[i] || s.distance[i] <= float(radius)) continue;
      is_reached[i] = true;
      open.push_back(next);
    }
  }
  return is_reached;
}

// Samples within `radius` of a marked one: an exact pass along each axis (lower envelope of parabolas, Felzenszwalb and
// Huttenlocher 2012).
void squared_distance_along(std::vector<float>& line) {
  const int n = int(line.size());
  std::vector<int> v(std::size_t(n), 0);
  std::vector<float> z(std::size_t(n) + 1), out(line.size());
  int k = 0;
  z[0] = -FAR;
  z[1] = FAR;
  for (int q = 1; q < n; ++q) {
    const auto meet = [&](int p) {
      return ((line[std::size_t(q)] + float(q * q)) - (line[std::size_t(p)] + float(p * p))) / float(2 * q - 2 * p);
    };
    float s = meet(v[std::size_t(k)]);
    while (k > 0 && s <= z[std::size_t(k)]) s = meet(v[std::size_t(--k)]);
    ++k;
    v[std::size_t(k)] = q;
    z[std::size_t(k)] = s;
    z[std::size_t(k) + 1] = FAR;
  }
  k = 0;
  for (int q = 0; q < n; ++q) {
    while (z[std::size_t(k) + 1] < float(q)) ++k;
    const int p = v[std::size_t(k)];
    out[std::size_t(q)] = float((q - p) * (q - p)) + line[std::size_t(p)];
  }
  line.swap(out);
}

std::vector<float> distance_to_marked(const Samples& s, const std::vector<bool>& marked) {
  constexpr float NEVER = 1e8f;  // squared, in spacings
  std::vector<float> d(marked.size());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = marked[i] ? 0 : NEVER;
  const std::size_t stride[3] = {1, std::size_t(s.n[0]), std::size_t(s.n[0]) * std::size_t(s.n[1])};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t length = std::size_t(s.n[axis]);
    std::vector<float> line(length);
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (i / stride[axis] % length != 0) continue;
      for (std::size_t k = 0; k < length; ++k) line[k] = d[i + k * stride[axis]];
      squared_distance_along(line);
      for (std::size_t k = 0; k < length; ++k) d[i + k * stride[axis]] = line[k];
    }
  }
  for (float& x : d) x = std::sqrt(x) * float(s.spacing);
  return d;
}

// Does an edge of one triangle meet the other one, with which it shares no point?
bool meet(const std::vector<Vec3>& points, const Triangle& a, const Triangle& b) {
  const auto pierces = [&](const Triangle& by, const Triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = by[k], to = by[(k + 1) % 3];
      const bool shares = std::any_of(t.begin(), t.end(), [&](std::uint32_t c) { return c == from || c == to; });
      if (!shares && intersects(points[from], points[to], points[t[0]], points[t[1]], points[t[2]])) return true;
    }
    return false;
  };
  return pierces(a, b) || pierces(b, a);
}

// Where two sheets pass through one cell, or its loop is long, triangles of the cell may meet though every point is on
// its own edge. With all points in the middles of their edges no case of marching cubes has such a pair (a test), so
// the points of such a cell go half of the way there, and again, until none is left.
// begin: [n_cells + 1] first triangle of each cell that has some; middle: [n_points] of the point's edge
void separate_within_cells(const std::vector<std::size_t>& begin, const std::vector<Vec3>& middle, TriangleMesh& mesh) {
  std::vector<bool> moves(mesh.points.size(), true);
  while (std::find(moves.begin(), moves.end(), true) != moves.end()) {
    moves.assign(moves.size(), false);
    for (std::size_t cell = 0; cell + 1 < begin.size(); ++cell) {
      bool is_crossed = false;
      for (std::size_t i = begin[cell]; i < begin[cell + 1] && !is_crossed; ++i)
        for (std::size_t k = i + 1; k < begin[cell + 1] && !is_crossed; ++k)
          is_crossed = meet(mesh.points, mesh.triangles[i], mesh.triangles[k]);
      for (std::size_t i = begin[cell]; i < begin[cell + 1] && is_crossed; ++i)
        for (const std::uint32_t corner : mesh.triangles[i]) moves[corner] = true;
    }
    for (std::size_t i = 0; i < moves.size(); ++i)
      if (moves[i]) mesh.points[i] = 0.5 * (mesh.points[i] + middle[i]);
  }
}

TriangleMesh surface_of(const Samples& s, const std::vector<float>& field) {
  static const std::vector<std::uint8_t> CASES = marching_cubes_cases();
  TriangleMesh mesh;
  std::vector<Vec3> middle;                                // of the edges that the points are on
  std::vector<std::size_t> begin;                          // of each cell's triangles
  std::vector<std::uint32_t> vertex(3 * field.size(), 0);  // 1 + number, by sample and axis
  const auto vertex_at = [&](int x, int y, int z, int axis) {
    const std::size_t i = s.index(x, y, z);
    std::uint32_t& known = vertex[3 * i + std::size_t(axis)];
    if (known == 0) {
      const std::size_t j = s.index(x + (axis == 0), y + (axis == 1), z + (axis == 2));
      // kept off the samples, so that no triangle loses its area
      const double share = std::clamp(double(field[i]) / (double(field[i]) - double(field[j])), 0.02, 0.98);
      const Vec3 edge = s.spacing * Vec3(axis == 0, axis == 1, axis == 2);
      mesh.points.push_back(s.place(x, y, z) + share * edge);
      middle.push_back(s.place(x, y, z) + 0.5 * edge);
      known = std::uint32_t(mesh.points.size());
    }
    return known - 1;
  };
  for (int z = 0; z + 1 < s.n[2]; ++z)
    for (int y = 0; y + 1 < s.n[1]; ++y)
      for (int x = 0; x + 1 < s.n[0]; ++x) {
        unsigned inside = 0;
        for (int k = 0; k < 8; ++k)
          if (field[s.index(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] < 0) inside |= 1u << k;
        const std::uint8_t* row = &CASES[inside * 16];
        if (row[0] != 255) begin.push_back(mesh.triangles.size());
        for (int k = 0; k < 15 && row[k] != 255; k += 3) {
          Triangle t;
          for (int c = 0; c < 3; ++c) {
            const int axis = row[k + c] / 4, low = row[k + c] & 1, high = row[k + c] >> 1 & 1;
            t[std::size_t(c)] = vertex_at(x + (axis == 0 ? 0 : low),
                                          y + (axis == 0   ? low
                                               : axis == 1 ? 0
                                                           : high),
                                          z + (axis == 2 ? 0 : high), axis);
          }
          mesh.triangles.push_back(t);
        }
      }
  begin.push_back(mesh.triangles.size());
  separate_within_cells(begin, middle, mesh);
  return mesh;
}

}  // namespace

TriangleMesh wrap_surface(const TriangleMesh& soup, WrapSettings settings) {
  if (soup.triangles.empty()) throw UsageError("the mesh has no triangles");
  if (settings.spacing <= 0) {
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (const Triangle& t : soup.triangles)
      for (const std::uint32_t corner : t) {
        low = low.cwiseMin(soup.points[corner]);
        high = high.cwiseMax(soup.points[corner]);
      }
    settings.spacing = (high - low).maxCoeff() / 100;
    if (!(settings.spacing > 0 && std::isfinite(settings.spacing)))
      throw UsageError("the mesh has no size, or points that are not finite; export it again");
  }
  // less would let samples beyond the surface count as outside, and lose sheets
  settings.offset = std::max(settings.offset, 0.6 * settings.spacing);
  if (settings.bridge <= 0) settings.bridge = 4 * settings.spacing;
  settings.bridge = std::max(settings.bridge, settings.offset + settings.spacing);
  Samples samples = make_samples(soup, settings);
  add_distances(soup, settings.bridge, samples);
  const std::vector<float> to_core = distance_to_marked(samples, reached(samples, settings.bridge));
  std::vector<float> field(samples.distance.size());
  const double reach = settings.bridge - settings.offset + settings.spacing;  // its middle is known to a sample
  for (std::size_t i = 0; i < field.size(); ++i) {
    const float d = std::min(samples.distance[i], float(settings.bridge)), offset = float(settings.offset);
    const float outside = float(reach) - to_core[i];  // positive where the ball reaches, grown back
    field[i] = outside >= 0 ? std::min(d - offset, outside) : -d - offset;
  }
  return surface_of(samples, field);
}

namespace {

struct Part {
  std::vector<Triangle> triangles;
  Eigen::AlignedBox3d box;
};

// How often the part's surface goes around the point: the sum of its triangles' solid angles (Van Oosterom and Strackee
// 1983) over 4 pi.
double winding_number(const TriangleMesh& mesh, const Part& part, const Vec3& p) {
  double sum = 0;
  for (const Triangle& t : part.triangles) {
    const Vec3 a = mesh.points[t[0]] - p, b = mesh.points[t[1]] - p, c = mesh.points[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * 3.14159265358979);
}

// Is a part within another one? Both face outward, so that its volume would count twice.
bool has_nested_part(const TriangleMesh& mesh) {
  const std::vector<int> component = triangle_components(mesh);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < component.size(); ++i) {
    if (std::size_t(component[i]) >= parts.size()) parts.resize(std::size_t(component[i]) + 1);
    Part& part = parts[std::size_t(component[i])];
    part.triangles.push_back(mesh.triangles[i]);
    for (const std::uint32_t corner : mesh.triangles[i]) part.box.extend(mesh.points[corner]);
  }
  for (const Part& inner : parts)
    for (const Part& outer : parts)
      if (&inner != &outer && outer.box.contains(inner.box) &&
          winding_number(mesh, outer, mesh.points[inner.triangles[0][0]]) > 0.5)
        return true;
  return false;
}

}  // namespace

bool is_sound(const TriangleMesh& mesh) {
  // a doubled surface is closed and touches itself only where it shares points, which find_intersection leaves out
  return !closed_surface_defect(mesh) && count_edges(mesh.triangles).crowded == 0 &&
         !find_intersection(mesh.points, mesh.triangles) && !has_nested_part(mesh);
}

namespace {

constexpr std::size_t FEW = 20000;     // triangles from which edges are collapsed one by one
constexpr std::size_t REDUCTION = 16;  // of the last step, at least

// meshoptimizer's result where it is sound and half of the error is left; it checks neither intersections nor
// distances, and is fast
std::optional<TriangleMesh> reduced(const TriangleMesh& mesh, std::size_t n_triangles, double error) {
  std::vector<float> points;
  for (const Vec3& p : mesh.points)
    for (int k = 0; k < 3; ++k) points.push_back(float(p[k]));
  std::vector<unsigned> indices;
  for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  const float scale = meshopt_simplifyScale(points.data(), mesh.points.size(), 12);
  std::vector<unsigned> fewer(indices.size());
  fewer.resize(meshopt_simplify(fewer.data(), indices.data(), indices.size(), points.data(), mesh.points.size(), 12,
                                3 * n_triangles, float(error) / scale, 0, nullptr));
  TriangleMesh out;
  std::vector<std::uint32_t> number(mesh.points.size(), 0);  // 1 + of the new mesh
  for (std::size_t i = 0; i + 2 < fewer.size(); i += 3) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& n = number[fewer[i + k]];
      if (n == 0) {
        out.points.push_back(mesh.points[fewer[i + k]]);
        n = std::uint32_t(out.points.size());
      }
      t[k] = n - 1;
    }
    out.triangles.push_back(t);
  }
  if (out.triangles.size() < 4 || !is_sound(out)) return {};
  return out;
}

}  // namespace

SimplifiedSolid simplified_solid(const TriangleMesh& mesh, std::size_t n_triangles, double error,
                                 const SourceBound& source, double least_shape) {
  SimplifiedSolid out{mesh, {0}, {0}};
  if (mesh.triangles.size() <= n_triangles) return out;
  const std::size_t first = std::max(FEW, REDUCTION * n_triangles);
  constexpr double FIRST_SHARE = 0.25;  // of the error, for the fast step
  std::optional<TriangleMesh> fewer;
  if (mesh.triangles.size() > 2 * first) fewer = reduced(mesh, first, FIRST_SHARE * error);
  // While edges collapse, points and middles alone are held to the distance, and of the fast step nothing is known: the
  // result is measured, and where it is too far off less is tried.
  const NearestTriangle original(mesh);
  for (const double share : {1.0, 0.7, 0.4, 0.2}) {
    const SourceBound held{source.surface, source.own + share * (source.most - source.own), source.own};
    out.mesh = fewer ? collapse_edges(*fewer, n_triangles, (1 - FIRST_SHARE) * share * error, held, least_shape)
                     : collapse_edges(mesh, n_triangles, share * error, held, least_shape);
    fewer.reset();
    out.to_original = surface_distances(out.mesh, original);
    if (out.to_original.back() > error) continue;
    if (source.surface && surface_distances(out.mesh, *source.surface).back() > source.most) continue;
    out.from_original = surface_distances(mesh, out.mesh);
    if (out.from_original.back() <= error && is_sound(out.mesh)) return out;
  }
  return {mesh, {0}, {0}};
}

}  // namespace pvg
