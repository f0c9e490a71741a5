#include "host/physics/step/separate_bodies.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

#include "host/geometry/exact_intersection.hpp"
#include "host/physics/energies/system.hpp"

namespace pvg {
namespace {

constexpr int MAX_MOVES = 200;
constexpr int MAX_BISECTIONS = 24;

struct Surface {
  std::vector<Vec3> points;  // world [m]
  std::vector<Edge> edges;
  std::vector<Triangle> triangles;
};

// Where the body's pose stands: rigid bodies first, then soft ones, then cloths.
Pose& pose_of(PhysicalScene& scene, std::size_t body) {
  const std::size_t n_rigid = scene.rigid_bodies.size(), n_soft = scene.soft_bodies.size();
  if (body < n_rigid) return scene.rigid_bodies[body].pose;
  return body < n_rigid + n_soft ? scene.soft_bodies[body - n_rigid].pose : scene.cloths[body - n_rigid - n_soft].pose;
}

bool is_free(const PhysicalScene& scene, std::size_t body) {
  const std::size_t n_rigid = scene.rigid_bodies.size(), n_soft = scene.soft_bodies.size();
  if (body < n_rigid && (scene.rigid_bodies[body].is_fixed || scene.rigid_bodies[body].is_prescribed)) return false;
  for (const Joint& joint : scene.joints)
    if (joint.parent == int(body) || joint.child == int(body)) return false;
  return std::none_of(scene.stitches.begin(), scene.stitches.end(), [&](const Stitch& stitch) {
    const std::size_t other = stitch.soft >= 0 ? n_rigid + stitch.soft : n_rigid + n_soft + stitch.cloth;
    return stitch.rigid == int(body) || other == body;
  });
}

std::vector<Vec3> site_positions(const System& system) {
  std::vector<Vec3> x;
  for (const Site& site : system.sites) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 4; ++k) sum += site.weight[k] * Eigen::Map<const Vec3>(&system.x[3 * site.node[k]]);
    x.push_back(sum);
  }
  return x;
}

Surface surface_of(const System& system, const std::vector<Vec3>& x, u32 body) {
  Surface surface;
  surface.points = x;  // numbered as sites
  for (const CollisionEdge& edge : system.collision.edges)
    if (edge.body == body) surface.edges.push_back({edge.site[0], edge.site[1]});
  for (const CollisionTriangle& triangle : system.collision.triangles)
    if (triangle.body == body) surface.triangles.push_back({triangle.site[0], triangle.site[1], triangle.site[2]});
  return surface;
}

// lowest and highest coordinate of a surface along a direction
std::array<double, 2> extent(const Surface& surface, const Vec3& direction) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Triangle& triangle : surface.triangles)
    for (const std::uint32_t site : triangle) {
      low = std::min(low, surface.points[site].dot(direction));
      high = std::max(high, surface.points[site].dot(direction));
    }
  return {low, high};
}

// how far `moved` has to go along `direction` until it meets `other` no more
double way_apart(const Surface& moved, const Surface& other, const Vec3& direction) {
  const auto is_site_of = [](const Surface& surface, std::size_t n) {
    std::vector<bool> is_in(n, false);
    for (const Triangle& triangle : surface.triangles)
      for (const std::uint32_t site : triangle) is_in[site] = true;
    return is_in;
  };
  const std::vector<bool> moves = is_site_of(moved, moved.points.size());
  const auto meet = [&](double way) {
    std::vector<Vec3> x = moved.points;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (moves[i]) x[i] += way * direction;
    const auto never = [](u32, u32) { return false; };
    return find_intersection(x, moved.edges, other.triangles, never) ||
           find_intersection(x, other.edges, moved.triangles, never);
  };
  double still = 0, apart = std::max(0.0, extent(other, direction)[1] - extent(moved, direction)[0]) + 1e-9;
  for (int i = 0; i < MAX_BISECTIONS; ++i) {
    const double middle = 0.5 * (still + apart);
    (meet(middle) ? still : apart) = middle;
  }
  return apart;
}

