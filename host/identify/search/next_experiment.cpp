#include "host/identify/search/next_experiment.hpp"

#include <algorithm>
#include <cmath>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

Model fitted_model(const RankedModel& ranked) {
  const Eigen::Index n = Eigen::Index(ranked.values.size());
  return {ranked.parts, Eigen::Map<const VectorXd>(ranked.values.data(), n), VectorXd::Ones(n)};
}

// One window per planned motion, with the unknowns that a recorded start has. Turns and pictures are left out: their
// differences are not those of numbers.
std::vector<Window> windows_of(const Problem& planned, const std::vector<PlannedMotion>& motions,
                               const std::vector<Unknown>& unknowns) {
  std::vector<Window> windows;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    Window window{int(m), 0, motions[m].seconds, motions[m].initial, unknowns, {}, true, {}};
    for (std::size_t c = 0; c < planned.channels.size(); ++c) {
      const Channel& channel = planned.channels[c];
      if (channel.sensor->start == StartRole::turn || channel.sensor->is_of_pictures) continue;
      for (std::size_t i = 0; i < planned.runs[m].t.size(); ++i)
        for (int k = 0; k < channel.n; ++k) window.data.push_back({int(c), i, k});
    }
    if (!window.data.empty()) windows.push_back(std::move(window));
  }
  return windows;
}

// The second model's parameters moved by one standard deviation each, as the recordings leave them.
std::vector<Model> moved_models(const Model& model, const std::vector<double>& deviations) {
  const std::vector<const Parameter*> parameters = model.parameters();
  std::vector<Model> models;
  for (Eigen::Index i = 0; i < model.x.size(); ++i) {
    Model moved = model;
    const Parameter& p = *parameters[std::size_t(i)];
    const double deviation = deviations[std::size_t(i)];
    const double by = std::isfinite(deviation) && deviation > 0 ? deviation : p.scale;
    moved.x[i] += moved.x[i] + by > p.high ? -by : by;
    models.push_back(std::move(moved));
  }
  return models;
}

}  // namespace

double separation_of(const VectorXd& difference, const MatrixXd& columns) {
  return beside_starts(columns, difference).norm();
}

std::optional<NextExperiment> next_experiment(Device& device, const Problem& problem, const Variant& base,
                                              const RankedModel& first, const RankedModel& second,
                                              std::size_t n_processes, Clock::time_point deadline) {
  const std::vector<PlannedMotion> motions = motion_family(problem);
  const std::vector<Window> recorded = make_windows(problem, false, 0, 1);
  if (motions.empty() || recorded.empty()) return std::nullopt;
  const Problem planned = planned_problem(problem, motions);
  Predictor predictor(device, planned, n_processes);
  predictor.deadline() = deadline;
  Fitter fitter(predictor, base);
  const Model model = fitted_model(second);
  const FitData data = fitter.prepare(windows_of(planned, motions, recorded[0].unknowns), model, false);
  if (data.windows.empty()) return std::nullopt;
  std::vector<Model> models = moved_models(model, second.deviations);
  models.insert(models.begin(), {model, fitted_model(first)});
  const std::vector<std::vector<Prediction>> found = fitter.evaluate(data, models, {});
  NextExperiment best;
  for (std::size_t w = 0; w < data.windows.size(); ++w) {
    const VectorXd& here = found[0][w].residual;
    MatrixXd columns(here.size(), data.of_start[w].cols() + Eigen::Index(models.size()) - 2);
    columns.leftCols(data.of_start[w].cols()) = data.of_start[w];
    for (std::size_t m = 2; m < models.size(); ++m)
      columns.col(data.of_start[w].cols() + Eigen::Index(m) - 2) = found[m][w].residual - here;
    const VectorXd difference = found[1][w].residual - here;
    if (!difference.allFinite() || !columns.allFinite()) continue;
    const double separation = separation_of(difference, columns);
    if (separation <= best.separation) continue;
    best = {motions[std::size_t(data.windows[w].run)], separation, std::size_t(here.size())};
  }
  if (best.n_samples == 0) return std::nullopt;
  return best;
}

}  // namespace pvg::diagnose
