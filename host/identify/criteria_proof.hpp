// The constants that decide a diagnosis, of stage 7: rows of the table in host/identify/criteria.hpp.
#pragma once

// clang-format off
#define PVG_CRITERIA_PROOF(X) \
  X(7, double, time_proof, 0.97, "--minutes", \
    "when the proof ends", \
    "the report takes the rest") \
  X(7, double, time_next, 0.1, "--minutes", \
    "what the next experiment may take, after the report is written", \
    "the commands of a seven-joint arm took more than six of 25 minutes, before the report") \
  X(7, double, time_comparison, 0.5, "time of the next experiment", \
    "when the comparison of motions ends: after it, sensitivities of the best ones are simulated", \
    "chosen by judgement, not measured") \
  X(7, double, explained_held_out, 1.15, "noise", \
    "held-out error above which the named effect explains a part only", \
    "held-out runs of the hidden suite have some 100 to 1000 numbers: noise alone gives 0.93 to 1.07") \
  X(7, double, gap_closed_least, 0.6, "1", \
    "share of the held-out gap that a named effect, or a law, must close", \
    "not recorded") \
  X(7, double, second_gap_closed_least, 0.2, "1", \
    "share of the rest of the held-out gap that a second effect must close", \
    "not recorded (commit 0c3d581)") \
  X(7, double, disturbed, 5, "median window", \
    "error from which a held-out window may be disturbed", \
    "the DFKI pendulum, one window of which is disturbed (commit 39d942d)") \
  X(7, double, disturbed_share_most, 0.1, "1", \
    "share of disturbed windows above which the model is wrong instead", \
    "the DFKI pendulum, one window of which is disturbed (commit 39d942d)") \
  X(7, double, disturbed_halved, 0.5, "1", \
    "error after over error before below which a window is explained", \
    "the DFKI pendulum, one window of which is disturbed (commit 39d942d)") \
  X(7, double, disturbed_worse, 1.1, "1", \
    "error after over error before above which a model made a window worse, which is no disturbance", \
    "the angle of one joint beside the command of another, nine tenths of whose windows a limit closed (issue 28)") \
  X(7, double, whole_run_growth, 300, "noise", \
    "what the measured error of a start may have grown to at the end of a run that is judged whole", \
    "chosen by judgement, not measured") \
  X(7, double, whole_run_proof, 60, "s", \
    "longest beginning of a held-out run that is simulated whole", \
    "chosen by judgement, not measured") \
  X(7, Series, next_amplitudes, (Series{0.3, 1, 1.5}), "recorded", \
    "amplitudes of the commands of a next experiment", \
    "a robot that has done the one can do the other: chosen by judgement") \
  X(7, Series, next_cycles, (Series{1, 3, 8}), "1", \
    "cycles of such a command", \
    "chosen by judgement, not measured") \
  X(7, Series, next_releases, (Series{-1.5, -1, -0.5, 0.5, 1, 1.5}), "farthest measured", \
    "coordinates from which a joint without a drive is released", \
    "chosen by judgement, not measured") \
  X(7, Series, next_loads, (Series{0.5}), "mass", \
    "load on a body of a next experiment, over the body's mass; it goes with motions of the recorded size", \
    "a load of that size shows beside 1 % of noise: chosen by judgement") \
  X(7, std::size_t, next_names_most, 4, "1", \
    "names that a next experiment is to tell from the first", \
    "each costs a simulation of every motion: chosen by judgement") \
  X(7, Series, next_speeds, (Series{0.5, 1, 2}), "measured", \
    "speeds with which a body is thrown", \
    "chosen by judgement, not measured") \
  X(7, Series, next_turns, (Series{0, 0.25, 0.5}), "turn", \
    "directions of a throw about the vertical", \
    "chosen by judgement, not measured") \
  X(7, double, next_longest, 8, "s", \
    "longest next experiment", \
    "as whole_run_longest") \
  X(7, std::size_t, n_laws, 3, "1", \
    "laws in one sum", \
    "not recorded (commit a8ca8f8)") \
  X(7, std::size_t, n_sums, 2, "1", \
    "sums of each size that are fitted", \
    "not recorded (commit a8ca8f8)") \
  X(7, std::size_t, n_law_sites, 3, "1", \
    "places at which laws are searched", \
    "not recorded (commit a8ca8f8)") \
  X(7, double, law_change, 2e-3, "weight", \
    "effort or force of a law that is tried first", \
    "chosen by judgement, not measured") \
  X(7, double, law_coefficient_most, 1e4, "law_change", \
    "largest coefficient of a law", \
    "chosen by judgement, not measured") \
  X(7, std::size_t, law_speed_n_samples, 5, "samples", \
    "samples between which a speed is taken", \
    "chosen by judgement, not measured") \
  X(7, Series, law_waves, (Series{1, 2, 3, 4, 6, 8, 12, 16, 24}), "1/turn", \
    "waves of an effort over its joint's turn", \
    "chosen by judgement, not measured") \
  X(7, Series, law_bump_widths, (Series{0.12, 0.22, 0.4}), "reach", \
    "widths of an effort around the zero of its joint", \
    "chosen by judgement, not measured") \
  X(7, Series, law_onsets, (Series{0.25, 0.5, 0.75}), "range", \
    "places where a one-sided effort begins", \
    "chosen by judgement, not measured") \
  X(7, double, law_sliding_speed, 0.01, "fastest", \
    "rate over which friction turns its sign", \
    "chosen by judgement, not measured") \
  X(7, Series, law_pull_distances, (Series{0.05, 0.15, 0.3, 0.5, 0.75}), "range", \
    "distances at which a pull to the origin begins", \
    "chosen by judgement, not measured") \
  X(7, Series, law_ring_distances, (Series{0.25, 0.5, 0.75}), "range", \
    "radii of a ring with friction", \
    "chosen by judgement, not measured") \
  X(7, double, law_ring_width, 0.25, "range", \
    "width of such a ring", \
    "chosen by judgement, not measured")
// clang-format on
