// Stage 7: the held-out runs, simulated without and with what was found.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "host/identify/fit/agreement.hpp"
#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

// Measured and simulated, of one channel's component over one window.
struct Curve {
  std::string run, channel, unit;
  bool is_held_out = false;
  std::vector<double> t, measured, before, after;  // [s], [unit]
  double sigma = 0;                                // of the noise [unit]
};

// A window that no model explains: someone pushed, a sensor failed.
struct Disturbance {
  std::string run;
  double start = 0, end = 0;     // [s]
  double before = 0, after = 0;  // [noise]
};

// The same runs simulated whole from their first state (whole_runs.hpp).
struct WholeRuns {
  double before = NAN, after = NAN, floor = 0;  // as HeldOut has them; NaN: not judged
  double seconds = 0;                           // of the longest that was simulated
  double growth = 0;                            // of the starts' measured errors [noise]
  std::string why_not;
  bool had_no_time = false;  // then nothing is proved: windows are enough only where whole runs cannot be judged
  bool is_judged() const { return std::isfinite(before) && std::isfinite(after); }
};

// How far a model is ahead of the nearest of its alternatives and of the model without its last effect (ahead_of).
struct Lead {
  double sigma = INFINITY;  // infinite: not asked for; NaN: no time, or no alternative
  std::string nearest;      // effects of that one
};

struct HeldOut {
  double before = 0, after = 0,
         floor = 0;                      // errors in the channels' unit, or in units of noise; floor: 0 if not judged
  std::vector<Disturbance> disturbed;    // are left out of these errors
  double before_all = 0, after_all = 0;  // with them
  std::vector<double> after_each;        // of the models that were kept, with one effect more each
  std::vector<Lead> lead;                // of these
  double mask_gap_before = NAN, mask_gap_after = NAN;  // 1 - mean intersection over union; NaN: no masks
  std::size_t kept = 0;                                // of the models that were given
  std::vector<Curve> curves;
  Agreement agreement;  // of the model that was kept with these runs
};

// Root mean square over the windows that count. in_noise: in units of noise, else in the channels' unit.
double error_in(const Problem& problem, const FitData& data, const std::vector<Eigen::VectorXd>& residual,
                const std::vector<bool>& counts, bool in_noise);

// Which windows count, by their residuals [n_windows][n_data, noise] before and after: not those that are left wrong by
// more than five times the median window and less than halved, if they are at most a tenth of all; else all. A window
// that became worse counts: the model is wrong there.
std::vector<bool> undisturbed(const std::vector<Eigen::VectorXd>& before, const std::vector<Eigen::VectorXd>& after);

// How much nearer to the data the residuals a are than b, two predictions of the same numbers, in standard deviations
// of noise of a's size, `correlated` numbers of which count as one (Vuong 1989, "Likelihood ratio tests for model
// selection and non-nested hypotheses"):
//   (|b|^2 - |a|^2) / (2 s sqrt(correlated) |b - a|),   s^2 the mean square of a, at least 1
double ahead_of(const std::vector<Eigen::VectorXd>& a, const std::vector<Eigen::VectorXd>& b, double correlated);

// The share of the gap that n effects close of which each closes `least` of what the others leave: 1 - (1 - least)^n.
double share_of_effects(double least, std::size_t n);

// selected: models with one effect more each; an effect stays only if it closes enough of the gap before it.
// Windows that are disturbed by the last of them count in none of the errors.
// alternatives: models that the fitting runs refuted, each beside one of `selected` with as many effects. They are
// simulated only where it depends on them whether that one is named (closes_enough): beside it alone enough is closed,
// with fewer effects it is not, and more than noise is left. length: of windows [s], 0: whole runs. in_noise: errors in
// units of noise, where channels have several units.
HeldOut judge_held_out(Fitter& fitter, const Problem& problem, double length, std::size_t most_windows,
                       const std::vector<Model>& selected, bool in_noise, const std::vector<Model>& alternatives = {});

std::vector<Curve> curves_of(const Problem& problem, const FitData& data, const Fit& before, const Fit& after,
                             std::size_t most);

inline constexpr std::size_t CURVES_OF_FITTED_RUNS = 4;  // in a report, beside those of held-out ones

// The share of a gap that was closed: 1 at the floor, 0 for none, less where it grew.
double closed(double before, double after, double floor);

}  // namespace pvg::diagnose
