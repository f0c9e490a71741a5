// The constants that decide a diagnosis, of stage 5: rows of the table in host/identify/criteria.hpp.
#pragma once

// clang-format off
#define PVG_CRITERIA_FIT(X) \
  X(5, std::size_t, n_fitted, 9, "1", \
    "candidates of a round that are fitted", \
    "not recorded") \
  X(5, std::size_t, n_fitted_large, 3, "1", \
    "the same in a large world; beside an effect these alone, whatever their families are", \
    "chosen by judgement, not measured") \
  X(5, std::size_t, n_fitted_per_family, 2, "1", \
    "candidates that each family always sends to the fit", \
    "not recorded") \
  X(5, double, log_step_most, 1.5, "log", \
    "farthest step of a number that goes in its logarithm", \
    "chosen by judgement: a factor of 4.5, beyond which no slope predicts") \
  X(5, std::size_t, interval_n_groups, 3, "1", \
    "fewest windows, or runs, whose scatter gives an interval", \
    "two groups give a variance with one degree of freedom") \
  X(5, std::size_t, interval_n_blocks, 6, "1", \
    "stretches of one or two fitted runs that are left out in turn, where what is left hangs together", \
    "two drops each of five balls: of a gravity fitted to each, four pairs agree within two deviations, two before") \
  X(5, double, prior_reach, 4, "sigma", \
    "farthest a number with a prior goes as a number that is free in every model; farther it is an effect to be named", \
    "1 in 16000 of normal errors is larger") \
  X(5, double, student_freedom, 4, "1", \
    "degrees of freedom of the residuals' distribution", \
    "not recorded") \
  X(5, double, fit_small_change, 1e-3, "1", \
    "relative change of the cost at which a fit has converged", \
    "not recorded") \
  X(5, double, reduction_missed, 0.05, "1", \
    "deviation from the predicted change that makes sensitivities stale", \
    "sliding blocks with drag (commit 911d5e5)") \
  X(5, double, reduction_missed_floor, 0.02, "noise", \
    "deviation that never does", \
    "sliding blocks with drag (commit 911d5e5)") \
  X(5, double, window_scale_missed, 1.5, "1", \
    "scale of a window over that of all from which the last steps are repeated", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(5, double, unseen_change, 2e-3, "noise", \
    "change below which a parameter stays at its prior", \
    "not recorded (commit bac2ea0)") \
  X(5, double, difference_share, 0.03, "1", \
    "finite difference of a parameter over its distance from off", \
    "not recorded") \
  X(5, double, difference_share_pixels, 0.3, "1", \
    "the same where whole pixels are measured", \
    "a pendulum seen by a camera (commit 5303c3a)") \
  X(5, double, difference_start, 0.05, "sigma", \
    "finite difference of a start", \
    "sliding blocks with drag (commit 911d5e5)") \
  X(5, int, n_start_steps, 4, "1", \
    "steps where only starts are fitted", \
    "not recorded (commit 1f29049)") \
  X(5, Series, fit_dampings, (Series{1e-6, 0.5, 2.5, 8}), "diagonal", \
    "dampings of the steps that are tried", \
    "chosen by judgement, not measured") \
  X(5, double, step_gain_least, 0.75, "1", \
    "reduction of the cost over the predicted one from which damped steps are not tried", \
    "seed 23, case 008: above it the full step was the best of all, or within 0.3 % of the best") \
  X(5, double, start_damping, 0.1, "diagonal", \
    "damping of the starts that is tried besides none", \
    "chosen by judgement, not measured") \
  X(5, int, n_first_steps, 2, "1", \
    "steps of all fits before the finalists are chosen", \
    "not recorded") \
  X(5, int, n_more_steps, 10, "1", \
    "further steps of the finalists, and of a fit that is revised", \
    "sliding blocks with drag (commit 911d5e5)") \
  X(5, int, n_more_steps_large, 4, "1", \
    "the same in a large world: a further round moves them again", \
    "chosen by judgement, not measured") \
  X(5, int, n_last_steps, 2, "1", \
    "last steps, with one scale for all windows", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(5, std::size_t, n_finalists, 5, "1", \
    "candidates that are fitted to the end", \
    "not recorded") \
  X(5, std::size_t, n_finalists_large, 2, "1", \
    "the same in a large world", \
    "chosen by judgement, not measured") \
  X(5, double, finalist_behind_most, 100, "log-likelihood", \
    "how far a finalist may be behind the best", \
    "not recorded")
// clang-format on
