#include "host/identify/fit/fit_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "host/base/statistics.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/fit/left_out_blocks.hpp"
#include "host/identify/fit/normal_equations.hpp"
#include "host/identify/fit/prior.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

VectorXd weights_of(const VectorXd& r, double s) {
  return (1.0 / (1.0 + r.array().square() / (criteria().student_freedom * s * s))).matrix() *
         ((criteria().student_freedom + 1) / criteria().student_freedom);
}

// the system of one window's start
struct StartSystem {
  MatrixXd weighted;             // W U
  Eigen::LDLT<MatrixXd> factor;  // of U^T W U + 1
};

StartSystem start_system(const Fit& fit, std::size_t w, double damping = 0) {
  const MatrixXd& u = fit.of_start[w];
  StartSystem system;
  system.weighted = weights_of(fit.residual[w], scale_of(fit, w)).asDiagonal() * u;
  MatrixXd a = u.transpose() * system.weighted + MatrixXd::Identity(u.cols(), u.cols());
  a.diagonal() *= 1 + damping;
  system.factor.compute(a);
  return system;
}

}  // namespace

double start_cost(const std::vector<VectorXd>& delta) {
  double sum = 0;
  for (const VectorXd& d : delta) sum += 0.5 * d.squaredNorm();
  return sum;
}

double prior_cost(const Model& model) {
  const std::vector<const Parameter*> parameters = model.parameters();
  double sum = 0;
  for (Eigen::Index i = 0; i < model.x.size(); ++i) sum += prior_cost(*parameters[std::size_t(i)], model.x[i]);
  return sum;
}

double scale_of(const Fit& fit, std::size_t w) { return fit.window_scale.empty() ? fit.scale : fit.window_scale[w]; }

double cost_of(const Fit& fit) {
  double cost = start_cost(fit.delta) + prior_cost(fit.model);
  for (std::size_t w = 0; w < fit.residual.size(); ++w) cost += robust_cost({fit.residual[w]}, scale_of(fit, w));
  return cost;
}

double robust_scale(const std::vector<VectorXd>& residual) {
  std::vector<double> all;
  for (const VectorXd& r : residual)
    for (const double value : r)
      if (std::isfinite(value)) all.push_back(std::abs(value));
  if (all.empty()) return 1;
  return std::max(1.0, SIGMA_OVER_MEDIAN * upper_median(std::move(all)));
}

