#include "host/capture/objects/edge_collapse.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>

#include "host/geometry/exact_intersection.hpp"
#include "host/geometry/segment_distance.hpp"

namespace pvg {
namespace {

using TriangleBox = Eigen::AlignedBox3d;
using Indices = std::vector<std::uint32_t>;

constexpr double LEAST_TURN = 0.2;          // cosine between a triangle's normals before and after
constexpr double LENGTH_SHARE = 1e-5;       // of an edge's squared length in its cost, so that flat parts stay regular
constexpr double LEAST_DETERMINANT = 1e-6;  // of a quadric whose minimum is taken, relative to its size

struct Quadric {  // v -> v'Av - 2 b'v + c, the weighted sum of squared distances to planes
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0;
  void add_plane(const Vec3& n, double offset, double weight) {
    A += weight * n * n.transpose();
    b += weight * offset * n;
    c += weight * offset * offset;
  }
  Quadric operator+(const Quadric& o) const { return {A + o.A, b + o.b, c + o.c}; }
  double at(const Vec3& v) const { return v.dot(A * v) - 2 * b.dot(v) + c; }
};

// Triangles by the cells that their boxes touch.
class Grid {
 public:
  Grid(const Vec3& origin, double cell) : origin_(origin), cell_(cell) {}
  void insert(std::uint32_t t, const TriangleBox& box) {
    each(box, [&](std::uint64_t key) { cells_[key].push_back(t); });
  }
  void remove(std::uint32_t t, const TriangleBox& box) {
    each(box, [&](std::uint64_t key) {
      Indices& in = cells_[key];
      const auto at = std::find(in.begin(), in.end(), t);
      *at = in.back();
      in.pop_back();
    });
  }
  // those that may touch the box; some more than once
  void find(const TriangleBox& box, Indices& out) const {
    out.clear();
    each(box, [&](std::uint64_t key) {
      if (const auto cell = cells_.find(key); cell != cells_.end())
        out.insert(out.end(), cell->second.begin(), cell->second.end());
    });
  }

 private:
  template <class Visit>
  void each(const TriangleBox& box, const Visit& visit) const {
    std::int64_t low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = std::int64_t(std::floor((box.min()[k] - origin_[k]) / cell_)) + (1 << 20);
      high[k] = std::int64_t(std::floor((box.max()[k] - origin_[k]) / cell_)) + (1 << 20);
    }
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x)
          visit(std::uint64_t(z) << 42 | std::uint64_t(y) << 21 | std::uint64_t(x));
  }
  Vec3 origin_;
  double cell_;
  std::unordered_map<std::uint64_t, Indices> cells_;
};

struct Entry {  // of the queue; holds while both ends are as they were
  double cost;
  std::uint32_t a, b, version_a, version_b;
  bool operator<(const Entry& o) const {  // the cheapest comes first, ties by index
    return std::tie(cost, a, b) > std::tie(o.cost, o.a, o.b);
  }
};

