#include "host/physics/step/driven_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace pvg {
namespace {

// What a joint may have lagged behind its target in the last step, as a part of the change that is foreseen. By
// judgement: a stiff drive lags by far less, and one that does not follow by all of it.
constexpr double MOST_LAG = 0.3;

using Field = Eigen::Matrix<double, 3, 4>;  // x -> a displacement: F (x, 1)

Vec3 displacement(const Field& field, const Vec3& x) { return field * x.homogeneous(); }

// (p, a1, a2, a3) of a rigid body as columns a1, a2, a3, p
Field map_of(const std::vector<double>& nodes, u32 first) {
  Field map;
  for (int k = 0; k < 4; ++k) map.col((k + 3) % 4) = Eigen::Map<const Vec3>(&nodes[3 * (first + u32(k))]);
  return map;
}

// how far a joint moves its child whose parent stands at `parent`, by a change of its coordinate
Eigen::Affine3d moved_by(const Joint& joint, const Field& parent, double change) {
  const Vec3 axis = (parent.leftCols<3>() * joint.parent_frame.linear() * joint.axis).normalized();
  if (joint.type == Joint::Type::prismatic) return Eigen::Affine3d(Eigen::Translation3d(change * axis));
  if (joint.type == Joint::Type::fixed) return Eigen::Affine3d::Identity();
  const Vec3 centre = parent * joint.parent_frame.translation().homogeneous();
  return Eigen::Translation3d(centre) * Eigen::AngleAxisd(change, axis) * Eigen::Translation3d(-centre);
}

bool is_led(const Joint& joint) {
  if (joint.type == Joint::Type::fixed) return true;
  return joint.type != Joint::Type::spherical && is_driven(joint) && joint.drive.mode == Drive::Mode::position;
}

// Of each rigid body, where there is a way to it from one that is fixed over joints that are led.
std::vector<std::optional<Eigen::Affine3d>> moved_links(const System& system, std::size_t world,
                                                        std::span<const double> changes, const std::vector<double>& x) {
  const PhysicalScene& scene = system.scenes[world];
  std::vector<std::optional<Eigen::Affine3d>> moved(scene.rigid_bodies.size());
  for (std::size_t b = 0; b < moved.size(); ++b)
    if (scene.rigid_bodies[b].is_fixed) moved[b] = Eigen::Affine3d::Identity();
  for (bool finds = true; finds;) {
    finds = false;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      const std::size_t parent = std::size_t(joint.parent), child = std::size_t(joint.child);
      if (!is_led(joint) || !moved[parent] || moved[child] || scene.rigid_bodies[child].is_prescribed) continue;
      moved[child] = *moved[parent] * moved_by(joint, map_of(x, system.rigid_first_node[world][parent]), changes[j]);
      finds = true;
    }
  }
  return moved;
}

void set_motion(const Field& field, const std::vector<double>& x, const std::vector<double>& by_velocity, u32 first,
                bool is_rigid, std::size_t n_nodes, std::vector<double>& motion) {
  for (std::size_t i = 0; i < n_nodes; ++i) {
    const std::size_t k = 3 * (first + i);
    const Eigen::Map<const Vec3> node(&x[k]);
    const Vec3 by =
        is_rigid && i > 0 ? Vec3(field.leftCols<3>() * node) : displacement(field, node);  // axes are directions
    Eigen::Map<Vec3>{&motion[k]} = Eigen::Map<const Vec3>(&by_velocity[k]) + by;
  }
}

// Pairs of bodies of a world, lower number first, and their normal force [N]. Numbers are those of rigid bodies, then
// soft ones, then cloths.
using Touching = std::map<std::array<std::size_t, 2>, double>;

Touching touching_bodies(const System& system, std::size_t world, std::span<const Friction> contacts) {
  std::size_t first = 0;  // of this world
  for (std::size_t w = 0; w < world; ++w) first += n_bodies(system.scenes[w]);
  Touching touching;
  for (const Friction& contact : contacts)
    if (contact.world == world && contact.normal_force > 0) {
      const std::size_t a = contact.body[0] - first, b = contact.body[1] - first;
      touching[{std::min(a, b), std::max(a, b)}] += contact.normal_force;
    }
  return touching;
}

// [n_bodies] solids that nothing but contact holds
std::vector<char> free_solids(const PhysicalScene& scene) {
  const std::size_t n_rigid = scene.rigid_bodies.size(), n_soft = scene.soft_bodies.size();
  std::vector<char> is_free(n_bodies(scene), false);
  for (std::size_t b = 0; b < n_rigid; ++b)
    is_free[b] = !scene.rigid_bodies[b].is_fixed && !scene.rigid_bodies[b].is_prescribed;
  std::fill_n(is_free.begin() + std::ptrdiff_t(n_rigid), n_soft, true);
  for (const Joint& joint : scene.joints)
    is_free[std::size_t(joint.parent)] = is_free[std::size_t(joint.child)] = false;
  for (const Stitch& stitch : scene.stitches)
    if (stitch.soft >= 0) is_free[n_rigid + std::size_t(stitch.soft)] = false;
  return is_free;
}

