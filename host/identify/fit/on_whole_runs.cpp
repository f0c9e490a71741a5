#include "host/identify/fit/on_whole_runs.hpp"

#include "host/identify/criteria.hpp"
#include "host/identify/fit/choose_windows.hpp"
#include "host/identify/fit/whole_runs.hpp"

namespace pvg::diagnose {

std::optional<OnWholeRuns> on_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds,
                                         const Fit& found) {
  std::vector<Window> windows = make_windows(problem, false, 0, most_windows(problem, simulated_seconds, 0));
  const std::size_t n = windows.size();
  FitData data = fitter.prepare(std::move(windows), found.model);
  if (n == 0 || data.windows.size() != n) return std::nullopt;
  for (const Eigen::MatrixXd& u : data.of_start)
    if (start_growth(u) > criteria().whole_run_growth) return std::nullopt;
  Fit fit = fitter.fit(data, {found.model}, criteria().n_more_steps).front();
  if (!fit.succeeded || !is_coherent(problem, data, fit, criteria().window_hopeless)) return std::nullopt;
  return OnWholeRuns{std::move(data), std::move(fit)};
}

}  // namespace pvg::diagnose
