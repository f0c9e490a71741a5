#include "host/identify/fit/choose_windows.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/fit/coarse_model.hpp"
#include "host/identify/fit/whole_runs.hpp"

namespace pvg::diagnose {
namespace {

double longest_run(const Problem& problem) {
  double longest = 0;
  for (const Run& run : problem.runs) longest = std::max(longest, run.t.back() - run.t.front());
  return longest;
}

// Worlds that a window needs for the sensitivities to its start.
double n_worlds(const Problem& problem) {
  double n = 1 + 2 * double(problem.coordinates.size()) + 12 * double(problem.free_bodies.size());
  const auto can_hit = [&](int b) {
    return !problem.scene.scene.rigid_bodies[std::size_t(b)].collision.triangles.empty();
  };
  return std::any_of(problem.free_bodies.begin(), problem.free_bodies.end(), can_hit) ? 2 * n : n;
}

// A fit of the starts alone, with what a base of candidates needs.
Fit of_no_effect(const FitData& data, Fit fit) {
  fit.slope.assign(data.windows.size(), {});
  for (std::size_t w = 0; w < fit.slope.size(); ++w) fit.slope[w].setZero(fit.residual[w].size(), fit.model.x.size());
  fit.scale = robust_scale(fit.residual);
  fit.window_scale.clear();
  fit.cost = robust_cost(fit.residual, fit.scale);
  return fit;
}

}  // namespace

bool is_coherent(const Problem& problem, const FitData& data, const Fit& fit, double times) {
  std::size_t n_near = 0;
  for (std::size_t w = 0; w < data.windows.size(); ++w)
    n_near +=
        rms({fit.residual[w]}) < times * std::max(criteria().window_coherent * signal_of(problem, data.windows[w]),
                                                  criteria().window_coherent_floor);
  return double(n_near) >= criteria().windows_coherent_share * double(data.windows.size());
}

std::size_t most_windows(const Problem& problem, double simulated_seconds, double length) {
  const double each = length > 0 ? length : longest_run(problem);
  const double most = std::min(simulated_seconds / std::max(each, 1e-6), criteria().n_worlds_most / n_worlds(problem));
  return std::clamp(std::size_t(most), criteria().n_windows_least, criteria().n_windows_most);
}

Fit fit_as_it_stands(Fitter& fitter, const FitData& data) {
  const Model& model = fitter.as_it_stands();
  if (model.x.size() > 0) return fitter.fit(data, {model}, criteria().n_more_steps).front();
  return of_no_effect(data, fitter.fit(data, {model}, 0).front());
}

FitData first_part(const Problem& problem, const FitData& data, double share) {
  FitData part{data.windows, data.of_start, data.at};
  for (std::size_t w = 0; w < part.windows.size(); ++w) {
    Window& window = part.windows[w];
    window.end = window.start + share * (window.end - window.start);
    std::vector<Eigen::Index> kept;
    for (std::size_t i = 0; i < window.data.size(); ++i)
      if (problem.runs[std::size_t(window.run)].t[window.data[i].sample] <= window.end) kept.push_back(Eigen::Index(i));
    window.data.clear();
    for (const Eigen::Index i : kept) window.data.push_back(data.windows[w].data[std::size_t(i)]);
    if (window.correction.size() > 0) window.correction = Eigen::VectorXd(window.correction(kept));
    part.of_start[w] = Eigen::MatrixXd(part.of_start[w](kept, Eigen::all));
  }
  return part;
}

namespace {

// Lengths of windows worth trying, the longest first.
std::vector<double> lengths_of(const Problem& problem) {
  const double longest = longest_run(problem);
  std::vector<double> lengths = {0};
  if (problem.can_restart) {
    lengths.insert(lengths.end(), criteria().window_lengths.begin(), criteria().window_lengths.end());
    std::erase_if(lengths, [&](double length) {
      return length > criteria().window_longest_share * longest ||
             (length == 0 && longest > criteria().whole_run_longest);
    });
  }
  return lengths;
}

// Takes windows of this length where they can be simulated. Whether they are coherent.
bool choose_length(Fitter& fitter, const Problem& problem, double simulated_seconds, double length, bool is_last,
                   ChosenWindows& chosen) {
  const Model& as_it_stands = fitter.as_it_stands();
  FitData data = fitter.prepare(make_windows(problem, false, length, most_windows(problem, simulated_seconds, length)),
                                as_it_stands);
  if (data.windows.empty()) return false;
  Fit base = of_no_effect(data, fitter.fit(data, {as_it_stands}, 0).front());
  chosen = {length, std::move(data), std::move(base)};
  if (!is_last && !is_coherent(problem, chosen.data, chosen.base, criteria().window_hopeless)) return false;
  if (!Fitter::are_good_enough(chosen.base)) {
    data = fitter.prepared_nearer(chosen.data, chosen.base);
    if (data.windows.empty()) return false;
    base = of_no_effect(data, fitter.fit(data, {as_it_stands}, 0).front());
    chosen = {length, std::move(data), std::move(base)};
  }
  return is_coherent(problem, chosen.data, chosen.base);
}

}  // namespace

std::optional<ChosenWindows> choose_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds) {
  std::vector<Window> windows = make_windows(problem, false, 0, most_windows(problem, simulated_seconds, 0));
  const std::size_t n = windows.size();
  FitData data = fitter.prepare(std::move(windows), fitter.as_it_stands());
  if (n == 0 || data.windows.size() != n) return std::nullopt;
  for (const Eigen::MatrixXd& u : data.of_start)
    if (start_growth(u) > criteria().whole_run_growth) return std::nullopt;
  Fit base = fit_as_it_stands(fitter, data);
  return ChosenWindows{0, std::move(data), std::move(base)};
}

ChosenWindows choose_windows(Fitter& fitter, const Problem& problem, double simulated_seconds) {
  ChosenWindows chosen;
  bool is_coherent = false, is_in_time = true;
  const std::vector<double> lengths = lengths_of(problem);
  for (std::size_t i = 0; i < lengths.size() && !is_coherent; ++i) {
    const bool is_last = i + 1 == lengths.size();
    is_in_time = ends_by(fitter.deadline(), after_share(fitter.deadline(), is_last ? 1 : criteria().time_length), [&] {
      is_coherent = choose_length(fitter, problem, simulated_seconds, lengths[i], is_last, chosen);
    });
  }
  if (chosen.data.windows.empty() && is_in_time)
    throw Failure(problem.recording.file.string() +
                  ": the scene could not be simulated to the end of any window of the fitting runs; run it by "
                  "`phyvisgen simulate` and see what fails");
  return chosen;
}

}  // namespace pvg::diagnose
