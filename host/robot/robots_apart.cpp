#include "host/robot/robots_apart.hpp"

#include "host/robot/collision_part.hpp"
#include "host/robot/path_planner.hpp"

namespace pvg {
namespace {

std::vector<CollisionPart> parts_of(const RobotShape& robot) {
  const std::string prefix = robot.name.empty() ? "" : robot.name + "/";
  std::vector<CollisionPart> parts;
  for (std::size_t i = 0; i < robot.model.links.size(); ++i)
    if (!robot.model.links[i].collision.triangles.empty())
      parts.push_back(make_collision_part(prefix + robot.model.links[i].name, int(i), Pose::Identity(),
                                          robot.model.links[i].collision));
  for (const Obstacle& thing : robot.carried)
    parts.push_back(make_collision_part(thing.name, robot.link, thing.pose, thing.mesh));
  return parts;
}

// A robot at one step.
struct Posed {
  VectorXd q;
  bool has_moved = true;
  std::vector<Pose> poses;  // [n_parts] to world
};

std::optional<Encounter> meeting(const std::vector<CollisionPart>& a, const Posed& at_a,
                                 const std::vector<CollisionPart>& b, const Posed& at_b, double clearance) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      if (are_closer(a[i], at_a.poses[i], b[j], at_b.poses[j], clearance)) return Encounter{0, a[i].name, b[j].name};
  return std::nullopt;
}

}  // namespace

std::optional<Encounter> first_encounter(std::span<const RobotShape> robots, std::span<const Eigen::MatrixXd> q,
                                         double clearance) {
  std::vector<std::vector<CollisionPart>> parts;
  std::vector<PathPlanner> alone;  // knows which parts of one robot may meet
  for (const RobotShape& robot : robots) {
    parts.push_back(parts_of(robot));
    alone.emplace_back(robot.model, robot.link, robot.carried, std::vector<Obstacle>{}, clearance);
  }
  std::vector<Posed> posed(robots.size());
  for (Eigen::Index step = 0; !q.empty() && step < q[0].rows(); ++step) {
    for (std::size_t r = 0; r < robots.size(); ++r) {
      const VectorXd now = q[r].row(step).head(Eigen::Index(robots[r].model.actuated.size()));
      posed[r].has_moved = step == 0 || now != posed[r].q;
      posed[r].q = now;
      if (!posed[r].has_moved) continue;
      if (const auto pair = alone[r].collision(now)) return Encounter{std::size_t(step), (*pair)[0], (*pair)[1]};
      const std::vector<Pose> links = link_poses(robots[r].model, now, robots[r].base);
      posed[r].poses.clear();
      for (const CollisionPart& part : parts[r]) posed[r].poses.push_back(links[std::size_t(part.link)] * part.pose);
    }
    for (std::size_t a = 0; a < robots.size(); ++a)
      for (std::size_t b = a + 1; b < robots.size(); ++b) {
        if (!posed[a].has_moved && !posed[b].has_moved) continue;
        if (auto found = meeting(parts[a], posed[a], parts[b], posed[b], clearance)) {
          found->step = std::size_t(step);
          return found;
        }
      }
  }
  return std::nullopt;
}

}  // namespace pvg
