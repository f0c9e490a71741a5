#include "host/identify/search/choose_windows.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/error.hpp"
#include "host/identify/criteria.hpp"

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

// Root mean square of what a window's channels do, in units of noise, about their means.
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

// times: of the bound
bool is_coherent(const Problem& problem, const FitData& data, const Fit& fit, double times = 1) {
  std::size_t n_near = 0;
  for (std::size_t w = 0; w < data.windows.size(); ++w)
    n_near +=
        rms({fit.residual[w]}) < times * std::max(criteria().window_coherent * signal_of(problem, data.windows[w]),
                                                  criteria().window_coherent_floor);
  return double(n_near) >= criteria().windows_coherent_share * double(data.windows.size());
}

// A fit of the starts alone, with what a base of candidates needs.
Fit of_no_effect(const FitData& data, Fit fit) {
  fit.slope.assign(data.windows.size(), {});
  for (std::size_t w = 0; w < fit.slope.size(); ++w) fit.slope[w].resize(fit.residual[w].size(), 0);
  fit.scale = robust_scale(fit.residual);
  fit.window_scale.clear();
  fit.cost = robust_cost(fit.residual, fit.scale);
  return fit;
}

}  // namespace

std::size_t most_windows(const Problem& problem, double simulated_seconds, double length) {
  const double each = length > 0 ? length : longest_run(problem);
  const double most = std::min(simulated_seconds / std::max(each, 1e-6), criteria().n_worlds_most / n_worlds(problem));
  return std::clamp(std::size_t(most), criteria().n_windows_least, criteria().n_windows_most);
}

Fit fit_as_it_stands(Fitter& fitter, const FitData& data) {
  return of_no_effect(data, fitter.fit(data, {Model{}}, 0).front());
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

ChosenWindows choose_windows(Fitter& fitter, const Problem& problem, double simulated_seconds) {
  const Model as_it_stands{{}, Eigen::VectorXd(), Eigen::VectorXd()};
  const double longest = longest_run(problem);
  ChosenWindows chosen;
  std::vector<double> lengths = {0};
  if (problem.can_restart) {
    lengths.insert(lengths.end(), criteria().window_lengths.begin(), criteria().window_lengths.end());
    std::erase_if(lengths, [&](double length) {
      return length > criteria().window_longest_share * longest ||
             (length == 0 && longest > criteria().whole_run_longest);
    });
  }
  for (const double length : lengths) {
    FitData data = fitter.prepare(
        make_windows(problem, false, length, most_windows(problem, simulated_seconds, length)), as_it_stands);
    if (data.windows.empty()) continue;
    Fit base = of_no_effect(data, fitter.fit(data, {as_it_stands}, 0).front());
    chosen = {length, std::move(data), std::move(base)};
    if (length != lengths.back() && !is_coherent(problem, chosen.data, chosen.base, criteria().window_hopeless))
      continue;
    data = fitter.prepared_nearer(chosen.data, chosen.base);
    if (data.windows.empty()) continue;
    base = fit_as_it_stands(fitter, data);
    chosen = {length, std::move(data), std::move(base)};
    if (is_coherent(problem, chosen.data, chosen.base)) break;
  }
  if (chosen.data.windows.empty())
    throw Failure(problem.recording.file.string() +
                  ": the scene could not be simulated to the end of any window of the fitting runs; run it by "
                  "`phyvisgen simulate` and see what fails");
  return chosen;
}

}  // namespace pvg::diagnose