// Whether what a joint carries touches something that does not go with it: whatever is not a free solid that touches
// nothing else.
bool is_held(const PhysicalScene& scene, const Carried& carried, const std::vector<char>& is_free,
             const Touching& touching) {
  std::vector<char> goes_along = is_free;
  for (const int b : carried.rigid) goes_along[std::size_t(b)] = true;
  for (const int b : carried.soft) goes_along[scene.rigid_bodies.size() + std::size_t(b)] = true;
  bool holds = false;
  for (bool changes = true; changes;) {
    changes = false;
    for (const auto& [pair, force] : touching)
      for (int side = 0; side < 2; ++side) {
        const std::size_t own = pair[std::size_t(side)], other = pair[std::size_t(1 - side)];
        if (!goes_along[own] || goes_along[other]) continue;
        if (!is_free[own]) holds = true;
        if (is_free[own]) goes_along[own] = false, changes = true;
      }
  }
  return holds;
}

}  // namespace

std::optional<std::vector<double>> foreseen_changes(const System& system, std::size_t world,
                                                    std::span<const Carried> carried,
                                                    std::span<const JointMotion> motion, std::span<const double> q,
                                                    std::span<const double> target_change,
                                                    std::span<const Friction> contacts) {
  const PhysicalScene& scene = system.scenes[world];
  const Touching touching = touching_bodies(system, world, contacts);
  const std::vector<char> is_free = free_solids(scene);
  std::vector<double> changes(q.size());
  bool follows = false;
  for (std::size_t j = 0; j < q.size(); ++j) {
    const double last = changes[j] = q[j] - motion[j].before, wanted = target_change[j];
    if (wanted == last || !(std::abs(last - motion[j].target_change) <= MOST_LAG * std::abs(wanted - last)) ||
        is_held(scene, carried[j], is_free, touching))
      continue;
    changes[j] = wanted;
    follows = true;
  }
  return follows ? std::optional(changes) : std::nullopt;
}

void follow_drives(const System& system, std::size_t world, std::span<const double> changes,
                   std::span<const Friction> contacts, const std::vector<double>& x,
                   const std::vector<double>& by_velocity, std::vector<double>& motion) {
  const PhysicalScene& scene = system.scenes[world];
  const std::vector<u32>& first = system.rigid_first_node[world];
  const std::size_t n_rigid = scene.rigid_bodies.size();
  const auto moved = moved_links(system, world, changes, x);
  // how far from where its velocity leads it each body of the robot is moved
  std::map<std::size_t, Field> led;
  for (std::size_t b = 0; b < n_rigid; ++b) {
    if (!moved[b] || scene.rigid_bodies[b].is_fixed) continue;
    const Field map = map_of(x, first[b]), velocity = map_of(by_velocity, first[b]);
    // a point x with local coordinates A^-1 (x - p) is led by m_p + M A^-1 (x - p)
    Field own;
    own.leftCols<3>() = velocity.leftCols<3>() * map.leftCols<3>().inverse();
    own.col(3) = velocity.col(3) - own.leftCols<3>() * map.col(3);
    led[b] = moved[b]->matrix().topRows<3>() - own;
    led[b].leftCols<3>() -= Mat3::Identity();
    set_motion(led[b], x, by_velocity, first[b], true, 4, motion);
  }
  std::map<std::size_t, std::pair<Field, double>> sums;  // with their weights, of what is carried
  const auto add = [&](std::size_t body, std::size_t with, double weight) {
    auto& [sum, total] = sums.try_emplace(body, Field::Zero(), 0.0).first->second;
    total += weight;
    if (const auto found = led.find(with); found != led.end()) sum += weight * found->second;
  };
  const auto move = [&] {
    for (const auto& [body, mean] : sums) {
      if (!(mean.second > 0) || mean.first.isZero(0)) continue;
      const bool is_rigid = body < n_rigid;
      const std::size_t soft = body - n_rigid;
      led[body] = mean.first / mean.second;
      set_motion(led[body], x, by_velocity, is_rigid ? first[body] : system.soft_first_node[world][soft], is_rigid,
                 is_rigid ? 4 : scene.soft_bodies[soft].mesh.points.size(), motion);
    }
    sums.clear();
  };
  for (const Stitch& stitch : scene.stitches)
    if (stitch.soft >= 0)
      add(n_rigid + std::size_t(stitch.soft), std::size_t(stitch.rigid), double(stitch.nodes.size()));
  move();
  const std::vector<char> is_free = free_solids(scene);
  for (const auto& [pair, force] : touching_bodies(system, world, contacts))
    for (int side = 0; side < 2; ++side)
      if (is_free[pair[std::size_t(side)]]) add(pair[std::size_t(side)], pair[std::size_t(1 - side)], force);
  move();
}

}  // namespace pvg
