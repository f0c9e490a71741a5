#include "host/physics/step/restitution.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr double REST_STEPS = 2;  // what gravity makes of a body in so many steps is no impact
constexpr int MOST_SWEEPS = 500;  // over all contacts
constexpr double SETTLED = 1e-9;  // of the fastest approach: a sweep that changes less is the last

int rigid_named(const PhysicalScene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.rigid_bodies.size(); ++b)
    if (scene.rigid_bodies[b].name == name) return int(b);
  throw UsageError("pair_restitution names `" + name + "`, which is no rigid body of the scene; correct the name");
}

double friction_of(const PhysicalScene& scene, const RigidBody& first, const RigidBody& second) {
  for (const PairFriction& pair : scene.pair_friction)
    if (std::minmax(pair.first, pair.second) == std::minmax(first.name, second.name)) return pair.coefficient;
  return std::sqrt(first.friction * second.friction);
}

bool can_move(const RigidBody& body) { return !body.is_fixed && !body.is_prescribed; }

// One contact while its impulses are sought.
struct Contact {
  const Meeting* at;
  Vec3 arm[2];               // from the centres of mass to the point
  double low = 0, high = 0;  // bounds of the parting speed [m/s]
  double normal = 0;         // impulse found so far [N s]
  Vec3 tangential = Vec3::Zero();
};

struct Response {
  double inverse_mass = 0;
  Mat3 inverse_inertia = Mat3::Zero();
};

Vec3 velocity_at(const Twist& twist, const Vec3& arm) { return twist.velocity + twist.spin.cross(arm); }

Vec3 relative_velocity(const Contact& c, std::span<const Twist> motion) {
  return velocity_at(motion[std::size_t(c.at->first)], c.arm[0]) -
         velocity_at(motion[std::size_t(c.at->second)], c.arm[1]);
}

void push(const Contact& c, const Vec3& impulse, std::span<const Response> response, std::vector<Twist>& motion) {
  const int body[2] = {c.at->first, c.at->second};
  for (int side = 0; side < 2; ++side) {
    const Response& r = response[std::size_t(body[side])];
    const Vec3 p = side == 0 ? impulse : Vec3(-impulse);
    motion[std::size_t(body[side])].velocity += r.inverse_mass * p;
    motion[std::size_t(body[side])].spin += r.inverse_inertia * c.arm[side].cross(p);
  }
}

// change of the relative velocity along a direction by a unit impulse along it [1/kg]
double ease(const Contact& c, const Vec3& direction, std::span<const Response> response) {
  double sum = 0;
  const int body[2] = {c.at->first, c.at->second};
  for (int side = 0; side < 2; ++side) {
    const Response& r = response[std::size_t(body[side])];
    const Vec3 turn = c.arm[side].cross(direction);
    sum += r.inverse_mass + turn.dot(r.inverse_inertia * turn);
  }
  return sum;
}

double kinetic_energy(std::span<const MovingBody> bodies, std::span<const Twist> motion) {
  double sum = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    sum += 0.5 * bodies[b].mass * motion[b].velocity.squaredNorm() +
           (bodies[b].mass > 0 ? 0.5 * motion[b].spin.dot(bodies[b].inertia * motion[b].spin) : 0);
  return sum;
}

// The largest part of the change from `from` to `to` whose kinetic energy is no more than `most`.
std::vector<Twist> within_energy(std::span<const MovingBody> bodies, std::span<const Twist> from,
                                 const std::vector<Twist>& to, double most) {
  std::vector<Twist> change(to.size());
  for (std::size_t b = 0; b < to.size(); ++b)
    change[b] = {to[b].velocity - from[b].velocity, to[b].spin - from[b].spin};
  const double start = kinetic_energy(bodies, from), end = kinetic_energy(bodies, to);
  if (end <= most) return to;
  const double square = kinetic_energy(bodies, change), linear = end - start - square;  // E(s) = start + linear s + ..
  const double root = linear * linear + 4 * square * (most - start);
  const double part = square > 0 && root > 0 ? std::clamp((std::sqrt(root) - linear) / (2 * square), 0.0, 1.0) : 0;
  std::vector<Twist> scaled(from.begin(), from.end());
  for (std::size_t b = 0; b < to.size(); ++b) {
    scaled[b].velocity += part * change[b].velocity;
    scaled[b].spin += part * change[b].spin;
  }
  return scaled;
}

}  // namespace

