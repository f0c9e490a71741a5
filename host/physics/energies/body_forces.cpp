#include "host/physics/energies/body_forces.hpp"

#include <map>

namespace pvg {
namespace {

Vec3 mean(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& point : points) sum += point;
  return sum / double(points.size());
}

// about which torques are taken, of all bodies
std::vector<Vec3> centres(const PhysicalScene& scene, const WorldState& state) {
  std::vector<Vec3> centre;
  for (std::size_t b = 0; b < state.rigid.size(); ++b)
    centre.push_back(state.rigid[b].leftCols<3>() * scene.rigid_bodies[b].center_of_mass + state.rigid[b].col(3));
  for (const std::vector<Vec3>& points : state.soft) centre.push_back(mean(points));
  for (const std::vector<Vec3>& points : state.cloth) centre.push_back(mean(points));
  return centre;
}

}  // namespace

void sum_forces(const PhysicalScene& scene, WorldState& state) {
  const std::vector<Vec3> centre = centres(scene, state);
  state.body_force.assign(centre.size(), {});
  std::map<std::pair<int, int>, PairForce> pairs;
  for (const ContactForce& contact : state.contacts) {
    const Vec3 normal = contact.normal_force * contact.normal, total = normal + contact.friction_force;
    for (const auto& [body, sign] : {std::pair(contact.first, 1.0), std::pair(contact.second, -1.0)}) {
      state.body_force[std::size_t(body)].force += sign * total;
      state.body_force[std::size_t(body)].torque += sign * (contact.point - centre[std::size_t(body)]).cross(total);
    }
    const bool is_ordered = contact.first <= contact.second;
    PairForce& pair = pairs[std::minmax(contact.first, contact.second)];
    pair.normal += (is_ordered ? 1 : -1) * normal;
    pair.friction += (is_ordered ? 1 : -1) * contact.friction_force;
  }
  state.pair_force.clear();
  for (auto& [bodies, pair] : pairs) {
    pair.first = bodies.first;
    pair.second = bodies.second;
    state.pair_force.push_back(pair);
  }
}

}  // namespace pvg
