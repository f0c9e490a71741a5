#include "pipeline/episode/intersections.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "host/formats/hdf5.hpp"
#include "host/geometry/exact_intersection.hpp"

namespace pvg {
namespace {

using RowMap = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
constexpr std::int64_t N_RIGID_SETS = 2;  // T_link and T_rigid stand first among the data sets

struct Body {
  std::size_t number = 0;    // of /bodies
  std::vector<double> rest;  // [n x 3, m]
};

// The surfaces of all bodies as one list of triangles, and where their points are in each step.
class Surfaces {
 public:
  explicit Surfaces(const std::filesystem::path& states) : file_(hdf5::File::open(states)) {
    names_ = file_.texts_attribute("/bodies", "names");
    for (const std::string& set : file_.texts_attribute("/bodies", "data_sets"))
      sets_.push_back(file_.read<double>(set));
    source_ = file_.read<std::int64_t>("/bodies/source").values;
    row_ = file_.read<std::int64_t>("/bodies/row").values;
    is_fixed_ = file_.read<std::int64_t>("/bodies/is_fixed").values;
    const auto pairs = file_.read<std::int64_t>("/bodies/noncolliding").values;
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2)
      free_pairs_.insert(std::minmax(std::size_t(pairs[i]), std::size_t(pairs[i + 1])));
    n_steps_ = file_.shape("/time").at(0);
    std::uint32_t first = 0;
    for (const std::string& name : names_) {  // of several robots with a slash: groups within groups
      const std::string at = "/mesh/" + name;
      if (!file_.has(at + "/triangles")) continue;
      const auto body = std::size_t(file_.read<std::int64_t>(at + "/body").values.at(0));
      const auto corners = file_.read<std::uint32_t>(at + "/triangles").values;
      bodies_.push_back({body, file_.read<double>(at + "/rest").values});
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
      first += std::uint32_t(bodies_.back().rest.size() / 3);
    }
  }

  std::size_t n_steps() const { return n_steps_; }

  // "beaker and finger_left"; empty: nothing meets
  std::string meeting(std::size_t step) const {
    const std::vector<Vec3> points = points_at(step);
    const auto may_overlap = [&](std::uint32_t edge, std::uint32_t triangle) {
      const std::size_t a = edge_body_[edge], b = triangle_body_[triangle];
      if (a == b) return source_[a] < N_RIGID_SETS;
      return (is_fixed_[a] && is_fixed_[b]) || free_pairs_.contains(std::minmax(a, b));
    };
    const auto found = find_intersection(points, edges_, triangles_, may_overlap);
    return found ? names_[edge_body_[found->edge]] + " and " + names_[triangle_body_[found->triangle]] : "";
  }

 private:
  std::vector<Vec3> points_at(std::size_t step) const {
    std::vector<Vec3> points;
    for (const Body& body : bodies_) {
      const auto& set = sets_[std::size_t(source_[body.number])];
      if (source_[body.number] < N_RIGID_SETS) {
        const Eigen::Map<const RowMap> map(&set.values[(step * set.shape[1] + std::size_t(row_[body.number])) * 12]);
        for (std::size_t v = 0; v < body.rest.size(); v += 3)
          points.push_back(map * Eigen::Vector4d(body.rest[v], body.rest[v + 1], body.rest[v + 2], 1));
      } else {
        for (std::size_t v = 0; v < body.rest.size(); v += 3)
          points.emplace_back(&set.values[step * body.rest.size() + v]);
      }
    }
    return points;
  }

  hdf5::File file_;
  std::vector<std::string> names_;
  std::vector<hdf5::Array<double>> sets_;
  std::vector<std::int64_t> source_, row_, is_fixed_;
  std::set<std::pair<std::size_t, std::size_t>> free_pairs_;
  std::vector<Body> bodies_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
  std::vector<std::size_t> triangle_body_, edge_body_;
  std::size_t n_steps_ = 0;
};

}  // namespace

IntersectedSteps count_intersected_steps(const std::filesystem::path& states, std::size_t every) {
  const Surfaces surfaces(states);
  IntersectedSteps counted;
  for (std::size_t step = 0; step < surfaces.n_steps(); ++step) {
    if (step % every != 0 && step + 1 != surfaces.n_steps()) continue;
    ++counted.steps;
    const std::string meeting = surfaces.meeting(step);
    if (meeting.empty()) continue;
    if (counted.intersected == 0) counted.first = "step " + std::to_string(step) + ": " + meeting;
    ++counted.intersected;
  }
  return counted;
}

}  // namespace pvg
