#include "host/identify/data/start_fit.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

// Numbers of the samples of component k, by their distance in time from t0 [s].
std::vector<std::pair<double, std::size_t>> samples_around(const std::vector<double>& t,
                                                           const std::vector<double>& values, std::size_t width,
                                                           std::size_t k, double t0) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::isfinite(values[i * width + k])) near.push_back({std::abs(t[i] - t0), i});
  std::sort(near.begin(), near.end());
  return near;
}

}  // namespace

LocalFit fit_around(const std::vector<double>& t, const std::vector<double>& values, std::size_t width, std::size_t k,
                    double t0, double sigma) {
  const std::vector<std::pair<double, std::size_t>> near = samples_around(t, values, width, k, t0);
  const std::size_t most = std::min(criteria().start_n_most, near.size());
  std::size_t n = std::min(criteria().start_n_least, near.size());
  while (n < most && near[n].first < criteria().start_fit_span / 2) ++n;
  LocalFit fit;
  if (n < 3) return fit;
  const auto system = [&](std::size_t n_rows) {
    std::pair<Eigen::MatrixXd, Eigen::VectorXd> of{Eigen::MatrixXd(n_rows, 3), Eigen::VectorXd(n_rows)};
    for (std::size_t i = 0; i < n_rows; ++i) {
      const double dt = t[near[i].second] - t0;
      of.first.row(Eigen::Index(i)) << 1, dt, dt * dt;
      of.second[Eigen::Index(i)] = values[near[i].second * width + k];
    }
    return of;
  };
  const auto [a, b] = system(n);
  const Eigen::Matrix3d normal = a.transpose() * a;
  Vec3 x = a.colPivHouseholderQr().solve(b);
  const Eigen::Matrix3d covariance = sigma * sigma * normal.completeOrthogonalDecomposition().pseudoInverse();
  if (t0 <= t.front() && most >= criteria().start_n_least) {
    const auto [wide, first] = system(most);
    const double mean = first.mean(), of_constant = (first.array() - mean).square().sum(),
                 of_parabola = (first - wide * wide.colPivHouseholderQr().solve(first)).squaredNorm();
    if (of_constant - of_parabola <= criteria().start_rest_most * sigma * sigma) x << mean, 0, 0;
  }
  return {x[0], x[1], std::sqrt(std::max(covariance(0, 0), 0.0)), std::sqrt(std::max(covariance(1, 1), 0.0)), true};
}

TurnFit turn_around(const Run& run, const std::vector<double>& values, double t0, double sigma) {
  TurnFit fit;
  const auto rotation = [&](std::size_t i) {
    const double* q = &values[4 * i];
    return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  };
  std::size_t nearest = run.t.size();
  for (std::size_t i = 0; i < run.t.size(); ++i)
    if (std::isfinite(values[4 * i]) &&
        (nearest == run.t.size() || std::abs(run.t[i] - t0) < std::abs(run.t[nearest] - t0)))
      nearest = i;
  if (nearest == run.t.size()) return fit;
  const Mat3 at = rotation(nearest);
  std::vector<double> turned(3 * run.t.size(), std::nan(""));
  for (std::size_t i = 0; i < run.t.size(); ++i) {
    if (!std::isfinite(values[4 * i]) || std::abs(run.t[i] - t0) > criteria().start_turn_span) continue;
    const Mat3 apart = rotation(i) * at.transpose();
    const Eigen::AngleAxisd turn(apart);
    Vec3::Map(&turned[3 * i]) = turn.angle() * turn.axis();
  }
  Vec3 value = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const LocalFit one = fit_around(run.t, turned, 3, k, t0, sigma);
    value[Eigen::Index(k)] = one.value;
    fit.spin[Eigen::Index(k)] = one.slope;
    fit.sigma = std::max(fit.sigma, one.value_sigma);
    fit.spin_sigma = std::max(fit.spin_sigma, one.slope_sigma);
  }
  fit.rotation =
      (value.norm() > 0 ? Eigen::AngleAxisd(value.norm(), value.normalized()).toRotationMatrix() : Mat3::Identity()) *
      at;
  return fit;
}

}  // namespace pvg::diagnose
