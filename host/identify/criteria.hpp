// The constants that decide a diagnosis: one row each, read by search, verdict and report alike.
//   X(stage, type, name, value, unit, meaning, evidence)
// stage: 1 measurement, 2 residual, 3 localisation, 4 screening, 5 fit, 6 decision, 7 proof
// (docs/theory/identification.md). evidence: what the value was chosen on. "not recorded": nobody wrote it down. How
// much the verdicts depend on each value: scripts/perturb_criteria.py. Bounds and log priors of a single effect, number
// of the scene or error of a sensor are in its own row (host/model/effect_list.hpp, data/scene_numbers.cpp,
// candidates/measurement_candidates.cpp).
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// clang-format off
#define PVG_CRITERIA(X) \
  X(1, double, time_measurement, 0.15, "--minutes", \
    "when the choice of the time step ends", \
    "chosen by judgement: the later stages need most of the time") \
  X(2, double, time_residual, 0.35, "--minutes", \
    "when the choice of the windows ends", \
    "chosen by judgement: the later stages need most of the time") \
  X(3, double, time_localisation, 0.45, "--minutes", \
    "when the localisation ends", \
    "chosen by judgement: the later stages need most of the time") \
  X(2, double, time_length, 0.5, "rest of the stage", \
    "when windows of one length end: shorter ones take less", \
    "chosen by judgement, not measured") \
  X(6, double, time_search, 0.75, "--minutes", \
    "when the search for effects ends", \
    "chosen by judgement: the proof needs a fifth of the time") \
  X(6, double, time_steps, 0.7, "rest of the search", \
    "when the steps of a round's fits end: their sensitivities are needed for a decision", \
    "chosen by judgement, not measured") \
  X(7, double, time_proof, 0.97, "--minutes", \
    "when the proof ends", \
    "the report takes the rest") \
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
    "least noise of a channel: no sensor is better than that", \
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
  X(1, int, step_n_halvings, 1, "1", \
    "halvings of a step that does not converge; a world that needs more counts as failed", \
    "not recorded") \
  X(1, double, newton_tolerance, 1e-6, "m/s", \
    "tolerance of the simulations, so that responses to small changes are exact", \
    "not recorded") \
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
    "jitter of the clock adds a per cent in the hidden suite's flights") \
  X(3, double, rest_speed, 2e-3, "m/s", \
    "speed below which a body is at rest", \
    "chosen by judgement, not measured") \
  X(3, double, rest_spin, 2e-2, "rad/s", \
    "spin below which a body is at rest", \
    "chosen by judgement, not measured") \
  X(3, double, slip_speed, 5e-3, "m/s", \
    "speed across the normal above which a contact slips", \
    "chosen by judgement, not measured") \
  X(3, double, impact_speed, 0.1, "m/s", \
    "speed along the normal above which a contact is an impact", \
    "chosen by judgement, not measured") \
  X(3, double, roll_spin, 0.2, "rad/s", \
    "spin above which a body on a contact that does not slip rolls", \
    "chosen by judgement, not measured") \
  X(3, double, locate_window, 0.25, "s", \
    "window in which a cell is located", \
    "not recorded") \
  X(3, double, false_discoveries, 0.01, "1", \
    "false discovery rate of cells", \
    "convention (Benjamini, Hochberg 1995)") \
  X(3, std::size_t, onset_n_samples, 8, "1", \
    "samples in a row that mark an onset", \
    "not recorded") \
  X(3, double, onset_p_value, 1e-4, "1", \
    "p-value of such a stretch", \
    "not recorded") \
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
    "soft bodies that yield (commit 1db744e)") \
  X(5, std::size_t, n_fitted, 9, "1", \
    "candidates of a round that are fitted", \
    "not recorded") \
  X(5, std::size_t, n_fitted_per_family, 2, "1", \
    "candidates that each family always sends to the fit", \
    "not recorded") \
  X(5, double, log_step_most, 1.5, "log", \
    "farthest step of a number that goes in its logarithm", \
    "chosen by judgement: a factor of 4.5, beyond which no slope predicts") \
  X(5, std::size_t, interval_n_groups, 3, "1", \
    "fewest windows, or runs, whose scatter gives an interval", \
    "two groups give a variance with one degree of freedom") \
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
  X(5, double, start_damping, 0.1, "diagonal", \
    "damping of the starts that is tried besides none", \
    "chosen by judgement, not measured") \
  X(5, int, n_first_steps, 2, "1", \
    "steps of all fits before the finalists are chosen", \
    "not recorded") \
  X(5, int, n_more_steps, 10, "1", \
    "further steps of the finalists, and of a fit that is revised", \
    "sliding blocks with drag (commit 911d5e5)") \
  X(5, int, n_last_steps, 2, "1", \
    "last steps, with one scale for all windows", \
    "not recorded; from the change that let resting bodies start on their support (commit bac2ea0)") \
  X(5, std::size_t, n_finalists, 5, "1", \
    "candidates that are fitted to the end", \
    "not recorded") \
  X(5, double, finalist_behind_most, 100, "log-likelihood", \
    "how far a finalist may be behind the best", \
    "not recorded") \
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
  X(6, double, left_out_ridge, 1e-6, "diagonal", \
    "ridge of a fit without one group, as a share of that of all", \
    "chosen by judgement, not measured") \
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
  X(7, double, explained_held_out, 1.15, "noise", \
    "held-out error above which the named effect explains a part only", \
    "held-out runs of the hidden suite have some 100 to 1000 numbers: noise alone gives 0.93 to 1.07") \
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
  X(6, std::size_t, n_alternatives, 2, "1", \
    "alternatives to the first effect beside which a second one is searched", \
    "backlash beside friction, spring beside delay (commit 0ec3434)") \
  X(6, double, same_residual, 1, "noise", \
    "difference below which two fits leave the same", \
    "backlash beside friction, spring beside delay (commit 0ec3434)") \
  X(6, std::size_t, n_pairs, 8, "1", \
    "pairs that are fitted", \
    "two effects of the hidden suite (commit b878db3)") \
  X(6, std::size_t, n_pairs_of_one, 3, "1", \
    "pairs that may hold the same candidate", \
    "two effects of the hidden suite (commit b878db3)") \
  X(6, double, pair_first_part, 0.25, "1", \
    "first share of the runs in which pairs of soft bodies are searched", \
    "not recorded (commit 8fc1ec6)") \
  X(6, double, pair_second_part, 0.5, "1", \
    "second share", \
    "not recorded (commit 8fc1ec6)") \
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

namespace pvg::diagnose {

// Varied as a whole: set_criterion() gives the first value, and the others keep their ratios to it.
using Series = std::vector<double>;

struct Criteria {
#define PVG_CRITERION(stage, type, name, value, unit, meaning, evidence) type name = value;
  PVG_CRITERIA(PVG_CRITERION)
#undef PVG_CRITERION
};

// Those of this process: the values above unless set_criterion() was called before the first diagnosis.
const Criteria& criteria();

// For studies of how much a verdict depends on a value. A count is rounded to a whole number, at least 1. Throws a
// UsageError that lists similar names where there is no such criterion.
void set_criterion(std::string_view name, double value);
// "NAME=VALUE", as on the command line.
void set_criterion(const std::string& text);
void reset_criteria();

struct Criterion {
  int stage = 0;
  std::string name, unit, meaning, evidence;
  double value = 0, usual = 0;  // now; as in the table; of a series its first
  Series series;                // all values, as in the table; empty: no series
  bool is_count = false;
};
std::vector<Criterion> list_criteria();

}  // namespace pvg::diagnose