Vec3 up_of(const PhysicalScene& scene) {
  return scene.gravity.norm() > 0 ? Vec3(-scene.gravity.normalized()) : Vec3(Vec3::UnitZ());
}

Vec3 shortest_way(const PhysicalScene& scene, const Surface& moved, const Surface& other, double clearance) {
  const Vec3 up = up_of(scene), side = up.unitOrthogonal(), across = up.cross(side);
  double shortest = std::numeric_limits<double>::infinity();
  Vec3 best = up;
  for (const Vec3& direction : {up, side, Vec3(-side), across, Vec3(-across)})
    if (const double way = way_apart(moved, other, direction); way < shortest - 1e-9) {
      shortest = way;
      best = direction;
    }
  return (shortest + clearance) * best;
}

// the body's way out of a half-space; zero where it is outside
Vec3 way_out(const RigidBody& half_space, const Surface& surface, double clearance) {
  const Vec3 normal = half_space.pose.linear().col(2);
  const double lowest = extent(surface, normal)[0] - half_space.pose.translation().dot(normal);
  return lowest > 0 || surface.triangles.empty() ? Vec3(Vec3::Zero()) : Vec3((clearance - lowest) * normal);
}

// one body's next move, or nothing
struct Move {
  std::size_t body;
  Vec3 by;
};
std::optional<Move> next_move(const PhysicalScene& scene) {
  const System system = make_system(std::vector<PhysicalScene>{scene});
  const std::vector<Vec3> x = site_positions(system);
  const std::vector<CollisionBody>& bodies = system.collision.bodies;
  const auto clearance = [&](std::size_t a, std::size_t b) {
    return bodies[a].offset + bodies[b].offset + 0.5 * scene.contact.activation_distance;
  };
  for (std::size_t plane = 0; plane < scene.rigid_bodies.size(); ++plane)
    for (std::size_t b = 0; scene.rigid_bodies[plane].is_half_space && b < bodies.size(); ++b) {
      if (!is_free(scene, b)) continue;
      const Vec3 by = way_out(scene.rigid_bodies[plane], surface_of(system, x, u32(b)), clearance(plane, b));
      if (by.norm() > 0) return Move{b, by};
    }
  const auto conflict = find_surface_intersection(system.collision, x);
  if (!conflict || conflict->first_body == conflict->second_body) return std::nullopt;
  std::size_t moved = conflict->first_body, other = conflict->second_body;
  const Vec3 up = up_of(scene);
  const auto height = [&](std::size_t b) { return extent(surface_of(system, x, u32(b)), up)[1]; };
  // of two free bodies the one that reaches higher goes
  if (!is_free(scene, moved) || (is_free(scene, other) && height(other) > height(moved))) std::swap(moved, other);
  if (!is_free(scene, moved)) return std::nullopt;
  return Move{moved, shortest_way(scene, surface_of(system, x, u32(moved)), surface_of(system, x, u32(other)),
                                  clearance(moved, other))};
}

}  // namespace

std::vector<Separation> separate_bodies(PhysicalScene& scene) {
  std::vector<Vec3> moved(n_bodies(scene), Vec3::Zero());
  for (int i = 0; i < MAX_MOVES; ++i) {
    const auto move = next_move(scene);
    if (!move) break;
    pose_of(scene, move->body).translation() += move->by;
    moved[move->body] += move->by;
  }
  std::vector<Separation> separations;
  for (std::size_t b = 0; b < moved.size(); ++b)
    if (moved[b].norm() > 0) separations.push_back({body_name(scene, b), moved[b]});
  return separations;
}

std::string describe(const Separation& moved) {
  std::array<char, 128> way{};
  std::snprintf(way.data(), way.size(), "(%.6g, %.6g, %.6g) m", moved.by.x(), moved.by.y(), moved.by.z());
  return moved.body + " was moved by " + way.data() + ", apart from what it started in";
}

}  // namespace pvg
