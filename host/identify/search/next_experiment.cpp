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

// A model with one parameter moved, and what its change is to be multiplied by for one standard deviation, as the
// recordings leave it.
struct Moved {
  Model model;
  double per_deviation = 1;
};

// Of what they say little the deviation is so large that the model could not be simulated: it moves by less.
std::vector<Moved> moved_models(const Model& model, const std::vector<double>& deviations) {
  const std::vector<const Parameter*> parameters = model.parameters();
  std::vector<Moved> models;
  for (Eigen::Index i = 0; i < model.x.size(); ++i) {
    Moved moved{model};
    const Parameter& p = *parameters[std::size_t(i)];
    const double deviation = deviations[std::size_t(i)];
    const double wanted = std::isfinite(deviation) && deviation > 0 ? deviation : p.scale;
    const double by = std::min(wanted, p.scale);
    moved.per_deviation = wanted / by;
    moved.model.x[i] += moved.model.x[i] + by > p.high ? -by : by;
    models.push_back(std::move(moved));
  }
  return models;
}

// A motion's window, and its worth by |d|.
struct Compared {
  Window window;
  double bound = 0;
};

using Windows = std::span<const Window>;

class Search {
 public:
  Search(Predictor& predictor, const Variant& base, const RankedModel& first, const RankedModels& others)
      : predictor_(predictor), base_(base), fitter_(predictor, base), n_others_(others.size()) {
    for (const RankedModel* other : others) models_.push_back(fitted_model(*other));
    models_.push_back(fitted_model(first));
    for (std::size_t k = 0; k < n_others_; ++k)
      for (Moved& moved : moved_models(models_[k], others[k]->deviations)) {
        models_.push_back(std::move(moved.model));
        moved_of_.push_back(k);
        per_deviation_.push_back(moved.per_deviation);
      }
  }

  // Appends those that can be simulated.
  void compare(Windows some, std::vector<Compared>& out) {
    FitData data{{some.begin(), some.end()}, {}, {}};
    predictor_.settle(base_, data.windows);
    const auto found = fitter_.evaluate(data, {models_.begin(), models_.begin() + long(n_others_) + 1}, {});
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      std::vector<double> apart;
      for (std::size_t k = 0; k < n_others_; ++k)
        if (const double by = (found[n_others_][w].residual - found[k][w].residual).norm(); std::isfinite(by))
          apart.push_back(by);
      if (!apart.empty()) out.push_back({data.windows[w], worth_of(apart)});
    }
  }

  // Takes the best of these motions if it is better than `best`.
  void take_better(std::vector<Window> some, const std::vector<PlannedMotion>& motions, NextExperiment& best) {
    const FitData data = fitter_.prepare(std::move(some), models_[0], false);
    if (data.windows.empty()) return;
    const std::vector<std::vector<Prediction>> found = fitter_.evaluate(data, models_, {});
    for (std::size_t w = 0; w < data.windows.size(); ++w) {
      std::vector<double> separations;
      for (std::size_t k = 0; k < n_others_; ++k) separations.push_back(separation_from(k, data.of_start[w], found, w));
      const double worth = worth_of(separations);
      if (worth <= worth_of(best.separation)) continue;
      best.motion = motions[std::size_t(data.windows[w].run)];
      best.separation = std::move(separations);
      best.n_samples = std::size_t(found[0][w].residual.size());
    }
  }

 private:
  // Of the first model from the one of this number, in a window; 0 where one of them could not be simulated.
  double separation_from(std::size_t other, const MatrixXd& of_start, const std::vector<std::vector<Prediction>>& found,
                         std::size_t window) const {
    const VectorXd& here = found[other][window].residual;
    std::vector<VectorXd> moved;
    for (std::size_t m = 0; m < moved_of_.size(); ++m)
      if (moved_of_[m] == other)
        moved.push_back(per_deviation_[m] * (found[n_others_ + 1 + m][window].residual - here));
    MatrixXd columns(here.size(), of_start.cols() + Eigen::Index(moved.size()));
    columns.leftCols(of_start.cols()) = of_start;
    for (std::size_t m = 0; m < moved.size(); ++m) columns.col(of_start.cols() + Eigen::Index(m)) = moved[m];
    const VectorXd difference = found[n_others_][window].residual - here;
    return difference.allFinite() && columns.allFinite() ? separation_of(difference, columns) : 0;
  }

  Predictor& predictor_;
  const Variant& base_;
  Fitter fitter_;
  std::size_t n_others_;
  std::vector<Model> models_;          // the others, the first, the others with their parameters moved
  std::vector<std::size_t> moved_of_;  // of the last ones: which of the others
  std::vector<double> per_deviation_;  // likewise: of the change of what was moved
};

}  // namespace

double separation_of(const VectorXd& difference, const MatrixXd& columns) {
  return beside_starts(columns, difference).norm();
}

double worth_of(const std::vector<double>& separations) {
  constexpr double BEYOND = 1e-3;  // what more than enough counts beside what tells a name apart
  double worth = 0;
  for (const double separation : separations) {
    const double share = separation / criteria().told_apart;
    worth += std::min(share, 1.0) + BEYOND * std::log1p(share);
  }
  return worth;
}

std::vector<PlannedMotion> motions_between(const Problem& problem, const RankedModel& first,
                                           const RankedModels& others) {
  std::vector<const Candidate*> in_doubt;
  const auto add_lacking = [&](const RankedModel& of, const RankedModel& in) {
    for (const Candidate* part : of.parts)
      if (std::find(in.parts.begin(), in.parts.end(), part) == in.parts.end() &&
          std::find(in_doubt.begin(), in_doubt.end(), part) == in_doubt.end())
        in_doubt.push_back(part);
  };
  for (const RankedModel* other : others) {
    add_lacking(first, *other);
    add_lacking(*other, first);
  }
  const PhysicalScene& scene = problem.scene.scene;
  std::vector<PlannedMotion> motions;
  for (const Inputs& inputs : inputs_of(scene, in_doubt))
    for (PlannedMotion& motion : motion_family(problem, inputs)) motions.push_back(std::move(motion));
  return motions.empty() ? motion_family(problem, all_inputs(scene)) : motions;
}

NextExperiment next_experiment(Device& device, const Problem& problem, const Variant& base, const RankedModel& first,
                               const RankedModels& others, std::size_t n_processes, Clock::time_point deadline) {
  NextExperiment best;
  const std::vector<PlannedMotion> motions = motions_between(problem, first, others);
  const std::vector<Window> recorded = make_windows(problem, false, 0, 1);
  if (motions.empty() || recorded.empty()) return best;
  best.n_motions = motions.size();
  const Problem planned = planned_problem(problem, motions);
  Predictor predictor(device, planned, n_processes);
  Search search(predictor, base, first, others);
  const std::vector<Window> windows = windows_of(planned, motions, recorded[0].unknowns);
  std::vector<Compared> compared;
  const bool were_all_compared = ends_by(predictor.deadline(), after_share(deadline, criteria().time_comparison), [&] {
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
    for (std::size_t at = 0; at < compared.size() && compared[at].bound > worth_of(best.separation);
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
