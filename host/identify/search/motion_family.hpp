// Motions that could be recorded next: commands of drives, and starts of what no drive moves, within what the recorded
// runs did.
#pragma once
#include <string>
#include <vector>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/data/window.hpp"

namespace pvg::diagnose {

struct PlannedMotion {
  std::string description;  // "command of shoulder: a sine of 0.4 rad, 3 cycles in 3 s"
  double seconds = 0;
  InitialState initial;
  std::vector<TargetTable> targets;  // [n_driven] as Run has them
  std::string loaded = {};           // the body that carries a load at its centre of mass; empty: none
  double load = 0;                   // [kg]
  bool has_recorded_size = false;    // neither larger nor smaller than what was recorded
};

// What can be moved where a scene may be in doubt.
struct Inputs {
  std::vector<bool> joints, bodies;  // [n_joints], [n_rigid_bodies]
};

// Those that tell candidates apart, the surest first, none twice: for what is of a joint this joint, then those next to
// it in its chain; for what is of a body the body itself and the joints that carry it; all for what belongs to neither.
std::vector<Inputs> inputs_of(const PhysicalScene& scene, const std::vector<const Candidate*>& in_doubt);
Inputs all_inputs(const PhysicalScene& scene);

// Motions without and with loads. Driven joints: sines, triangles, steps and chirps of 0.3, 1 and 1.5 times the
// recorded amplitude about where the commands began, with 1, 3 and 8 cycles. Other joints, and those whose commands
// never change, such as springs: releases at rest from other angles, about where their recorded motions had their
// middle. Free bodies: the first recorded start with half and twice the speed, turned about the vertical. Only of these
// inputs. Motions of the recorded size also with a load on the body that is moved.
std::vector<PlannedMotion> motion_family(const Problem& problem, const Inputs& inputs);

// The problem with these motions as its runs: nothing is measured there, so the numbers to compare with are zero.
Problem planned_problem(const Problem& problem, const std::vector<PlannedMotion>& motions);

}  // namespace pvg::diagnose