class Collapser {
 public:
  Collapser(const TriangleMesh& mesh, std::size_t n_wanted, double error, const SourceBound& source, double least_shape)
      : points_(mesh.points),
        triangles_(mesh.triangles),
        original_(mesh),
        error_(error),
        least_shape_(least_shape),
        source_(source),
        grid_(Vec3::Zero(), 1) {
    const std::size_t n = points_.size();
    of_vertex_.resize(n);
    quadric_.resize(n);
    version_.assign(n, 0);
    is_alive_.assign(triangles_.size(), true);
    sites_.resize(triangles_.size());
    double area = 0;
    TriangleBox all;
    for (const Vec3& p : points_) all.extend(p);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Vec3 normal = normal_of(corners(triangles_[t]));  // twice the area long
      const double twice = normal.norm();
      area += twice / 2;
      for (const std::uint32_t v : triangles_[t]) {
        of_vertex_[v].push_back(t);
        quadric_[v].add_plane(normal / twice, normal.dot(points_[triangles_[t][0]]) / twice, twice);
      }
    }
    // between the edges of now and those of the end
    const double edge_now = std::sqrt(area / double(triangles_.size())),
                 edge_then = std::sqrt(area / double(std::max<std::size_t>(n_wanted, 4)));
    const double least_cell = all.sizes().maxCoeff() / double(1 << 19);
    grid_ = Grid(all.min(), std::max(2 * std::sqrt(edge_now * std::max(edge_now, edge_then)), least_cell));
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) grid_.insert(t, box_of(corners(triangles_[t])));
    for (std::uint32_t v = 0; v < n; ++v)
      if (!of_vertex_[v].empty()) sites_[of_vertex_[v][0]].push_back(v);
  }

  TriangleMesh run(std::size_t n_wanted) {
    std::size_t n_alive = triangles_.size();
    for (const Triangle& t : triangles_)
      for (int k = 0; k < 3; ++k)
        if (t[k] < t[(k + 1) % 3]) push(t[k], t[(k + 1) % 3]);
    while (n_alive > std::max<std::size_t>(n_wanted, 4) && !queue_.empty()) {
      const Entry e = queue_.top();
      queue_.pop();
      if (version_[e.a] != e.version_a || version_[e.b] != e.version_b) continue;
      if (collapse(e.a, e.b)) n_alive -= 2;
    }
    TriangleMesh out;
    std::vector<std::uint32_t> number(points_.size(), 0);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!is_alive_[t]) continue;
      Triangle kept;
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& n = number[triangles_[t][k]];
        if (n == 0) {
          out.points.push_back(points_[triangles_[t][k]]);
          n = std::uint32_t(out.points.size());
        }
        kept[k] = n - 1;
      }
      out.triangles.push_back(kept);
    }
    return out;
  }

 private:
  using Corners = std::array<Vec3, 3>;
  Corners corners(const Triangle& t) const { return {points_[t[0]], points_[t[1]], points_[t[2]]}; }
  static Vec3 normal_of(const Corners& c) { return (c[1] - c[0]).cross(c[2] - c[0]); }
  static TriangleBox box_of(const Corners& c) {
    TriangleBox box(c[0]);
    box.extend(c[1]);
    box.extend(c[2]);
    return box;
  }

  // the cheapest of the quadric's minimum, the middle and the two ends
  Vec3 best_place(std::uint32_t a, std::uint32_t b, double& cost) const {
    const Quadric q = quadric_[a] + quadric_[b];
    const double size = q.A.norm(), length = (points_[a] - points_[b]).squaredNorm();
    Vec3 best = 0.5 * (points_[a] + points_[b]);
    double least = q.at(best);
    const auto offer = [&](const Vec3& p) {
      if (q.at(p) < least) {
        least = q.at(p);
        best = p;
      }
    };
    offer(points_[a]);
    offer(points_[b]);
    if (std::abs(q.A.determinant()) > LEAST_DETERMINANT * size * size * size) {
      const Vec3 p = q.A.inverse() * q.b;
      if ((p - points_[a]).squaredNorm() < 4 * length) offer(p);
    }
    cost = std::max(least, 0.0) + LENGTH_SHARE * size * length;
    return best;
  }

  void push(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    double cost = 0;
    best_place(a, b, cost);
    queue_.push({cost, a, b, version_[a], version_[b]});
  }

  Indices neighbours(std::uint32_t v) const {
    Indices out;
    for (const std::uint32_t t : of_vertex_[v])
      for (const std::uint32_t w : triangles_[t])
        if (w != v) out.push_back(w);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  bool keeps_link(std::uint32_t a, std::uint32_t b) const {
    const Indices of_a = neighbours(a), of_b = neighbours(b);
    Indices both, all;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(both));
    std::set_union(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(all));
    return both.size() == 2 && all.size() > 4;  // four with a and b: a tetrahedron
  }

  struct Changed {
    std::uint32_t index;
    Triangle vertices;
    Corners corners;
  };

  static bool meet(const Triangle& s, const Corners& p, const Triangle& t, const Corners& q) {
    const auto edge_meets = [](const Triangle& s2, const Corners& p2, const Triangle& t2, const Corners& q2) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = s2[k], j = s2[(k + 1) % 3];
        if (std::any_of(t2.begin(), t2.end(), [&](std::uint32_t c) { return c == i || c == j; })) continue;
        if (intersects(p2[k], p2[(k + 1) % 3], q2[0], q2[1], q2[2])) return true;
      }
      return false;
    };
    return edge_meets(s, p, t, q) || edge_meets(t, q, s, p);
  }

  static double shape_of(const Corners& c) {
    return normal_of(c).norm() /
           std::max({(c[0] - c[1]).squaredNorm(), (c[1] - c[2]).squaredNorm(), (c[2] - c[0]).squaredNorm()});
  }

  bool keeps_shape(const std::vector<Changed>& changed, const Indices& star) const {
    double least = least_shape_;
    for (const std::uint32_t t : star) least = std::min(least, shape_of(corners(triangles_[t])));
    least = std::max(least, NEEDLE);
    for (const Changed& c : changed) {
      const Vec3 before = normal_of(corners(triangles_[c.index])), after = normal_of(c.corners);
      if (!(shape_of(c.corners) > least)) return false;
      if (!(before.dot(after) > LEAST_TURN * before.norm() * after.norm())) return false;
    }
    return true;
  }

  // on_original: a point of the original, whose distance is a bound that needs no search
  bool is_near(const Vec3& p, const Vec3& on_original) const {
    const double bound = (p - on_original).norm();
    return (bound <= error_ || original_.is_within(p, error_)) &&
           (!source_.surface || bound + source_.own <= source_.most || source_.surface->is_within(p, source_.most));
  }

  // The place, the new triangles' middles and those of their edges at the place; the other edges are as they were.
  bool stays_near(const std::vector<Changed>& changed, std::uint32_t a, const Vec3& place) const {
    const Vec3& on_original = original_.mesh().points[a];
    if (!is_near(place, on_original)) return false;
    for (const Changed& c : changed) {
      if (!is_near((c.corners[0] + c.corners[1] + c.corners[2]) / 3, on_original)) return false;
      for (std::size_t k = 0; k < 3; ++k)
        if (c.vertices[k] == a && !is_near(0.5 * (place + c.corners[(k + 1) % 3]), on_original)) return false;
    }
    return true;
  }

  bool meets_others(const std::vector<Changed>& changed, const Indices& star) {
    for (std::size_t i = 0; i < changed.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (meet(changed[i].vertices, changed[i].corners, changed[j].vertices, changed[j].corners)) return true;
    TriangleBox all;
    for (const Changed& c : changed) all.extend(box_of(c.corners));
    grid_.find(all, found_);
    for (const std::uint32_t t : found_) {
      const Corners other = corners(triangles_[t]);
      const TriangleBox box = box_of(other);
      if (!box.intersects(all) || std::binary_search(star.begin(), star.end(), t)) continue;
      for (const Changed& c : changed)
        if (box_of(c.corners).intersects(box) && meet(c.vertices, c.corners, triangles_[t], other)) return true;
    }
    return false;
  }

  // The original's points that the star stood for go to the nearest triangle of the new one; false: one is too far.
  bool hand_over_sites(const std::vector<Changed>& changed, const Indices& star, std::vector<Indices>& sites) const {
    sites.assign(changed.size(), {});
    for (const std::uint32_t t : star)
      for (const std::uint32_t site : sites_[t]) {
        const Vec3& p = original_.mesh().points[site];
        double least = INFINITY;
        std::size_t nearest = 0;
        for (std::size_t i = 0; i < changed.size(); ++i) {
          const Corners& c = changed[i].corners;
          const double d = point_triangle_distance(p, c[0], c[1], c[2]);
          if (d < least) {
            least = d;
            nearest = i;
          }
        }
        if (least > error_) return false;
        sites[nearest].push_back(site);
      }
    return true;
  }

  bool collapse(std::uint32_t a, std::uint32_t b) {
    if (!keeps_link(a, b)) return false;
    double cost = 0;
    const Vec3 place = best_place(a, b, cost);
    Indices star = of_vertex_[a];
    star.insert(star.end(), of_vertex_[b].begin(), of_vertex_[b].end());
    std::sort(star.begin(), star.end());
    star.erase(std::unique(star.begin(), star.end()), star.end());
    std::vector<Changed> changed;
    for (const std::uint32_t t : star) {
      Triangle v = triangles_[t];
      int n_ends = 0;
      for (std::uint32_t& c : v) {
        n_ends += c == a || c == b;
        if (c == b) c = a;
      }
      if (n_ends == 2) continue;
      Changed c{t, v, corners(v)};
      for (std::size_t k = 0; k < 3; ++k)
        if (v[k] == a) c.corners[k] = place;
      changed.push_back(c);
    }
    std::vector<Indices> sites;
    if (!keeps_shape(changed, star) || !hand_over_sites(changed, star, sites) || !stays_near(changed, a, place) ||
        meets_others(changed, star))
      return false;
    for (const std::uint32_t t : star) {
      grid_.remove(t, box_of(corners(triangles_[t])));
      is_alive_[t] = false;
      sites_[t].clear();
      for (const std::uint32_t v : triangles_[t]) std::erase(of_vertex_[v], t);
    }
    points_[a] = place;
    quadric_[a] = quadric_[a] + quadric_[b];
    ++version_[a];
    ++version_[b];
    for (std::size_t i = 0; i < changed.size(); ++i) {
      const Changed& c = changed[i];
      triangles_[c.index] = c.vertices;
      is_alive_[c.index] = true;
      sites_[c.index] = std::move(sites[i]);
      grid_.insert(c.index, box_of(c.corners));
      for (const std::uint32_t v : c.vertices) of_vertex_[v].push_back(c.index);
    }
    for (const std::uint32_t v : neighbours(a)) push(a, v);
    return true;
  }

  std::vector<Vec3> points_;
  std::vector<Triangle> triangles_;
  NearestTriangle original_;
  double error_, least_shape_;
  SourceBound source_;
  Grid grid_;
  std::vector<Indices> of_vertex_;  // triangles
  std::vector<Quadric> quadric_;
  std::vector<std::uint32_t> version_;
  std::vector<bool> is_alive_;
  std::vector<Indices> sites_;  // of each triangle, the original's points that are nearest to it
  std::priority_queue<Entry> queue_;
  Indices found_;
};

}  // namespace

TriangleMesh collapse_edges(const TriangleMesh& mesh, std::size_t n_triangles, double error, const SourceBound& source,
                            double least_shape) {
  return Collapser(mesh, n_triangles, error, source, least_shape).run(n_triangles);
}

}  // namespace pvg
