#include "host/identify/fit/whole_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

// The beginning of the held-out runs, each as one window.
std::vector<Window> beginnings(const Problem& problem, double longest, const std::vector<Disturbance>& disturbed) {
  std::vector<Window> windows = make_windows(problem, true, 0, problem.runs.size());
  for (Window& window : windows) {
    const Run& run = problem.runs[std::size_t(window.run)];
    window.end = std::min(window.end, window.start + longest);
    for (const Disturbance& d : disturbed)
      if (d.run == run.name) window.end = std::min(window.end, d.start);
    std::erase_if(window.data, [&](const Datum& datum) { return run.t[datum.sample] > window.end; });
  }
  std::erase_if(windows, [](const Window& window) { return window.data.size() <= window.unknowns.size() + 2; });
  return windows;
}

}  // namespace

double start_growth(const Eigen::MatrixXd& of_start) {
  const Eigen::Index n = of_start.rows(), last = std::max<Eigen::Index>(n / 4, 1);
  double most = 0;
  for (Eigen::Index k = 0; n > 0 && k < of_start.cols(); ++k)
    most = std::max(most, of_start.col(k).tail(last).norm() / std::sqrt(double(last)));
  return most / criteria().start_looseness;
}

WholeRuns judge_whole_runs(Fitter& fitter, const Problem& problem, double longest, const Model& named, bool in_noise,
                           const std::vector<Disturbance>& disturbed) {
  WholeRuns whole;
  const std::vector<Window> windows = beginnings(problem, longest, disturbed);
  for (const Window& window : windows) whole.seconds = std::max(whole.seconds, window.end - window.start);
  if (windows.empty()) {
    whole.why_not = "no held-out run is long enough";
    return whole;
  }
  const Model& as_it_stands = fitter.as_it_stands();
  double before = 0;
  for (const Model* model : {&as_it_stands, &named}) {
    const FitData data = fitter.prepare(windows, *model);
    if (data.windows.size() != windows.size()) {
      whole.why_not = "they could not be simulated to their end";
      return whole;
    }
    for (const Eigen::MatrixXd& u : data.of_start) whole.growth = std::max(whole.growth, start_growth(u));
    if (whole.growth > criteria().whole_run_growth) {
      whole.why_not = fmt::format("the error of their starts grows to {:.0f} times the noise", whole.growth);
      return whole;
    }
    const Fit fit = fitter.fit(data, {*model}, 0).front();
    const std::vector<bool> all(windows.size(), true);
    (model == &named ? whole.after : before) = error_in(problem, data, fit.residual, all, in_noise);
    std::vector<VectorXd> ones;
    for (const Window& window : windows) ones.push_back(VectorXd::Ones(Eigen::Index(window.data.size())));
    whole.floor = error_in(problem, data, ones, all, in_noise);
    if (named.effects().empty()) whole.after = before;
  }
  whole.before = before;
  return whole;
}

}  // namespace pvg::diagnose
