// Joints between rigid bodies. The constraint itself is a set of stiff springs between sites of both bodies: one anchor
// point for a spherical joint, two on the axis for a revolute one, four for a fixed one; a prismatic joint holds three
// directions together and two perpendicular offsets at zero. Its coordinate is acted on by a drive.
//   revolute:   q = angle about t from (n_i, b_i) to (n_j, b_j)        prismatic:  q = (c_j - c_i) . t_i
// with i the parent, j the child, t the axis and n, b perpendicular to it.
#pragma once
#include <span>
#include <vector>

#include "host/model/state.hpp"
#include "host/physics/energies/system.hpp"

namespace pvg {

// Coordinate of a joint [rad, in (-pi, pi], or m]; 0 for fixed and spherical joints.
double joint_coordinate(const Joint& joint, const AffineMap& parent, const AffineMap& child);

// `angle` plus whole turns, so that it lies within half a turn of `near` [rad].
double unwrap_angle(double angle, double near);

// A drive over one step as one spring along its coordinate: effort = cut(feed_forward + stiffness (target - q)), for
// the effort of a damping c is, with backward differences, a spring c / h to where the coordinate should come to.
struct StepDrive {
  double stiffness = 0;     // [N m/rad or N/m]
  double target = 0;        // [rad or m]
  double feed_forward = 0;  // [N m or N]
  double play = 0;          // within which it does not act [rad or m]
  double damping = 0;       // of a loose drive: beside its play, cut with it [N m s/rad or N s/m]
  double change = 0;        // of the target over the step, which damping follows [rad or m]
};
// start, h [s]: of the rate (q - start) / h at the step's end, those of the step where that is of implicit Euler;
// target: as given, change: of it over h; weight: effort that holds what is carried
StepDrive drive_over_step(const Drive& drive, double start, double target, double change, double weight, double h);

// What a drive exerts along its coordinate q at the end of a step of length h [s], which moved at `rate` over it
// [rad/s or m/s].  [N m or N]
double drive_effort(const StepDrive& drive, double effort_limit, double q, double rate, double h);

// What opposes a joint's motion over a step beyond its drive: damping c of E = c / (2 h) (q - q0 - change)^2.
struct StepMotion {
  double damping = 0;  // [N m s/rad or N s/m]
  double change = 0;   // [rad or m]
};
// The same with a rotor of inertia `armature` [kg m^2 or kg], E = armature / (2 h'^2) (q - q0 - foreseen)^2, h' and the
// change `foreseen` of the coordinate as time integration has them: both are squares of q, and so is their sum.
StepMotion with_armature(StepMotion motion, double armature, double foreseen, double h, double inertia_h);

// What the stops of a joint exert along its coordinate q [N m or N].
double stop_effort(const Joint& joint, double q);

// What each joint carries: the bodies whose weight its drive feels.
struct Carried {
  std::vector<int> rigid, soft;
};
std::vector<Carried> carried_bodies(const PhysicalScene& scene);  // [n_joints]

// Effort along the coordinate that holds the carried bodies against gravity, at this state [N m or N].
// soft_masses: [n_soft_bodies][n_nodes, kg]
double gravity_feed_forward(const PhysicalScene& scene, const Joint& joint, const Carried& carried,
                            const SceneState& state, std::span<const std::vector<double>> soft_masses);

}  // namespace pvg
