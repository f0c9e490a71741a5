#include "host/identify/fit/on_whole_runs.hpp"

#include "host/identify/criteria.hpp"
#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/fit/whole_runs.hpp"

namespace pvg::diagnose {

namespace {

// The fitting runs as one window each; none where they cannot be simulated to their end, or errors of their starts grow
// too much.
std::optional<FitData> prepared_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds,
                                           const Model& model) {
  std::vector<Window> windows = make_windows(problem, false, 0, most_windows(problem, simulated_seconds, 0));
  const std::size_t n = windows.size();
  FitData data = fitter.prepare(std::move(windows), model);
  if (n == 0 || data.windows.size() != n) return std::nullopt;
  for (const Eigen::MatrixXd& u : data.of_start)
    if (start_growth(u) > criteria().whole_run_growth) return std::nullopt;
  return data;
}

bool is_near_enough(const Problem& problem, const FitData& data, const Fit& fit) {
  return fit.succeeded && is_coherent(problem, data, fit, criteria().window_hopeless);
}

}  // namespace

std::optional<OnWholeRuns> on_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds,
                                         const Fit& found) {
  std::optional<FitData> data = prepared_whole_runs(fitter, problem, simulated_seconds, found.model);
  if (!data) return std::nullopt;
  Fit fit = fitter.fit(*data, {found.model}, criteria().n_more_steps).front();
  if (!is_near_enough(problem, *data, fit)) return std::nullopt;
  return OnWholeRuns{std::move(*data), std::move(fit)};
}

std::optional<std::vector<bool>> follow_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds,
                                                   const std::vector<Model>& models) {
  const std::optional<FitData> data = prepared_whole_runs(fitter, problem, simulated_seconds, models.front());
  if (!data) return std::nullopt;
  std::vector<bool> follow;
  for (const Fit& fit : fitter.fit(*data, models, 0)) follow.push_back(is_near_enough(problem, *data, fit));
  return follow;
}

}  // namespace pvg::diagnose
