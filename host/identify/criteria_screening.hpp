// The constants that decide a diagnosis, of stage 4: rows of the table in host/identify/criteria.hpp.
#pragma once

// clang-format off
#define PVG_CRITERIA_SCREENING(X) \
  X(4, std::size_t, large_world, 1000, "nodes", \
    "size above which a simulation takes seconds: screened by place, in turns and once, few fits", \
    "two soft fingers of 3,000 nodes took 2.4 processor seconds (docs/measured/2026-11-28_fidelity.md)") \
  X(4, double, time_screening, 0.45, "a round", \
    "when the screening of a large world ends, where not all candidates can be screened", \
    "chosen by judgement, not measured") \
  X(4, double, response_off_most, 4, "1", \
    "factor off the wanted response within which a first change is not made again in a large world, nor a second within its square", \
    "chosen by judgement, not measured") \
  X(4, double, sensitivity_least, 1e-3, "noise", \
    "change of the residuals below which a candidate is not seen", \
    "not recorded") \
  X(4, double, screen_factor_most, 30, "1", \
    "factor between one change tried and the next, and of a parameter's scale", \
    "not recorded") \
  X(4, std::size_t, screen_n_windows, 3, "1", \
    "windows in which an estimate is enough", \
    "not recorded") \
  X(4, std::size_t, screen_n_tried, 20, "1", \
    "candidates that are simulated at their linear optimum", \
    "not recorded") \
  X(4, double, screen_change_least, 2, "noise", \
    "smallest change of the residuals that a step should make", \
    "not recorded") \
  X(4, double, screen_change_most, 30, "noise", \
    "largest change of the residuals that a step should make", \
    "not recorded") \
  X(4, double, pair_change_most, 10, "noise", \
    "the same for the signatures of pairs and laws", \
    "not recorded") \
  X(4, double, screen_share_low, 0.4, "linear optimum", \
    "where a candidate is tried besides its optimum", \
    "not recorded") \
  X(4, double, screen_share_high, 2, "linear optimum", \
    "where a candidate is tried besides its optimum", \
    "not recorded") \
  X(4, double, screen_shape_low, 0.2, "1", \
    "factor on a shape parameter that is tried", \
    "a Stribeck curve named Coulomb friction (commit ae8853e)") \
  X(4, double, screen_shape_high, 5, "1", \
    "factor on a shape parameter that is tried", \
    "a Stribeck curve named Coulomb friction (commit ae8853e)") \
  X(4, Series, screen_shapes, (Series{0.1, 0.3, 3, 10}), "1", \
    "factors on the usual shape of a law that are tried with equal strengths", \
    "Stribeck curves of 1 rad/s, ten times the usual, ended at 0.01 to 0.04 rad/s (new scenarios, seeds 2 and 11)") \
  X(4, Series, screen_limits, (Series{0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.35}), "1", \
    "limits that are tried, over where the limit is first reached", \
    "chosen by judgement, not measured") \
  X(4, double, screen_steps_most, 20, "change tried", \
    "farthest linear optimum of a candidate", \
    "chosen by judgement, not measured") \
  X(4, double, screen_base_steps_most, 1, "scale", \
    "farthest change of the base's parameters beside it", \
    "chosen by judgement, not measured") \
  X(4, double, screen_ridge, 1e-9, "trace", \
    "ridge of the normal equations of one candidate", \
    "chosen by judgement, not measured") \
  X(4, double, signature_ridge, 1e-6, "diagonal", \
    "ridge of those of pairs and laws: columns that are nearly alike must not cancel each other", \
    "chosen by judgement, not measured") \
  X(4, double, rounding_rate_share, 0.1, "noise", \
    "rate below which a joint's friction is rounded off, over what the noise hides", \
    "seed 23, case 038: 1e-3 rad/s, 5 times what the noise hid, moved a friction by six deviations") \
  X(4, double, change_torque, 2e-3, "weight m", \
    "first change that is tried of a torque", \
    "chosen by judgement, not measured") \
  X(4, double, change_joint_damping, 2e-3, "mass m^2/s", \
    "first change that is tried of a joint's damping", \
    "chosen by judgement, not measured") \
  X(4, double, change_joint_stiffness, 1e-2, "weight m/rad", \
    "first change that is tried of a stiffness in torque", \
    "chosen by judgement, not measured") \
  X(4, double, change_stiffness, 1, "weight/m", \
    "first change that is tried of a stiffness in force", \
    "chosen by judgement, not measured") \
  X(4, double, change_force, 0.02, "weight", \
    "first change that is tried of a force", \
    "chosen by judgement, not measured") \
  X(4, double, change_drag, 0.05, "mass/s, mass/m", \
    "first change that is tried of linear and quadratic drag", \
    "chosen by judgement, not measured") \
  X(4, double, change_mass, 0.1, "mass", \
    "first change that is tried of a mass", \
    "chosen by judgement, not measured") \
  X(4, double, change_shift, 3e-3, "m", \
    "first change that is tried of a length", \
    "chosen by judgement, not measured") \
  X(4, double, change_turn, 0.02, "rad", \
    "first change that is tried of an angle", \
    "chosen by judgement, not measured") \
  X(4, double, change_time, 0.01, "s", \
    "first change that is tried of a time", \
    "chosen by judgement, not measured") \
  X(4, double, change_viscosity, 100, "Pa s", \
    "first change that is tried of a viscosity", \
    "chosen by judgement, not measured") \
  X(4, double, change_decay, 0.5, "1/s", \
    "first change that is tried of a rate of decay", \
    "chosen by judgement, not measured") \
  X(4, double, change_curvature, 0.2, "1/m", \
    "first change that is tried of a curvature", \
    "chosen by judgement, not measured") \
  X(4, double, change_adhesion, 0.1, "J/m^2", \
    "first change that is tried of an adhesion", \
    "chosen by judgement, not measured") \
  X(4, double, change_rotor_inertia, 0.01, "m^2", \
    "first change that is tried of a rotor's inertia, over the mass of the joint's child", \
    "chosen by judgement, not measured") \
  X(4, double, change_dissipation, 0.1, "s/m", \
    "first change that is tried of a contact's dissipation", \
    "chosen by judgement, not measured") \
  X(4, double, change_speed, 0.1, "m/s", \
    "first change that is tried of a speed", \
    "chosen by judgement, not measured") \
  X(4, double, change_spin, 0.1, "rad/s", \
    "first change that is tried of a spin", \
    "chosen by judgement, not measured") \
  X(4, double, change_share, 0.1, "1", \
    "first change that is tried of a number without a unit", \
    "chosen by judgement, not measured") \
  X(4, double, change_other, 0.01, "range", \
    "the same of all other units", \
    "chosen by judgement, not measured") \
  X(4, double, change_unknown_mass, 0.3, "kg", \
    "mass that counts for these where the target is no rigid body", \
    "chosen by judgement, not measured") \
  X(4, double, change_number, 0.1, "value", \
    "first change that is tried of a number of the scene", \
    "chosen by judgement, not measured") \
  X(4, double, change_bias, 3, "noise", \
    "first change that is tried of a bias", \
    "chosen by judgement, not measured") \
  X(4, double, bias_most, 1e4, "noise", \
    "largest bias", \
    "chosen by judgement, not measured") \
  X(4, double, number_far_below, 1e-3, "1", \
    "lowest ratio of a stiffness, modulus or effort limit to what the scene says", \
    "stiffnesses of drives in makers' files are 50 to 80 times too large (issue 28)") \
  X(4, double, number_far_above, 1e3, "1", \
    "highest such ratio, of a damping too", \
    "likewise") \
  X(4, Series, screen_factors, (Series{4, 16, 64, 250}), "1", \
    "factors by which a number that may be far off is tried larger and smaller", \
    "stiffnesses of drives in makers' files are 50 to 80 times too large (issue 28)") \
  X(4, double, showable_sigma, 3, "sigma", \
    "size of an effect over its standard deviation from which recordings can show it", \
    "convention") \
  X(4, double, told_apart, 3, "noise", \
    "length of what one candidate leaves of another's change below which no data tell them apart", \
    "convention: three standard deviations") \
  X(4, double, told_apart_share, 1e-4, "1", \
    "share of a candidate's change, squared, below which what another leaves of it is arithmetic", \
    "finite differences are good to a per cent") \
  X(4, std::size_t, n_showable_printed, 12, "1", \
    "rows of what recordings could show that are printed; the report has all", \
    "half a terminal") \
  X(4, double, limit_felt, 1e-3, "noise", \
    "change of the residuals from which a limit is reached", \
    "soft bodies that yield (commit 1db744e)") \
  X(4, double, limit_highest, 1, "parameter", \
    "highest limit that is tried", \
    "soft bodies that yield (commit 1db744e)") \
  X(4, double, limit_lowest, 1e-3, "parameter", \
    "lowest limit that is tried", \
    "soft bodies that yield (commit 1db744e)")
// clang-format on
