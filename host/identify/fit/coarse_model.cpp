#include "host/identify/fit/coarse_model.hpp"

#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

// Steps of one second that its simulation takes.
double cost_of(const Variant& variant) { return (variant.extrapolates ? 3 : 1) / variant.scene.solver.time_step; }

// r_fine - r_coarse at the base.
std::vector<VectorXd> errors_of(Fitter& coarse, const FitData& data, const Fit& at) {
  std::vector<VectorXd> errors;
  const std::vector<Prediction> found = coarse.evaluate(data, {at.model}, {at.delta}).front();
  for (std::size_t w = 0; w < found.size(); ++w) errors.push_back(at.residual[w] - found[w].residual);
  return errors;
}

// Whether coarse steps follow the motion of each window, so that they tell a change as well as sensitivities have to.
bool are_small(const Problem& problem, const FitData& data, const std::vector<VectorXd>& errors) {
  for (std::size_t w = 0; w < errors.size(); ++w) {
    const double error = rms({beside_starts(data.of_start[w], errors[w])});
    if (!(error < criteria().reduction_missed * signal_of(problem, data.windows[w]))) return false;
  }
  return true;
}

}  // namespace

double signal_of(const Problem& problem, const Window& window) {
  const Run& run = problem.runs[std::size_t(window.run)];
  std::vector<std::vector<double>> of(problem.channels.size() * 4);
  for (const Datum& d : window.data) {
    const Channel& c = problem.channels[std::size_t(d.channel)];
    const double sigma = noise_in(problem, run, std::size_t(d.channel));
    of[std::size_t(d.channel) * 4 + std::size_t(d.component)].push_back(
        run.values[std::size_t(d.channel)][d.sample * std::size_t(c.width) + std::size_t(d.component)] / sigma);
  }
  double sum = 0, n = 0;
  for (const std::vector<double>& values : of) {
    double mean = 0;
    for (const double v : values) mean += v / double(values.size());
    for (const double v : values) sum += (v - mean) * (v - mean);
    n += double(values.size());
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

std::optional<CoarseModel> coarse_model(Fitter& fitter, Predictor& predictor, const Problem& problem,
                                        const Variant& base, const FitData& data, const Model& model) {
  const double longest = problem.scene.scene.solver.time_step;
  if (2 / longest >= cost_of(base)) return std::nullopt;
  const Fit at = fitter.begin(data, {model}).front();
  for (double step = longest; at.succeeded && 2 / step < cost_of(base); step /= 2) {
    auto variant = std::make_unique<Variant>(base);
    variant->extrapolates = false;
    variant->scene.solver.time_step = step;
    auto coarse_fitter = std::make_unique<Fitter>(predictor, *variant);
    const std::vector<VectorXd> errors = errors_of(*coarse_fitter, data, at);
    if (!are_small(problem, data, errors)) continue;
    CoarseModel coarse{std::move(variant), std::move(coarse_fitter), data};
    for (std::size_t w = 0; w < errors.size(); ++w) {
      VectorXd& correction = coarse.data.windows[w].correction;
      correction = correction.size() > 0 ? VectorXd(correction + errors[w]) : errors[w];
    }
    return coarse;
  }
  return std::nullopt;
}

}  // namespace pvg::diagnose
