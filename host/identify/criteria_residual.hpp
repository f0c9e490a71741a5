// The constants that decide a diagnosis, of stage 2: rows of the table in host/identify/criteria.hpp.
#pragma once

// clang-format off
#define PVG_CRITERIA_RESIDUAL(X) \
  X(2, double, time_residual, 0.35, "--minutes", \
    "when the choice of the windows ends", \
    "chosen by judgement: the later stages need most of the time") \
  X(2, double, time_length, 0.5, "rest of the stage", \
    "when windows of one length end: shorter ones take less", \
    "chosen by judgement, not measured") \
  X(2, double, simulated_seconds, 12, "s", \
    "simulated time of all windows of one evaluation, about", \
    "not recorded") \
  X(2, double, n_worlds_most, 208, "1", \
    "worlds of a derivative by all starts, twice where bodies can collide", \
    "a pair of effects in flight (commit 8ba33ac)") \
  X(2, std::size_t, n_windows_least, 4, "1", \
    "fewest windows", \
    "not recorded") \
  X(2, std::size_t, n_windows_most, 40, "1", \
    "most windows", \
    "not recorded") \
  X(2, double, whole_run_longest, 8, "s", \
    "longest run that is one window", \
    "not recorded") \
  X(2, Series, window_lengths, (Series{2, 1, 0.5, 0.25}), "s", \
    "lengths of windows, tried after whole runs", \
    "chosen by judgement, not measured") \
  X(2, double, window_longest_share, 0.8, "longest run", \
    "longest window besides whole runs", \
    "chosen by judgement, not measured") \
  X(2, double, window_missing, 0.25, "window", \
    "what the last window of a run may lack", \
    "chosen by judgement, not measured") \
  X(2, double, window_coherent, 0.35, "signal", \
    "misfit up to which a window can be linearised", \
    "not recorded") \
  X(2, double, window_coherent_floor, 3, "noise", \
    "misfit that always counts as small enough", \
    "not recorded") \
  X(2, double, windows_coherent_share, 0.75, "1", \
    "share of the windows that must be coherent", \
    "not recorded") \
  X(2, double, window_hopeless, 2, "1", \
    "times window_coherent beyond which better starts do not help", \
    "not recorded (commit 0c3d581)") \
  X(2, double, start_good_enough, 1.1, "noise", \
    "residuals below which measured starts are kept", \
    "bodies that rest on something (commit 6f0c4d0)") \
  X(2, double, start_shift_most, 4, "measured sigma", \
    "how far the start of a window that is prepared anew may move", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(2, double, step_correction_most, 5, "noise", \
    "largest error of the integration that is corrected", \
    "not recorded (commit 3058b6d)") \
  X(2, Series, agreement_blocks, (Series{1, 4, 16, 64, 256}), "samples", \
    "lengths of the blocks whose sums are compared with the noise", \
    "a drift of a third of the noise over 2000 samples shows in those of 256") \
  X(2, double, noise_third_differences, 1.53, "1/sqrt(n)", \
    "relative standard deviation of a noise that is measured from the third differences of n samples", \
    "simulated: 2000 series of white noise of 100 to 3000 samples give 1.49 to 1.53") \
  X(2, double, agrees_sigma, 4.5, "sigma", \
    "excess of the residuals over the noise above which scene and runs disagree", \
    "some 50 tests of a diagnosis, each 3e-6: a null is called a misfit once in 6000") \
  X(2, double, agrees_rms, 1.15, "noise", \
    "error that a time step which is not corrected may give", \
    "masks, and hard impacts (commit bde408a)") \
  X(2, double, step_error_left, 0.1, "correction", \
    "what may be left of the time step's error after its correction", \
    "with 0.25 two weak frictions of a pendulum (1.10 times the noise, 3000 samples) were missed, with 0.1 both named") \
  X(2, double, noise_given_uncertainty, 0.01, "1", \
    "relative standard deviation of a noise that is given", \
    "jitter of the clock adds a per cent in the hidden suite's flights")
// clang-format on
