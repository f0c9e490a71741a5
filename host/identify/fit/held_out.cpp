#include "host/identify/fit/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/base/statistics.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/data/jitter.hpp"
#include "host/identify/fit/correlation.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

double rms_of(const VectorXd& residual) {
  return residual.size() > 0 ? std::sqrt(residual.squaredNorm() / double(residual.size())) : 0;
}

// Windows as a model begins in them: its own starts and its own correction for the time step. No fit: it cannot be
// simulated in all of them. n_windows 0: in any of them.
struct Simulated {
  FitData data;
  std::optional<Fit> fit;
};

Simulated simulated(Fitter& fitter, const std::vector<Window>& windows, const Model& model, std::size_t n_windows) {
  Simulated out{fitter.prepare(windows, model), {}};
  const auto are_all = [&] {
    return !out.data.windows.empty() && (n_windows == 0 || out.data.windows.size() == n_windows);
  };
  if (!are_all()) return out;
  if (n_windows == 0) n_windows = out.data.windows.size();
  Fit starts = fitter.fit(out.data, {model}, 0).front();
  if (!Fitter::are_good_enough(starts)) {
    out.data = fitter.prepared_nearer(std::move(out.data), starts);
    if (!are_all()) return out;
    starts = fitter.fit(out.data, {model}, 0).front();
  }
  out.fit = std::move(starts);
  return out;
}

// The residuals of the windows that count.
std::vector<VectorXd> counted(const std::vector<VectorXd>& residual, const std::vector<bool>& counts) {
  std::vector<VectorXd> some;
  for (std::size_t w = 0; w < residual.size(); ++w)
    if (counts[w]) some.push_back(residual[w]);
  return some;
}

std::string names_of(const Model& model) {
  std::string names;
  for (const Candidate* part : model.effects()) names += (names.empty() ? "" : " and ") + part->label();
  return names;
}

bool are_same(const Model& a, const Model& b) {
  return a.parts.size() == b.parts.size() && std::is_permutation(a.parts.begin(), a.parts.end(), b.parts.begin());
}

// fit: of a model in `data`; before: of the model without its last effect.
Lead lead_of(Fitter& fitter, const std::vector<Window>& windows, const std::vector<bool>& counts, const FitData& data,
             const Fit& fit, const Fit& before, const std::vector<Model>& alternatives) {
  const std::vector<VectorXd> left = counted(fit.residual, counts);
  std::vector<Window> that_count;
  for (std::size_t w = 0; w < counts.size(); ++w)
    if (counts[w]) that_count.push_back(data.windows[w]);
  const double correlated = correlation_length(that_count, left);
  Lead lead;
  const auto compare = [&](const Fit& other) {
    const double sigma = ahead_of(left, counted(other.residual, counts), correlated);
    if (sigma < lead.sigma) lead = {sigma, names_of(other.model)};
  };
  compare(before);
  bool any_compared = false;
  for (const Model& alternative : alternatives) {
    if (alternative.effects().size() != fit.model.effects().size() || are_same(alternative, fit.model)) continue;
    const Simulated other = simulated(fitter, windows, alternative, counts.size());
    if (!other.fit || !other.fit->succeeded) continue;
    any_compared = true;
    compare(*other.fit);
  }
  if (!any_compared) lead.sigma = NAN;
  return lead;
}

// 1 - mIoU over all windows that have masks
double mask_gap(Fitter& fitter, const FitData& data, const Fit& fit) {
  double sum = 0;
  int n = 0;
  const auto found = fitter.evaluate(data, {fit.model}, {fit.delta});
  for (const Prediction& p : found.front())
    if (std::isfinite(p.mask_overlap)) {
      sum += p.mask_overlap;
      ++n;
    }
  return n > 0 ? 1 - sum / n : std::nan("");
}

