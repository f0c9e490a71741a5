// The constants that decide a diagnosis, of stage 6: rows of the table in host/identify/criteria.hpp.
#pragma once

// clang-format off
#define PVG_CRITERIA_DECISION(X) \
  X(6, double, time_search, 0.75, "--minutes", \
    "when the search for effects ends", \
    "chosen by judgement: the proof needs a fifth of the time") \
  X(6, double, time_steps, 0.7, "rest of the search", \
    "when the steps of a round's fits end: their sensitivities are needed for a decision", \
    "chosen by judgement, not measured") \
  X(6, double, time_first_steps, 0.4, "rest of the search", \
    "the same in a large world for the first effect, where a second one may follow", \
    "chosen by judgement, not measured") \
  X(6, double, sensitivities_at_worst, 2, "1", \
    "time that is kept for sensitivities, over what the first simulations took: others use the machine, too", \
    "chosen by judgement, not measured") \
  X(6, double, residual_cut, 4, "scale", \
    "size at which residuals are cut in left-out errors", \
    "not recorded") \
  X(6, double, relative_gain_least, 0.02, "1", \
    "relative difference of errors that is more than arithmetic", \
    "not recorded (commit 1f29049)") \
  X(6, double, gain_sigma, 2, "sigma", \
    "by how much a gain, and a parameter's distance from off, must exceed its error", \
    "convention") \
  X(6, double, as_good_sigma, 1, "sigma", \
    "within how much of the best a simpler model is as good", \
    "one-standard-error rule (Breiman et al. 1984)") \
  X(6, std::size_t, n_groups_most, 8, "1", \
    "groups of windows that are left out in turn", \
    "not recorded") \
  X(6, std::size_t, n_runs_as_groups, 3, "1", \
    "fitting runs from which a run is a group", \
    "not recorded") \
  X(6, double, bound_width, 1e-6, "range", \
    "distance from a bound within which a parameter is at it", \
    "arithmetic of a clamped step") \
  X(6, double, bound_width_logarithmic, 1e-3, "bound", \
    "the same of a number that goes in its logarithm", \
    "arithmetic of a clamped step") \
  X(6, std::size_t, correlation_lag_most, 200, "samples", \
    "longest lag of the residuals' autocorrelation", \
    "what a wrong law leaves of a fall or a swing hangs together for its whole duration") \
  X(6, double, correlation_significant, 3, "1/sqrt(n)", \
    "autocorrelation of the residuals below which it counts as ended", \
    "chosen by judgement, not measured") \
  X(6, double, left_out_ridge, 0.1, "1", \
    "what a fit without one group knows beforehand, as a share of the information of all: it stays within some three " \
    "standard deviations of the fit of all", \
    "a Stribeck curve whose speed one run of three tells was refused for that run (new scenarios, seed 51, case 007)") \
  X(6, double, log_prior_physical, -1, "log", \
    "log prior of a missing effect against a wrong number", \
    "not recorded (commit 0fd3dd3)") \
  X(6, double, log_prior_parameter, 0, "log", \
    "log prior of a wrong number", \
    "reference of the others") \
  X(6, double, log_prior_measurement, -0.5, "log", \
    "log prior of a sensor's error", \
    "not recorded (commit 0fd3dd3)") \
  X(6, double, evidence_margin, 10, "log", \
    "log-evidence margin beyond which simplicity no longer decides", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(6, double, log_prior_margin_simpler, 5, "log", \
    "log prior by which a simpler model may be behind", \
    "adhesion of a rigid block (commit 0c3346e)") \
  X(6, double, log_prior_margin, 1, "log", \
    "log prior that decides between models that close nearly as much", \
    "not recorded") \
  X(6, double, unexplained, 1.5, "noise", \
    "error above which something is left to explain", \
    "not recorded") \
  X(6, double, nearly_as_much, 0.6, "1", \
    "share of the best model's gain from which a model closes nearly as much", \
    "not recorded") \
  X(6, double, second_gain_least, 0.2, "1", \
    "share of the rest that a second effect must close on fitting runs", \
    "not recorded (commit 0c3d581)") \
  X(6, std::size_t, n_swaps, 3, "1", \
    "alternatives that replace the first effect", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(6, std::size_t, n_alternatives, 4, "1", \
    "alternatives to the first effect beside which a second one is searched", \
    "friction and payload of a carriage, of which play and clocks left less alone (new scenarios, seed 83, case 035)") \
  X(6, double, same_residual, 1, "noise", \
    "difference below which two fits leave the same", \
    "backlash beside friction, spring beside delay (commit 0ec3434)") \
  X(6, std::size_t, n_pairs, 8, "1", \
    "pairs that are fitted", \
    "two effects of the hidden suite (commit b878db3)") \
  X(6, std::size_t, n_pairs_of_one, 3, "1", \
    "pairs that may hold the same candidate, and second effects that are fitted beside one alternative", \
    "two effects of the hidden suite (commit b878db3)") \
  X(6, double, pair_first_part, 0.25, "1", \
    "first share of the runs in which pairs of soft bodies are searched", \
    "not recorded (commit 8fc1ec6)") \
  X(6, double, pair_second_part, 0.5, "1", \
    "second share", \
    "not recorded (commit 8fc1ec6)")
// clang-format on
