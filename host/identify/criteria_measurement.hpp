// The constants that decide a diagnosis, of stage 1: rows of the table in host/identify/criteria.hpp.
#pragma once

// clang-format off
#define PVG_CRITERIA_MEASUREMENT(X) \
  X(1, double, time_measurement, 0.15, "--minutes", \
    "when the choice of the time step ends", \
    "chosen by judgement: the later stages need most of the time") \
  X(1, double, noise_white_correlation, -0.5, "1", \
    "third differences of neighbours that correlate by less are those of white noise", \
    "white noise gives -15/20, a smooth motion up to 1") \
  X(1, std::size_t, noise_n_neighbours, 8, "1", \
    "fewest third differences of neighbouring samples that give a noise", \
    "not recorded") \
  X(1, std::size_t, noise_n_apart, 100, "1", \
    "fewest third differences of samples further apart that give a noise", \
    "falls seen by video (commit 6ac6366)") \
  X(1, double, noise_smoothed, 2, "1", \
    "noise of samples apart over that of neighbours from which a channel counts as smoothed", \
    "not recorded") \
  X(1, double, noise_assumed, 1e-2, "range", \
    "noise of a channel whose noise cannot be measured", \
    "not recorded") \
  X(1, double, run_noise_scale, 2, "1", \
    "noise of a run over its channel's from which the run has a noise of its own", \
    "the DFKI pendulum, one run of which was pushed by hand (commit 39d942d)") \
  X(1, unsigned, noise_lag_most, 8, "samples", \
    "longest distance between the samples of a difference: 1, 2, 3, 4, 6, 8, ...", \
    "chosen by judgement, not measured") \
  X(1, double, noise_cut, 3, "typical size", \
    "size at which differences are cut before they are correlated", \
    "chosen by judgement, not measured") \
  X(1, double, noise_least, 1e-4, "range", \
    "least noise of a channel that does not show its noise", \
    "chosen by judgement, not measured") \
  X(1, double, noise_least_white, 1e-5, "range", \
    "the same where it is white and more than its digits", \
    "an encoder that counts seven turns: 44 rad and 1.3 mrad of noise (new scenarios, seed 51, case 007)") \
  X(1, double, noise_over_digits, 2, "1", \
    "noise over that of the last digit from which it is more than its digits", \
    "chosen by judgement, not measured") \
  X(1, double, noise_floor, 1e-9, "channel's", \
    "least noise of a channel that does not move", \
    "chosen by judgement, not measured") \
  X(1, std::size_t, noise_segment, 64, "samples", \
    "length of the segments whose spectra are averaged", \
    "chosen by judgement, not measured") \
  X(1, double, noise_supposed, 10, "1", \
    "error over the noise that is supposed where runs agree because of a noise that nobody knows", \
    "the stronger effects of the hidden suite have ten times the noise") \
  X(1, std::size_t, quantum_n_least, 20, "1", \
    "fewest unequal neighbours from which a quantum is found", \
    "chosen by judgement, not measured") \
  X(1, double, quantum_near_whole, 0.05, "quantum", \
    "distance from a whole number within which a step is a multiple of the quantum", \
    "chosen by judgement, not measured") \
  X(1, double, quantum_n_most, 1000, "1", \
    "largest such multiple", \
    "chosen by judgement, not measured") \
  X(1, double, quantum_share, 0.9, "1", \
    "share of the steps that must be multiples of the quantum", \
    "chosen by judgement, not measured") \
  X(1, double, start_fit_span, 0.1, "s", \
    "span of the samples that give a start and its rate", \
    "not recorded") \
  X(1, std::size_t, start_n_least, 5, "1", \
    "fewest samples that give a start", \
    "not recorded") \
  X(1, std::size_t, start_n_most, 15, "1", \
    "most samples that give a start", \
    "not recorded") \
  X(1, double, start_rest_most, 9, "1", \
    "gain in chi-squared of a parabola over a constant up to which a run begins at rest", \
    "two numbers more gain 9.2 by chance once in a hundred") \
  X(1, double, start_turn_span, 1, "s", \
    "time from the start within which orientations are read", \
    "chosen by judgement, not measured") \
  X(1, double, start_unmeasured_turn, 0.3, "rad", \
    "sigma of a start that no channel measures, of a revolute joint", \
    "chosen by judgement, not measured") \
  X(1, double, start_unmeasured_shift, 0.03, "m", \
    "the same of a prismatic joint", \
    "chosen by judgement, not measured") \
  X(1, double, start_unmeasured_rate, 3, "1/s", \
    "sigma of its rate over that of its start", \
    "chosen by judgement, not measured") \
  X(1, double, start_looseness, 20, "1", \
    "sigma of a start over what its samples give: a wrong model must not be held in place by it", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(1, double, settle_time, 0.06, "s", \
    "time that is simulated to see what a body rests on", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(1, double, settle_speed, 2e-3, "m/s", \
    "speed along the normal after that time below which a body rests", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(1, double, support_same_normal, 0.9, "1", \
    "cosine from which contact normals belong to one plane", \
    "not recorded") \
  X(1, double, support_face_width, 0.1, "1", \
    "width over length of a support from which it is a face and no edge", \
    "not recorded") \
  X(1, double, support_sigma, 4, "sigma", \
    "a measured start farther from rest than this does not rest", \
    "not recorded") \
  X(1, double, support_covered, 0.5, "1", \
    "share of a direction that unknowns must cover for it to count as measured", \
    "chosen by judgement, not measured") \
  X(1, double, support_direction_left, 0.3, "1", \
    "length left of a unit direction without its part along the normal, below which it is dropped", \
    "three unit vectors that span space leave two longer ones, or one") \
  X(1, int, video_n_paths, 32768, "1", \
    "paths of a picture, about", \
    "the luminance of a cell is then good to a per cent") \
  X(1, int, video_samples_most, 256, "1", \
    "most paths of a pixel", \
    "chosen by judgement, not measured") \
  X(1, std::uint32_t, video_n_noise, 8, "1", \
    "pictures of one state from which the renderer's noise is measured", \
    "chosen by judgement, not measured") \
  X(1, double, drive_memory, 2, "s", \
    "longest history of a drive that is computed before a window", \
    "not recorded") \
  X(1, double, step_window, 1, "s", \
    "length of the windows in which time steps are compared", \
    "chosen by judgement, not measured") \
  X(1, std::size_t, step_n_windows, 3, "1", \
    "how many of them", \
    "chosen by judgement, not measured") \
  X(1, double, step_kept_share, 0.9, "1", \
    "share of the smallest differences that are compared: an impact one step earlier is no error of the motion", \
    "chosen by judgement, not measured") \
  X(1, double, cg_tolerance_most, 1e-8, "1", \
    "largest relative residual of conjugate gradients, so that responses to small changes are exact", \
    "chosen by judgement, not measured") \
  X(1, double, step_error_most, 2.5, "noise", \
    "error of the integration up to which the scene's step is kept and corrected", \
    "not recorded (commit 3058b6d)") \
  X(1, double, step_error_most_dissipative, 0.4, "noise", \
    "the same where joints dissipate, whose error is of first order", \
    "not recorded") \
  X(1, double, step_error_most_extrapolated, 1, "noise", \
    "the same of two extrapolated steps, in the run that needs it most: there a fast spin is not of third order yet", \
    "seed 37, case 022: 8.3 became 2.2 by half the step, where the third order gives 1.0; with 2.5 over all runs no null") \
  X(1, double, step_error_most_masks, 0.3, "noise", \
    "the same where masks are measured, whose error is not corrected", \
    "the two camera cases of data/hidden (commit 894648e)") \
  X(1, double, step_error_pixels, 1, "noise", \
    "error of masks that whole pixels alone explain", \
    "a pendulum seen by a camera (commit 5303c3a)") \
  X(1, double, step_quiet_column, 0.1, "1", \
    "error of a column over the largest one below which the column does not move", \
    "not recorded (commit 4a03c1c)") \
  X(1, double, step_converges, 0.6, "1", \
    "error after a halving of the step over that before, up to which the steps converge", \
    "hard impacts; first order gives 1/2 (commits bde408a, 0c3d581)") \
  X(1, int, step_n_refinements, 3, "1", \
    "most halvings of the scene's step", \
    "hard impacts (commit bde408a); with 2 a flywheel that a known torque turns by 27 rad was no null for its step") \
  X(1, double, late_clock_most, 0.06, "s", \
    "time simulated beyond a window's end, for clocks and sensors that are late", \
    "not recorded") \
  X(1, double, far_misfit_least, 30, "noise", \
    "misfit from which numbers of the scene are tried factors away before the time step is chosen", \
    "chosen by judgement, not measured") \
  X(1, double, far_leaves_most, 0.1, "1", \
    "share of that misfit which such a number may leave, alone and from measured starts", \
    "chosen by judgement, not measured") \
  X(1, std::size_t, far_n_refinements, 3, "1", \
    "how often it is looked for between the neighbours of its best value", \
    "factors of 4 become 1.6, 1.17 and 1.05, which a swing of some periods tells apart") \
  X(1, std::size_t, far_n_between, 2, "1", \
    "values on either side of the best one", \
    "three parts of each interval") \
  X(1, double, step_moved_most, 2, "sigma", \
    "how far half the step may move a number, to first order, before it is fitted with it", \
    "chosen by judgement, not measured") \
  X(1, int, step_n_polished, 2, "1", \
    "most halvings of the step for the numbers of what was found", \
    "chosen by judgement, not measured") \
  X(1, int, step_n_halvings, 1, "1", \
    "halvings of a step that does not converge; a world that needs more counts as failed", \
    "not recorded") \
  X(1, double, newton_tolerance, 1e-6, "m/s", \
    "tolerance of the simulations, so that responses to small changes are exact", \
    "not recorded")
// clang-format on