// Whether one model of several effects closes enough, fewer effects do not, and more than noise is left. m: its place.
bool depends_on_alternatives(const HeldOut& held_out, std::size_t n_effects, std::size_t m) {
  const double least = criteria().gap_closed_least;
  const auto is_enough = [&](double after, std::size_t n) {
    return closed(held_out.before, after, held_out.floor) >= share_of_effects(least, n);
  };
  return !is_enough(held_out.after_each[0], 1) && held_out.after >= criteria().unexplained * held_out.floor &&
         is_enough(held_out.after_each[m], n_effects);
}

}  // namespace

double ahead_of(const std::vector<VectorXd>& a, const std::vector<VectorXd>& b, double correlated) {
  double apart = 0, further = 0, left = 0, n = 0;
  for (std::size_t w = 0; w < a.size(); ++w) {
    apart += (b[w] - a[w]).squaredNorm();
    further += b[w].squaredNorm() - a[w].squaredNorm();
    left += a[w].squaredNorm();
    n += double(a[w].size());
  }
  if (apart == 0) return 0;
  return further / (2 * std::max(std::sqrt(left / n), 1.0) * std::sqrt(correlated * apart));
}

double share_of_effects(double least, std::size_t n) { return 1 - std::pow(1 - least, double(n)); }

double error_in(const Problem& problem, const FitData& data, const std::vector<VectorXd>& residual,
                const std::vector<bool>& counts, bool in_noise) {
  double sum = 0, n = 0;
  for (std::size_t w = 0; w < data.windows.size(); ++w) {
    if (!counts[w]) continue;
    const Window& window = data.windows[w];
    for (std::size_t i = 0; i < window.data.size(); ++i) {
      const Datum& d = window.data[i];
      const double unit = in_noise ? 1
                                   : noise_of_number(problem, problem.runs[std::size_t(window.run)],
                                                     std::size_t(d.channel), d.sample, d.component);
      sum += std::pow(residual[w][Eigen::Index(i)] * unit, 2);
      n += 1;
    }
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}

std::vector<bool> undisturbed(const std::vector<VectorXd>& before, const std::vector<VectorXd>& after) {
  std::vector<double> error;
  for (const VectorXd& r : after) error.push_back(rms_of(r));
  const double typical = upper_median(error);
  std::vector<bool> counts;
  for (std::size_t w = 0; w < error.size(); ++w)
    counts.push_back(error[w] <= criteria().disturbed * typical ||
                     error[w] < criteria().disturbed_halved * rms_of(before[w]) ||
                     error[w] > criteria().disturbed_worse * rms_of(before[w]));
  const auto n = std::count(counts.begin(), counts.end(), false);
  return double(n) <= criteria().disturbed_share_most * double(counts.size()) ? counts
                                                                              : std::vector<bool>(counts.size(), true);
}

std::vector<Curve> curves_of(const Problem& problem, const FitData& data, const Fit& before, const Fit& after,
                             std::size_t most) {
  std::vector<Curve> curves;
  for (std::size_t w = 0; w < data.windows.size() && curves.size() < most; ++w) {
    const Window& window = data.windows[w];
    const Run& run = problem.runs[std::size_t(window.run)];
    for (std::size_t c = 0; c < problem.channels.size(); ++c) {
      const Channel& channel = problem.channels[c];
      for (int k = 0; k < channel.n; ++k) {
        const double sigma = noise_in(problem, run, c);
        Curve curve{run.name,     channel.name + (channel.n > 1 ? std::string(", ") + "xyz"[k] : ""),
                    channel.unit, run.is_held_out,
                    {},           {},
                    {},           {},
                    sigma};
        for (std::size_t i = 0; i < window.data.size(); ++i) {
          const Datum& d = window.data[i];
          if (d.channel != int(c) || d.component != k) continue;
          const bool turn = channel.sensor->is_shown_as_deviation;
          const double measured = turn ? 0 : run.values[c][d.sample * std::size_t(channel.width) + std::size_t(k)];
          curve.t.push_back(run.t[d.sample]);
          curve.measured.push_back(measured);
          const double unit = noise_of_number(problem, run, c, d.sample, k);
          curve.before.push_back(measured - before.residual[w][Eigen::Index(i)] * unit);
          curve.after.push_back(measured - after.residual[w][Eigen::Index(i)] * unit);
        }
        if (!curve.t.empty()) curves.push_back(std::move(curve));
      }
    }
  }
  return curves;
}

HeldOut judge_held_out(Fitter& fitter, const Problem& problem, double length, std::size_t most_windows,
                       const std::vector<Model>& selected, bool in_noise, const std::vector<Model>& alternatives) {
  HeldOut result;
  result.kept = selected.size();
  const std::vector<Window> windows = make_windows(problem, true, length, most_windows);
  if (windows.empty()) return result;
  std::vector<Model> models = selected;
  models.insert(models.begin(), fitter.as_it_stands());
  std::vector<FitData> data;
  std::vector<Fit> fits;
  for (const Model& model : models) {
    Simulated one = simulated(fitter, windows, model, data.empty() ? 0 : data.front().windows.size());
    data.push_back(std::move(one.data));
    if (!one.fit) break;
    fits.push_back(std::move(*one.fit));
    if (!fits.back().succeeded) break;
  }
  if (fits.empty() || !fits[0].succeeded) return result;
  std::vector<VectorXd> ones;
  for (const Window& window : data[0].windows) ones.push_back(VectorXd::Ones(Eigen::Index(window.data.size())));
  while (!fits.back().succeeded) fits.pop_back();
  const std::vector<bool> all(data[0].windows.size(), true);
  const std::vector<bool> counts = fits.size() > 1 ? undisturbed(fits.front().residual, fits.back().residual) : all;
  const auto error_of = [&](std::size_t m, const std::vector<bool>& counted) {
    return error_in(problem, data[m], fits[m].residual, counted, in_noise);
  };
  result.floor = error_in(problem, data[0], ones, counts, in_noise);
  result.before = result.after = error_of(0, counts);
  result.kept = 0;
  for (std::size_t m = 1; m < fits.size(); ++m) {
    const double after = error_of(m, counts);
    if (m > 1 && after - result.floor > (1 - criteria().second_gap_closed_least) * (result.after - result.floor)) break;
    result.after = after;
    result.kept = m;
    result.after_each.push_back(after);
  }
  result.lead.resize(result.kept);
  for (std::size_t m = 2; m <= result.kept; ++m) {
    if (!depends_on_alternatives(result, selected[m - 1].effects().size(), m - 1)) continue;
    Lead& lead = result.lead[m - 1];
    lead.sigma = NAN;
    try {
      lead = lead_of(fitter, windows, counts, data[m], fits[m], fits[m - 1], alternatives);
    } catch (const OutOfTime&) {  // the errors above count nevertheless
    }
  }
  result.agreement = agreement_of(problem, data[result.kept].windows, fits[result.kept].residual);
  result.before_all = error_of(0, all);
  result.after_all = error_of(result.kept, all);
  for (std::size_t w = 0; w < counts.size(); ++w)
    if (const Window& window = data[0].windows[w]; !counts[w])
      result.disturbed.push_back({problem.runs[std::size_t(window.run)].name, window.start, window.end,
                                  rms_of(fits[0].residual[w]), rms_of(fits[result.kept].residual[w])});
  if (!problem.recording.mask_sources.empty()) {
    result.mask_gap_before = mask_gap(fitter, data[0], fits[0]);
    result.mask_gap_after = mask_gap(fitter, data[result.kept], fits[result.kept]);
  }
  result.curves = curves_of(problem, data[0], fits[0], fits[result.kept], 8);
  return result;
}

double closed(double before, double after, double floor) {
  return before > floor ? std::clamp(1 - (after - floor) / (before - floor), -10.0, 1.0) : 0;
}

}  // namespace pvg::diagnose
