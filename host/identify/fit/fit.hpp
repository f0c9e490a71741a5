// Stage 5: models fitted to windows by damped Gauss-Newton steps, all models side by side. The objective is Student's
// log-likelihood (4 degrees of freedom) of the residuals, so that single bad samples do not decide, plus the log priors
// of the windows' starts and of the parameters p:
//   C = sum_i 5/2 s^2 log(1 + r_i^2 / (4 s^2)) + sum_w sum_k delta_wk^2 / (2 sigma_wk^2)
//       + sum_p (x_p - off_p)^2 / (2 b_p^2)
// with r the residuals in units of noise, s their scale, at least 1, and delta_w the errors of the start of window w,
// which the linear system eliminates per window. Sensitivities to the starts differ between models, so they are renewed
// wherever the actual change of a step differs from the predicted one. On the way each window has its own scale s:
// while the model is wrong a window that it misses is no outlier. The last steps use one scale.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/criteria.hpp"

namespace pvg::diagnose {

// Candidates together, and the values of all their parameters one after the other. Nuisances come first.
struct Model {
  std::vector<const Candidate*> parts;
  Eigen::VectorXd x;
  Eigen::VectorXd scale;  // changes worth trying
  std::vector<const Parameter*> parameters() const;
  std::vector<const Candidate*> effects() const;  // the parts without nuisances
  Eigen::Index n_nuisances() const;               // so many come before the effects, and have one parameter each
};

// Each part with its parameters as it is tried first: `off`.
Model model_of(const std::vector<const Candidate*>& parts);

// The first one's parts, then the second one's.
Model joined(const Model& first, const Model& second);

// The base variant changed by a model.
Variant variant_of(const Variant& base, const Model& model);

// Windows with the sensitivities of their residuals to the unknowns of their starts, d r / d delta, in units of sigma.
struct FitData {
  std::vector<Window> windows;
  std::vector<Eigen::MatrixXd> of_start;  // [n_windows][n_data x n_unknowns]
  Model at = {};                          // where
};

// Whether the sensitivities to a window's start were found here, near by, or no longer predict what a step changes.
enum class StartSlope { here, near, stale };

struct Fit {
  Model model;
  std::vector<Eigen::VectorXd> delta;     // [n_windows][n_unknowns] in units of their sigma
  std::vector<Eigen::VectorXd> residual;  // [n_windows][n_data]
  std::vector<Eigen::MatrixXd> slope;     // [n_windows][n_data x n_parameters] d r / d x
  std::vector<Eigen::MatrixXd> of_start;  // [n_windows][n_data x n_unknowns] d r / d delta
  std::vector<StartSlope> start_slope;    // [n_windows]
  Eigen::MatrixXd covariance;             // of x
  double cost = 0, scale = 1;             // C; s of all windows
  std::vector<double> window_scale;       // [n_windows] s of each; empty: that of all
  bool succeeded = false;                 // simulated to the end of every window
  bool is_stale = true;                   // the slopes are not those of the present model
  bool has_converged = false;             // a step changes little
  bool is_given_up = false;               // it is not worth further steps
  bool is_far_behind = false;             // another one was better beyond doubt when it was given up
  bool is_open() const { return succeeded && !has_converged && !is_given_up; }
};

class Fitter {
 public:
  Fitter(Predictor& predictor, const Variant& base) : predictor_(predictor), base_(base) {}
  Clock::time_point& deadline() { return predictor_.deadline(); }  // of its simulations

