#include "host/identify/data/start_fit.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

struct Sample {
  double after, value;  // of t0 [s]
};

// Component k of the channel, nearest to t0 first.
std::vector<Sample> samples_around(const std::vector<double>& t, const std::vector<double>& values, std::size_t width,
                                   std::size_t k, double t0) {
  std::vector<Sample> near;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::isfinite(values[i * width + k])) near.push_back({t[i] - t0, values[i * width + k]});
  std::stable_sort(near.begin(), near.end(),
                   [](const Sample& a, const Sample& b) { return std::abs(a.after) < std::abs(b.after); });
  return near;
}

constexpr Eigen::Index PARABOLA = 3, QUARTIC = 5;  // numbers of a polynomial

struct Polynomial {
  LocalFit fit;
  double left = 0;  // what it leaves, squares summed
  Eigen::Index n_samples = 0, n_terms = 0;
  bool is_within(double sigma) const {
    return left <= std::pow(criteria().unexplained * sigma, 2) * double(n_samples - n_terms);
  }
};

// Through the first n samples, at least n_terms.
Polynomial polynomial_through(const std::vector<Sample>& samples, std::size_t n, Eigen::Index n_terms, double sigma) {
  Eigen::MatrixXd a(n, n_terms);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < Eigen::Index(n); ++i) {
    const Sample& one = samples[std::size_t(i)];
    a(i, 0) = 1;
    for (Eigen::Index k = 1; k < n_terms; ++k) a(i, k) = a(i, k - 1) * one.after;
    b[i] = one.value;
  }
  const Eigen::MatrixXd normal = a.transpose() * a;
  const Eigen::VectorXd x = a.colPivHouseholderQr().solve(b);
  const Eigen::MatrixXd covariance = sigma * sigma * normal.completeOrthogonalDecomposition().pseudoInverse();
  return {{x[0], x[1], std::sqrt(std::max(covariance(0, 0), 0.0)), std::sqrt(std::max(covariance(1, 1), 0.0)), true},
          (b - a * x).squaredNorm(),
          Eigen::Index(n),
          n_terms};
}

// What hits something has a kink in its way: no parabola follows it, and no quartic, as one would follow what is merely
// fast. The samples of one side say more of it than those of both, where its parabola is within the noise and its slope
// farther off than the looseness of starts makes up for.
Polynomial beside_a_kink(const std::vector<Sample>& near, const Polynomial& both, double sigma) {
  const auto n = std::size_t(both.n_samples);
  if (both.n_samples <= QUARTIC || both.is_within(sigma) ||
      polynomial_through(near, n, QUARTIC, sigma).is_within(sigma))
    return both;
  for (const double side : {1.0, -1.0}) {
    std::vector<Sample> samples;
    for (const Sample& one : near)
      if (one.after * side >= 0 && std::abs(one.after) < criteria().start_fit_span) samples.push_back(one);
    if (samples.size() < criteria().start_n_least) continue;
    const Polynomial alone = polynomial_through(samples, std::min(n, samples.size()), PARABOLA, sigma);
    const double apart = std::abs(alone.fit.slope - both.fit.slope);
    if (alone.is_within(sigma) && apart > criteria().start_looseness * both.fit.slope_sigma) return alone;
  }
  return both;
}

}  // namespace

LocalFit fit_around(const std::vector<double>& t, const std::vector<double>& values, std::size_t width, std::size_t k,
                    double t0, double sigma) {
  const std::vector<Sample> near = samples_around(t, values, width, k, t0);
  const std::size_t most = std::min(criteria().start_n_most, near.size());
  std::size_t n = std::min(criteria().start_n_least, near.size());
  while (n < most && std::abs(near[n].after) < criteria().start_fit_span / 2) ++n;
  if (n < 3) return {};
  Polynomial parabola = polynomial_through(near, n, PARABOLA, sigma);
  if (t0 > t.front()) return beside_a_kink(near, parabola, sigma).fit;
  if (most >= criteria().start_n_least) {
    double mean = 0, of_constant = 0;
    for (std::size_t i = 0; i < most; ++i) mean += near[i].value / double(most);
    for (std::size_t i = 0; i < most; ++i) of_constant += std::pow(near[i].value - mean, 2);
    if (of_constant - polynomial_through(near, most, PARABOLA, sigma).left <=
        criteria().start_rest_most * sigma * sigma)
      parabola.fit.value = mean, parabola.fit.slope = 0;
  }
  return parabola.fit;
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
