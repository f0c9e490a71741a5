#include "host/identify/search/shape_places.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

struct Shaped {
  std::vector<Eigen::Index> strength;  // in the candidate's parameters
  Eigen::Index shape = -1;
  bool is_of_several() const { return shape >= 0 && strength.size() > 1; }
};

Shaped law_of(const Candidate& candidate) {
  Shaped law;
  for (std::size_t k = 0; k < candidate.parameters.size(); ++k) {
    if (candidate.parameters[k].is_shape)
      law.shape = Eigen::Index(k);
    else
      law.strength.push_back(Eigen::Index(k));
  }
  return law;
}

std::vector<double> shapes_of(const Parameter& p) {
  std::vector<double> shapes = {p.off};
  for (const double factor : criteria().screen_shapes) shapes.push_back(factor * p.off);
  std::erase_if(shapes, [&](double shape) { return shape < p.low || shape > p.high; });
  return shapes;
}

// Residuals of all windows, starts eliminated, each window over its scale in the base.
VectorXd stacked(const FitData& some, const std::vector<double>& scales, const std::vector<Prediction>& found) {
  std::vector<VectorXd> parts;
  Eigen::Index n = 0;
  for (std::size_t w = 0; w < found.size(); ++w) {
    parts.push_back(beside_starts(some.of_start[w], found[w].residual) / scales[w]);
    n += parts.back().size();
  }
  VectorXd all(n);
  n = 0;
  for (const VectorXd& part : parts) {
    all.segment(n, part.size()) = part;
    n += part.size();
  }
  return all;
}

}  // namespace

std::vector<Model> places_at_shapes(Fitter& fitter, const FitData& some, const Fit& few, const Screened& screened) {
  const std::vector<Parameter>& parameters = screened.candidate->parameters;
  const Shaped law = law_of(*screened.candidate);
  if (!law.is_of_several()) return {};
  const Eigen::Index n_base = screened.model.x.size() - Eigen::Index(parameters.size());
  const Eigen::Index n = Eigen::Index(law.strength.size());
  const auto place = [&](Eigen::Index i) { return n_base + law.strength[std::size_t(i)]; };
  const auto parameter = [&](Eigen::Index i) -> const Parameter& {
    return parameters[std::size_t(law.strength[std::size_t(i)])];
  };
  const auto simulated = [&](const std::vector<Model>& models) {
    return fitter.evaluate(some, models, std::vector(models.size(), few.delta));
  };
  const auto have_succeeded = [](const std::vector<Prediction>& found) {
    return std::all_of(found.begin(), found.end(), [](const Prediction& p) { return p.succeeded; });
  };
  const std::vector<double> scales = window_scales(few.residual);

  // x_0: the first strength as it is best beside the others, or as large as they are together
  std::vector<Model> alone(2, screened.model);
  for (Eigen::Index i = 1; i < n; ++i) {
    alone[1].x[place(0)] += screened.model.x[place(i)] - parameter(i).off;
    alone[0].x[place(i)] = alone[1].x[place(i)] = parameter(i).off;
  }
  const auto found = simulated(alone);
  int best = -1;
  std::vector<VectorXd> left(alone.size());
  for (std::size_t m = 0; m < alone.size(); ++m) {
    if (!have_succeeded(found[m])) continue;
    left[m] = stacked(some, scales, found[m]);
    if (best < 0 || left[m].squaredNorm() < left[std::size_t(best)].squaredNorm()) best = int(m);
  }
  if (best < 0) return {};
  const Model& start = alone[std::size_t(best)];
  const VectorXd& r = left[std::size_t(best)];
  const double size = start.x[place(0)] - parameter(0).off;
  if (size == 0) return {};

  std::vector<Model> moved(1, start);  // the first strength at any shape, then the others at each
  const VectorXd step = [&] {
    VectorXd steps = VectorXd::Constant(n, criteria().screen_share_low * size);
    steps[0] = criteria().difference_share * size;
    return steps;
  }();
  moved[0].x[place(0)] += step[0];
  const std::vector<double> shapes = shapes_of(parameters[std::size_t(law.shape)]);
  for (const double shape : shapes)
    for (Eigen::Index i = 1; i < n; ++i) {
      moved.push_back(start);
      moved.back().x[place(i)] += step[i];
      moved.back().x[n_base + law.shape] = shape;
    }
  const auto responses = simulated(moved);
  std::vector<Model> models;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    MatrixXd j(r.size(), n);
    VectorXd low(n), high(n);
    bool is_known = true;
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::vector<Prediction>& response =
          responses[i == 0 ? 0 : std::size_t(1 + Eigen::Index(s) * (n - 1) + i - 1)];
      is_known = is_known && have_succeeded(response);
      if (is_known) j.col(i) = (stacked(some, scales, response) - r) / step[i];
      low[i] = parameter(i).low - start.x[place(i)];
      high[i] = parameter(i).high - start.x[place(i)];
    }
    if (!is_known) continue;
    MatrixXd a = j.transpose() * j;
    a.diagonal().array() += criteria().screen_ridge * a.trace();
    const VectorXd dx = least_within(a, j.transpose() * r, low, high);
    models.push_back(start);
    for (Eigen::Index i = 0; i < n; ++i) models.back().x[place(i)] += dx[i];
    models.back().x[n_base + law.shape] = shapes[s];
  }
  return models;
}

}  // namespace pvg::diagnose
