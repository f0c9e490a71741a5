#include "host/identify/search/next_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

// Motions of one batch: what is done by the deadline counts.
constexpr std::size_t N_COMPARED_AT_ONCE = 12, N_WITH_COLUMNS_AT_ONCE = 3;
constexpr double SHARE_OF_COMPARISON = 0.5;  // of the time, before columns are simulated

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

// A motion's window, and |d|.
struct Compared {
  Window window;
  double bound = 0;
};

using Windows = std::span<const Window>;

class Search {
 public:
  Search(Predictor& predictor, const Variant& base, const RankedModel& first, const RankedModel& second)
      : predictor_(predictor),
        base_(base),
        fitter_(predictor, base),
        models_{fitted_model(second), fitted_model(first)} {
    for (Model& model : moved_models(models_[0], second.deviations)) models_.push_back(std::move(model));
  }

  // Appends those that can be simulated.
  void compare(Windows some, std::vector<Compared>& out) {
    FitData data{{some.begin(), some.end()}, {}, {}};
    predictor_.settle(base_, data.windows);
    const auto found = fitter_.evaluate(data, {models_[0], models_[1]}, {});
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      const double bound = (found[1][w].residual - found[0][w].residual).norm();
      if (std::isfinite(bound)) out.push_back({data.windows[w], bound});
    }
  }

  // Takes the best of these motions if it is better than `best`.
  void take_better(std::vector<Window> some, const std::vector<PlannedMotion>& motions, NextExperiment& best) {
    const FitData data = fitter_.prepare(std::move(some), models_[0], false);
    if (data.windows.empty()) return;
    const std::vector<std::vector<Prediction>> found = fitter_.evaluate(data, models_, {});
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      const VectorXd& here = found[0][w].residual;
      const Eigen::Index n_starts = data.of_start[w].cols();
      MatrixXd columns(here.size(), n_starts + Eigen::Index(models_.size()) - 2);
      columns.leftCols(n_starts) = data.of_start[w];
      for (std::size_t m = 2; m < models_.size(); ++m)
        columns.col(n_starts + Eigen::Index(m) - 2) = found[m][w].residual - here;
      const VectorXd difference = found[1][w].residual - here;
      if (!difference.allFinite() || !columns.allFinite()) continue;
      const double separation = separation_of(difference, columns);
      if (separation <= best.separation) continue;
      best.motion = motions[std::size_t(data.windows[w].run)];
      best.separation = separation;
      best.n_samples = std::size_t(here.size());
    }
  }

 private:
  Predictor& predictor_;
  const Variant& base_;
  Fitter fitter_;
  std::vector<Model> models_;  // the second, the first, the second with its parameters moved
};

}  // namespace

double separation_of(const VectorXd& difference, const MatrixXd& columns) {
  return beside_starts(columns, difference).norm();
}

std::vector<PlannedMotion> motions_between(const Problem& problem, const RankedModel& first,
                                           const RankedModel& second) {
  std::vector<const Candidate*> in_doubt;
  const auto add_lacking = [&](const RankedModel& of, const RankedModel& in) {
    for (const Candidate* part : of.parts)
      if (std::find(in.parts.begin(), in.parts.end(), part) == in.parts.end()) in_doubt.push_back(part);
  };
  add_lacking(first, second);
  add_lacking(second, first);
  const PhysicalScene& scene = problem.scene.scene;
  std::vector<PlannedMotion> motions;
  for (const Inputs& inputs : inputs_of(scene, in_doubt))
    for (PlannedMotion& motion : motion_family(problem, inputs)) motions.push_back(std::move(motion));
  return motions.empty() ? motion_family(problem, all_inputs(scene)) : motions;
}

NextExperiment next_experiment(Device& device, const Problem& problem, const Variant& base, const RankedModel& first,
                               const RankedModel& second, std::size_t n_processes, Clock::time_point deadline) {
  NextExperiment best;
  const std::vector<PlannedMotion> motions = motions_between(problem, first, second);
  const std::vector<Window> recorded = make_windows(problem, false, 0, 1);
  if (motions.empty() || recorded.empty()) return best;
  best.n_motions = motions.size();
  const Problem planned = planned_problem(problem, motions);
  Predictor predictor(device, planned, n_processes);
  Search search(predictor, base, first, second);
  const std::vector<Window> windows = windows_of(planned, motions, recorded[0].unknowns);
  std::vector<Compared> compared;
  const bool were_all_compared = ends_by(predictor.deadline(), after_share(deadline, SHARE_OF_COMPARISON), [&] {
    for (; best.n_simulated < windows.size();
         best.n_simulated = std::min(windows.size(), best.n_simulated + N_COMPARED_AT_ONCE))
      search.compare(Windows(windows)
                         .subspan(best.n_simulated)
                         .first(std::min(N_COMPARED_AT_ONCE, windows.size() - best.n_simulated)),
                     compared);
  });
  std::stable_sort(compared.begin(), compared.end(),
                   [](const Compared& a, const Compared& b) { return a.bound > b.bound; });
  const bool was_best_found = ends_by(predictor.deadline(), deadline, [&] {
    for (std::size_t at = 0; at < compared.size() && compared[at].bound > best.separation;
         at += N_WITH_COLUMNS_AT_ONCE) {
      std::vector<Window> some;
      for (std::size_t i = at; i < std::min(compared.size(), at + N_WITH_COLUMNS_AT_ONCE); ++i)
        some.push_back(compared[i].window);
      search.take_better(std::move(some), motions, best);
    }
  });
  best.had_time = were_all_compared && was_best_found;
  return best;
}

}  // namespace pvg::diagnose
