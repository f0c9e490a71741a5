// What a step of the simulator hands out: where everything is, what touches with which force, what it cost.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/geometry/mesh.hpp"
#include "host/model/state.hpp"

namespace pvg {

// One contact after a step. Forces act on the first body; the second feels the opposite.
struct ContactForce {
  enum class Kind { point_triangle = 0, edge_edge = 1, point_plane = 2 };
  Kind kind = Kind::point_triangle;
  int first = -1, second = -1;         // bodies: rigid bodies first, then soft ones at n_rigid + i, then cloths
  Vec3 point = Vec3::Zero();           // midway between the closest points, world [m]
  Vec3 normal = Vec3::Zero();          // unit, from the second body to the first
  double gap = 0;                      // [m]
  double normal_force = 0;             // [N], >= 0
  Vec3 friction_force = Vec3::Zero();  // [N]
};

// What all contacts together do to one body.
struct BodyForce {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // about the centre of mass of a rigid body, the mean of its nodes of another [N m]
};

// What all contacts of one pair of bodies do to the first of them.
struct PairForce {
  int first = -1, second = -1;
  Vec3 normal = Vec3::Zero(), friction = Vec3::Zero();  // [N]
};

struct WorldState : SceneState {
  std::vector<double> joint_position;     // [n_joints, rad or m], 0 for fixed and spherical joints
  std::vector<double> joint_effort;       // [n_joints, N m or N] what the drive exerts along q, feed-forward included
  std::vector<double> joint_stop_effort;  // the same of the stops, 0 inside the limits
  std::vector<double> joint_damping_effort;  // the same of the joint's own damping
  std::vector<ContactForce> contacts;
  std::vector<BodyForce> body_force;  // [n_bodies] rigid, then soft, then cloth
  std::vector<PairForce> pair_force;  // of the pairs that touch, sorted
};

// Why an attempt at a step was given up.
struct StepEvent {
  enum class Kind { not_finite, inverted_element, stalled, exhausted_line_search };
  Kind kind = Kind::stalled;
  std::size_t world = 0;
  double time = 0, length = 0;  // of the attempt: where it began, how long it was [s]
  std::string body;             // where it showed; empty: nowhere in particular
  int element = -1;             // of that body: the tetrahedron if inverted, else the node; -1: the body as a whole
  std::string detail;           // a sentence's end
};

// What one step cost, per world.
struct StepReport {
  int newton = 0;                 // iterations
  int cg = 0;                     // iterations of conjugate gradients, summed
  int contacts = 0;               // active at the end
  int retries = 0;                // halvings of the step that were needed
  double residual = 0;            // largest speed of the last Newton correction [m/s]
  double min_gap = 0;             // smallest contact gap at the end [m]; infinite without contacts
  std::vector<StepEvent> events;  // of the attempts that failed, halved steps among them
};

}  // namespace pvg
