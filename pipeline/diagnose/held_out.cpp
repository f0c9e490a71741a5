#include "pipeline/diagnose/held_out.hpp"

#include <algorithm>
#include <cmath>

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;
constexpr double LEAST_GAP_OF_SECOND = 0.3;  // of what is left, for a further effect to stay

double error_in(const Problem& problem, const FitData& data, const std::vector<VectorXd>& residual, bool in_noise) {
  double sum = 0, n = 0;
  for (std::size_t w = 0; w < data.windows.size(); ++w)
    for (std::size_t i = 0; i < data.windows[w].data.size(); ++i) {
      const double sigma = in_noise ? 1 : problem.channels[std::size_t(data.windows[w].data[i].channel)].sigma;
      const double r = residual[w][Eigen::Index(i)] * sigma;
      sum += r * r;
      n += 1;
    }
  return n > 0 ? std::sqrt(sum / n) : 0;
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

}  // namespace

std::vector<Curve> curves_of(const Problem& problem, const FitData& data, const Fit& before, const Fit& after,
                             std::size_t most) {
  std::vector<Curve> curves;
  for (std::size_t w = 0; w < data.windows.size() && curves.size() < most; ++w) {
    const Window& window = data.windows[w];
    const Run& run = problem.runs[std::size_t(window.run)];
    for (std::size_t c = 0; c < problem.channels.size(); ++c) {
      const Channel& channel = problem.channels[c];
      for (int k = 0; k < channel.n; ++k) {
        Curve curve{run.name,     channel.name + (channel.n > 1 ? std::string(", ") + "xyz"[k] : ""),
                    channel.unit, run.is_held_out,
                    {},           {},
                    {},           {}};
        for (std::size_t i = 0; i < window.data.size(); ++i) {
          const Datum& d = window.data[i];
          if (d.channel != int(c) || d.component != k) continue;
          const bool turn = channel.kind == RecordedChannel::Kind::orientation;  // shown as deviations
          const double measured = turn ? 0 : run.values[c][d.sample * std::size_t(channel.width) + std::size_t(k)];
          curve.t.push_back(run.t[d.sample]);
          curve.measured.push_back(measured);
          curve.before.push_back(measured - before.residual[w][Eigen::Index(i)] * channel.sigma);
          curve.after.push_back(measured - after.residual[w][Eigen::Index(i)] * channel.sigma);
        }
        if (!curve.t.empty()) curves.push_back(std::move(curve));
      }
    }
  }
  return curves;
}

HeldOut judge_held_out(Fitter& fitter, const Problem& problem, double length, std::size_t most_windows,
                       const std::vector<Model>& grown, bool in_noise) {
  HeldOut result;
  result.kept = grown.size();
  const std::vector<Window> windows = make_windows(problem, true, length, most_windows);
  if (windows.empty()) return result;
  // each model with its own starts and its own correction for the time step
  std::vector<Model> models = grown;
  models.insert(models.begin(), Model{{}, VectorXd(), VectorXd()});
  std::vector<FitData> data;
  std::vector<Fit> fits;
  for (const Model& model : models) {
    data.push_back(fitter.prepare_near(windows, model));
    if (data.back().windows.empty() || data.back().windows.size() != data.front().windows.size()) break;
    fits.push_back(fitter.fit(data.back(), {model}, 0).front());
    if (!fits.back().is_well) break;
  }
  if (fits.empty() || !fits[0].is_well) return result;
  std::vector<VectorXd> ones;
  for (const Window& window : data[0].windows) ones.push_back(VectorXd::Ones(Eigen::Index(window.data.size())));
  result.floor = error_in(problem, data[0], ones, in_noise);
  result.before = result.after = error_in(problem, data[0], fits[0].residual, in_noise);
  result.kept = 0;
  for (std::size_t m = 1; m < fits.size() && fits[m].is_well; ++m) {
    const double after = error_in(problem, data[m], fits[m].residual, in_noise);
    if (m > 1 && after - result.floor > (1 - LEAST_GAP_OF_SECOND) * (result.after - result.floor)) break;
    result.after = after;
    result.kept = m;
  }
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