  // The windows' sensitivities to their starts at a model, and the change by time steps of half the length there, which
  // is added to all residuals from then on if `corrects`. Windows that cannot be simulated to their end are left out.
  FitData prepare(std::vector<Window> windows, const Model& at, bool corrects = true);
  // What richardson_factor of their order would say, as it was measured in this scene.
  void correct_steps_by(std::optional<double> factor) { step_factor_ = factor; }
  // The scene without any effect: the numbers that are known with a standard deviation alone, at the values that fit
  // best. None at first.
  const Model& as_it_stands() const { return as_it_stands_; }
  void stand_at(Model model) { as_it_stands_ = std::move(model); }
  // From now on nothing is corrected for the length of the steps.
  void take_steps_as_they_are() { corrects_steps_ = false; }
  bool corrects_steps() const { return corrects_steps_; }
  // Likewise, with larger finite differences: masks change by whole pixels.
  void expect_whole_pixels() {
    corrects_steps_ = false;
    difference_ = criteria().difference_share_pixels;
  }
  // What was prepared already, about the starts of a fit of it instead of the measured ones, as the response of a body
  // that rests on something has kinks; as it is where these starts are are_good_enough.
  FitData prepared_nearer(FitData data, const Fit& fit);
  static bool are_good_enough(const Fit& starts);
  // How far that moves the start of each window [sigma], and the windows that begin there.
  static std::vector<Eigen::VectorXd> start_shifts(const Fit& starts);
  static std::vector<Window> with_moved_starts(std::vector<Window> windows, const std::vector<Eigen::VectorXd>& shifts);
  // Each model from where it is, starts fitted too, to the end. n_steps 0: only the starts are fitted.
  std::vector<Fit> fit(const FitData& data, std::vector<Model> models, int n_steps);
  // The same in parts: where the models are, with starts of all of them as in Fit, zeros where none are given; at most
  // n_steps from there, of those that have not converged; slopes and covariances there. `scale`: what is taken for an
  // outlier.
  enum class Scale { of_window, of_all };
  std::vector<Fit> begin(const FitData& data, std::vector<Model> models, std::vector<Eigen::VectorXd> starts = {});
  void improve(const FitData& data, std::vector<Fit>& fits, int n_steps, Scale scale = Scale::of_window,
               bool only_starts = false);
  // Residuals of each fit as a full step from where it is predicts them; of fits that are done as they are.
  std::vector<std::vector<Eigen::VectorXd>> predicted(const FitData& data, std::vector<Fit>& fits);
  // The last steps, with outliers as of all windows, and conclude.
  void finish(const FitData& data, std::vector<Fit>& fits);
  void take_last_steps(const FitData& data, std::vector<Fit>& fits);
  void conclude(const FitData& data, std::vector<Fit>& fits);
  // Residuals at given models; delta as in Fit, empty: zeros.
  std::vector<std::vector<Prediction>> evaluate(const FitData& data, const std::vector<Model>& models,
                                                const std::vector<std::vector<Eigen::VectorXd>>& delta,
                                                bool wants_phases = false);

 private:
  struct Trials {
    std::vector<Model> models;
    std::vector<std::vector<Eigen::VectorXd>> delta;
    std::vector<std::size_t> owner;              // number of the fit
    std::vector<std::vector<Prediction>> found;  // [n_trials][n_windows]; empty: not simulated yet
    void add(Model model, std::vector<Eigen::VectorXd> start, std::size_t of_fit, std::vector<Prediction> known = {}) {
      models.push_back(std::move(model));
      delta.push_back(std::move(start));
      owner.push_back(of_fit);
      found.push_back(std::move(known));
    }
  };
  struct Attempt {  // a model that was tried, with the best starts found there
    Model model;
    std::vector<Eigen::VectorXd> delta, residual;
    std::size_t owner = 0;
    double cost = 0;
  };
  // Steps (fit_trials.cpp). Then: renews slopes and sensitivities to the starts that are stale (fit_slopes.cpp).
  enum class Which { open, all, open_starts };
  void differentiate(const FitData& data, std::vector<Fit>& fits, Which which);
  enum class Steps { full, damped };
  void add_trials(const Fit& fit, std::size_t owner, bool only_starts, Steps steps, Trials& trials) const;
  void simulate(const FitData& data, Trials& trials);
  Trials steps_of(const FitData& data, const std::vector<Fit>& fits, bool only_starts);
  static std::vector<Attempt> attempts_of(const Trials& trials, const std::vector<Fit>& fits);
  Trials corrected(const std::vector<Attempt>& attempts, const std::vector<Fit>& fits) const;
  std::vector<char> take_best(const FitData& data, const Trials& trials, std::vector<Fit>& fits);
  Predictor& predictor_;
  const Variant& base_;
  Model as_it_stands_;
  bool corrects_steps_ = true;
  std::optional<double> step_factor_;
  double difference_ = criteria().difference_share;  // by which slopes are found, of how far a parameter is from "off"
};

// The part of `change` that no shift of each window's start removes.
Eigen::VectorXd beside_starts(const Eigen::MatrixXd& of_start, const Eigen::VectorXd& change);

// The variant with steps of half the length.
Variant refined(const Variant& variant);

// 1.48 times the median of |r|, at least 1.
double robust_scale(const std::vector<Eigen::VectorXd>& residual);
double robust_cost(const std::vector<Eigen::VectorXd>& residual, double scale);
// robust_scale of each window alone
std::vector<double> window_scales(const std::vector<Eigen::VectorXd>& residual);
double robust_cost(const std::vector<Eigen::VectorXd>& residual, const std::vector<double>& scales);
// Root of the mean square of all residuals.
double rms(const std::vector<Eigen::VectorXd>& residual);

// The normal equations of one fit with the windows' starts eliminated. parts: per window.
struct Reduced {
  std::vector<Eigen::MatrixXd> a;  // [n_windows][p x p]
  std::vector<Eigen::VectorXd> g;  // [n_windows][p]
  Eigen::MatrixXd sum_a() const;
  Eigen::VectorXd sum_g() const;
};
Reduced reduce(const Fit& fit);
// The change of a window's start that fits best when the parameters change by dx; damping: Levenberg and Marquardt's.
Eigen::VectorXd best_start(const Fit& fit, std::size_t window, const Eigen::VectorXd& dx, double damping = 0);

}  // namespace pvg::diagnose
