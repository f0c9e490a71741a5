#include "pipeline/episode/intersections.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "host/dataset/states_record.hpp"
#include "host/geometry/exact_intersection.hpp"
#include "host/hdf5/file.hpp"

namespace pvg {
namespace {

using RowMap = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

struct Shape {
  std::size_t body = 0;
  std::vector<double> rest;  // [n x 3, m]
};

// The surfaces of all bodies as one list of triangles, and where their points are in each step.
class Surfaces {
 public:
  explicit Surfaces(const std::filesystem::path& states) {
    const StatesRecord record(states);
    bodies_ = record.bodies();
    n_steps_ = record.n_steps();
    kept_ = record.kept_steps();
    for (const auto& pair : record.noncolliding(bodies_.size())) free_pairs_.insert(pair);
    std::uint32_t first = 0;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
      if (!record.has_mesh(bodies_[body])) continue;
      StatesRecord::Mesh mesh = record.mesh(bodies_[body]);
      const std::string& set = bodies_[body].data_set;
      if (!sets_.contains(set)) sets_[set] = record.rows(set);
      add_triangles(mesh.triangles, first, body);
      first += std::uint32_t(mesh.rest.size() / 3);
      shapes_.push_back({body, std::move(mesh.rest)});
    }
  }

  const std::vector<std::size_t>& kept_steps() const { return kept_; }

  // "beaker and finger_left"; empty: nothing meets
  std::string meeting(std::size_t step) const {
    const std::vector<Vec3> points = points_at(step);
    const auto may_overlap = [&](std::uint32_t edge, std::uint32_t triangle) {
      const std::size_t a = edge_body_[edge], b = triangle_body_[triangle];
      if (a == b) return bodies_[a].is_rigid;
      return (bodies_[a].is_fixed && bodies_[b].is_fixed) || free_pairs_.contains(std::minmax(a, b));
    };
    const auto found = find_intersection(points, edges_, triangles_, may_overlap);
    return found ? bodies_[edge_body_[found->edge]].name + " and " + bodies_[triangle_body_[found->triangle]].name : "";
  }

 private:
  void add_triangles(const std::vector<std::uint32_t>& corners, std::uint32_t first, std::size_t body) {
    std::set<Edge> edges;  // open surfaces have edges that stand in one triangle alone
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      const Triangle t = {first + corners[i], first + corners[i + 1], first + corners[i + 2]};
      triangles_.push_back(t);
      triangle_body_.push_back(body);
      for (std::size_t k = 0; k < 3; ++k)
        edges.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    }
    edges_.insert(edges_.end(), edges.begin(), edges.end());
    edge_body_.resize(edges_.size(), body);
  }

  std::vector<Vec3> points_at(std::size_t step) const {
    std::vector<Vec3> points;
    for (const Shape& shape : shapes_) {
      const StatesRecord::Body& body = bodies_[shape.body];
      const std::vector<double>& set = sets_.at(body.data_set);
      const std::size_t per_step = set.size() / n_steps_;
      if (body.is_rigid) {
        const Eigen::Map<const RowMap> map(&set[step * per_step + body.row * 12]);
        for (std::size_t v = 0; v < shape.rest.size(); v += 3)
          points.push_back(map * Eigen::Vector4d(shape.rest[v], shape.rest[v + 1], shape.rest[v + 2], 1));
      } else {
        for (std::size_t v = 0; v < shape.rest.size(); v += 3) points.emplace_back(&set[step * per_step + v]);
      }
    }
    return points;
  }

  std::vector<StatesRecord::Body> bodies_;
  std::map<std::string, std::vector<double>> sets_;  // of the bodies that have a surface
  std::set<std::pair<std::size_t, std::size_t>> free_pairs_;
  std::vector<Shape> shapes_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
  std::vector<std::size_t> triangle_body_, edge_body_;
  std::size_t n_steps_ = 0;
  std::vector<std::size_t> kept_;
};

}  // namespace

IntersectedSteps count_intersected_steps(const std::filesystem::path& states, std::size_t every) {
  const Surfaces surfaces(states);
  IntersectedSteps counted;
  const std::vector<std::size_t>& kept = surfaces.kept_steps();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i % every != 0 && i + 1 != kept.size()) continue;
    const std::size_t step = kept[i];
    ++counted.steps;
    const std::string meeting = surfaces.meeting(step);
    if (meeting.empty()) continue;
    if (counted.intersected == 0) counted.first = "step " + std::to_string(step) + ": " + meeting;
    ++counted.intersected;
  }
  return counted;
}

}  // namespace pvg