std::vector<RestitutionPair> restitution_pairs(const PhysicalScene& scene) {
  std::vector<RestitutionPair> pairs;
  for (const PairRestitution& given : scene.pair_restitution) {
    const std::string said = "pair_restitution of `" + given.first + "` and `" + given.second + "`: ";
    if (!(given.coefficient >= 0 && given.coefficient <= 1))
      throw UsageError(said + "the coefficient must be between 0 and 1");
    const int first = rigid_named(scene, given.first), second = rigid_named(scene, given.second);
    const RigidBody &a = scene.rigid_bodies[std::size_t(first)], &b = scene.rigid_bodies[std::size_t(second)];
    if (first == second || (!can_move(a) && !can_move(b)))
      throw UsageError(said + "they never meet, since neither moves freely; name two bodies, one of which does");
    for (const Joint& joint : scene.joints)
      for (const int end : {joint.parent, joint.child})
        if ((end == first && can_move(a)) || (end == second && can_move(b)))
          throw UsageError(said + "the joint `" + joint.name + "` holds `" + scene.rigid_bodies[std::size_t(end)].name +
                           "`; a coefficient is for bodies without joints, so leave it out");
    pairs.push_back({first, second, given.coefficient, friction_of(scene, a, b)});
  }
  return pairs;
}

std::optional<std::vector<Twist>> restituted(std::span<const MovingBody> bodies, std::span<const Meeting> meetings,
                                             const Vec3& gravity, double h) {
  std::vector<Twist> before, after;
  std::vector<Response> response(bodies.size());
  double work = 0;  // of gravity [J]
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    before.push_back(bodies[b].before);
    after.push_back(bodies[b].after);
    if (bodies[b].mass > 0) response[b] = {1 / bodies[b].mass, bodies[b].inertia.inverse()};
    work += bodies[b].mass * gravity.dot(bodies[b].path);
  }
  const double at_rest = REST_STEPS * gravity.norm() * h;
  std::vector<Contact> contacts;
  double fastest = 0;
  for (const Meeting& at : meetings) {
    const MovingBody &first = bodies[std::size_t(at.first)], &second = bodies[std::size_t(at.second)];
    Contact c{.at = &at, .arm = {at.point - first.center, at.point - second.center}};
    const double met = at.normal.dot(relative_velocity(c, before));
    const double came_out = at.normal.dot(relative_velocity(c, after));
    if (met < -at_rest) {
      // gravity acts until they touch: v^2 + 2 g s along the normal
      const double pull = at.normal.dot(gravity) * ((first.mass > 0) - double(second.mass > 0));
      const double way = at.normal.dot(first.path - second.path);
      c.low = c.high = at.coefficient * std::sqrt(std::max(met * met + 2 * pull * std::min(way, 0.0), 0.0));
    } else {
      c.low = std::min(came_out, 0.0);
      c.high = std::max(met, 0.0);
    }
    fastest = std::max({fastest, std::abs(met), std::abs(came_out)});
    contacts.push_back(c);
  }
  std::vector<Twist> motion = after;
  bool is_changed = false;
  for (int sweep = 0; sweep < MOST_SWEEPS; ++sweep) {
    double largest = 0;
    for (Contact& c : contacts) {
      const Vec3& n = c.at->normal;
      const double speed = n.dot(relative_velocity(c, motion)), along = ease(c, n, response);
      const double raised = c.normal + (c.low - speed) / along, lowered = c.normal + (c.high - speed) / along;
      const double wanted = raised > 0 ? raised : lowered < 0 ? std::max(lowered, -c.at->impulse) : 0;
      largest = std::max(largest, std::abs(wanted - c.normal) * along);
      push(c, (wanted - c.normal) * n, response, motion);
      c.normal = wanted;
      if (c.at->friction == 0 || (c.normal <= 0 && c.tangential.isZero())) continue;
      Vec3 slip = relative_velocity(c, motion);
      slip -= slip.dot(n) * n;
      Vec3 pull = c.tangential;
      if (slip.norm() > 0) pull -= slip / ease(c, slip.normalized(), response);
      const double most = c.at->friction * std::max(c.normal, 0.0);
      if (pull.norm() > most) pull *= most / pull.norm();
      largest = std::max(largest, (pull - c.tangential).norm() * along);
      push(c, pull - c.tangential, response, motion);
      c.tangential = pull;
    }
    is_changed = is_changed || largest > SETTLED * fastest;
    if (largest <= SETTLED * fastest) break;
  }
  if (!is_changed) return std::nullopt;
  const double most = std::max(kinetic_energy(bodies, before) + work, kinetic_energy(bodies, after));
  return within_energy(bodies, after, motion, most);
}

}  // namespace pvg