double robust_cost(const std::vector<VectorXd>& residual, double s) {
  double sum = 0;
  for (const VectorXd& r : residual)
    sum += 0.5 * (criteria().student_freedom + 1) * s * s *
           (1.0 + r.array().square() / (criteria().student_freedom * s * s)).log().sum();
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

std::vector<double> window_scales(const std::vector<VectorXd>& residual) {
  std::vector<double> scales;
  for (const VectorXd& r : residual) scales.push_back(robust_scale({r}));
  return scales;
}

double robust_cost(const std::vector<VectorXd>& residual, const std::vector<double>& scales) {
  double sum = 0;
  for (std::size_t w = 0; w < residual.size(); ++w) sum += robust_cost({residual[w]}, scales[w]);
  return sum;
}

double rms(const std::vector<VectorXd>& residual) {
  double sum = 0, n = 0;
  for (const VectorXd& r : residual) {
    sum += r.squaredNorm();
    n += double(r.size());
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

MatrixXd Reduced::sum_a() const {
  MatrixXd sum = MatrixXd::Zero(a[0].rows(), a[0].cols());
  for (const MatrixXd& one : a) sum += one;
  return sum;
}

VectorXd Reduced::sum_g() const {
  VectorXd sum = VectorXd::Zero(g[0].size());
  for (const VectorXd& one : g) sum += one;
  return sum;
}

Reduced reduce(const Fit& fit) {
  Reduced reduced;
  for (std::size_t w = 0; w < fit.residual.size(); ++w) {
    const MatrixXd& j = fit.slope[w];
    const StartSystem start = start_system(fit, w);
    const MatrixXd wj = weights_of(fit.residual[w], scale_of(fit, w)).asDiagonal() * j;
    const MatrixXd cross = start.weighted.transpose() * j;
    MatrixXd a = j.transpose() * wj;
    VectorXd g = wj.transpose() * fit.residual[w];
    if (cross.rows() > 0) {
      a -= cross.transpose() * start.factor.solve(cross);
      g -= cross.transpose() * start.factor.solve(start.weighted.transpose() * fit.residual[w] + fit.delta[w]);
    }
    reduced.a.push_back(a);
    reduced.g.push_back(g);
  }
  return reduced;
}

VectorXd best_start(const Fit& fit, std::size_t w, const VectorXd& dx, double damping) {
  if (fit.of_start[w].cols() == 0) return VectorXd();
  const StartSystem start = start_system(fit, w, damping);
  VectorXd r = fit.residual[w];
  if (dx.size() > 0) r += fit.slope[w] * dx;
  return -start.factor.solve(start.weighted.transpose() * r + fit.delta[w]);
}

namespace {

// Variances of the parameters by the scatter of their scores between groups; none where there are too few groups.
VectorXd sandwich_of(const MatrixXd& inverse, const std::vector<VectorXd>& scores) {
  const double n = double(scores.size());
  if (scores.size() < criteria().interval_n_groups) return VectorXd::Zero(inverse.rows());
  VectorXd mean = VectorXd::Zero(inverse.rows());
  for (const VectorXd& g : scores) mean += g / n;
  MatrixXd scatter = MatrixXd::Zero(inverse.rows(), inverse.rows());
  for (const VectorXd& g : scores) scatter += (g - mean) * (g - mean).transpose();
  return VectorXd((inverse * scatter * inverse * (n / (n - 1))).diagonal());
}

// The normal equations of a fit, priors included, with the share of the windows' corrections for the time step as one
// number more, the last.
struct WithStepShare {
  MatrixXd a;
  VectorXd g;
};

std::optional<WithStepShare> with_step_share(const Fit& fit, const std::vector<Window>& windows) {
  const Eigen::Index n = fit.model.x.size();
  Fit wider = fit;
  bool any_corrected = false;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const VectorXd& correction = windows[w].correction;
    wider.slope[w].conservativeResize(fit.residual[w].size(), n + 1);
    wider.slope[w].col(n).setZero();
    if (correction.size() == 0) continue;
    wider.slope[w].col(n) = correction;
    any_corrected = true;
  }
  if (!any_corrected) return std::nullopt;
  const Reduced reduced = reduce(wider);
  WithStepShare system{reduced.sum_a(), reduced.sum_g()};
  const std::vector<const Parameter*> parameters = fit.model.parameters();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Parameter& p = *parameters[std::size_t(i)];
    const double weight = prior_weight(p, fit.model.x[i]);
    system.a(i, i) += weight;
    system.g[i] += weight * (fit.model.x[i] - p.off);
  }
  system.a(n, n) += 1;  // a correction is as large as it was found, give or take itself
  return system;
}

// What the correction for the time step may be wrong by, in the parameters:
//   e = A^-1 b (d^2 + v)^1/2,   d = -(g_c - b^T A^-1 g) v,   v = (c - b^T A^-1 b)^-1
// with the normal equations [A b; b^T c] of the parameters and of the correction's share, and their gradients g and
// g_c: d is how far from 1 the residuals want that share, v its variance. `inverse`: of A.
VectorXd step_error_of(const Fit& fit, const std::vector<Window>& windows, const MatrixXd& inverse, double correlated) {
  const Eigen::Index n = fit.model.x.size();
  const std::optional<WithStepShare> system = with_step_share(fit, windows);
  if (!system) return VectorXd::Zero(n);
  const VectorXd b = system->a.col(n).head(n), by_share = inverse * b;
  const double v = 1 / (system->a(n, n) - b.dot(by_share));
  const double d = -v * (system->g[n] - by_share.dot(system->g.head(n)));
  return by_share * std::sqrt(d * d + v * fit.scale * fit.scale * correlated);
}

}  // namespace

MatrixXd covariance_of(const Fit& fit, const std::vector<Window>& windows, double correlated) {
  const Reduced reduced = reduce(fit);
  MatrixXd a = reduced.sum_a();
  const std::vector<const Parameter*> parameters = fit.model.parameters();
  for (Eigen::Index i = 0; i < a.rows(); ++i) a(i, i) += prior_weight(*parameters[std::size_t(i)], fit.model.x[i]);
  const MatrixXd inverse = inverse_in_own_units(a);
  std::map<int, VectorXd> of_run;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const auto [at, is_new] = of_run.try_emplace(windows[w].run, reduced.g[w]);
    if (!is_new) at->second += reduced.g[w];
  }
  std::vector<VectorXd> runs;
  for (const auto& [run, g] : of_run) runs.push_back(g);
  MatrixXd both = inverse * fit.scale * fit.scale * correlated;
  both.diagonal() = both.diagonal().cwiseMax(sandwich_of(inverse, reduced.g)).cwiseMax(sandwich_of(inverse, runs));
  if (runs.size() < criteria().interval_n_groups && correlated > 1)
    both.diagonal() = both.diagonal().cwiseMax(left_out_blocks(fit, windows, a, correlated));
  const VectorXd step_error = step_error_of(fit, windows, inverse, correlated);
  return both + step_error * step_error.transpose();
}

VectorXd moved_by_correction(const Fit& fit, const std::vector<Window>& windows) {
  const Eigen::Index n = fit.model.x.size();
  const std::optional<WithStepShare> system = with_step_share(fit, windows);
  if (!system) return VectorXd::Zero(n);
  const MatrixXd inverse = inverse_in_own_units(system->a.topLeftCorner(n, n));
  const VectorXd by = inverse * system->a.col(n).head(n), least = VectorXd::Constant(n, 1e-300);
  return by.cwiseQuotient(fit.scale * inverse.diagonal().cwiseMax(least).cwiseSqrt());
}

}  // namespace pvg::diagnose
