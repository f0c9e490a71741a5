// The motion, of a family, that best separates a model from others that the recordings leave confused with it: their
// predictions differ most there in units of the noise, beyond what other starts and other values of the other model's
// parameters would make up for. With d the difference of their residuals and the columns U of what makes up, each known
// to one:
//   separation = |(1 + U U^T)^-1 d| <= |d|
// Of several others the motion counts most that tells most of them apart:
//   worth = sum_k min(s_k / 3, 1) + 0.001 log(1 + s_k / 3)
// Worth grows with each separation, so a motion that is worth less by its |d| than the best so far needs no columns.
// Those of the largest worth by |d| get theirs first.
#pragma once
#include <vector>

#include "host/identify/search/diagnosis.hpp"
#include "host/identify/search/motion_family.hpp"

namespace pvg::diagnose {

struct NextExperiment {
  PlannedMotion motion;
  // of each of the others: root of the sum of the squares of what is left [noise]; beyond 3 the two are told apart
  std::vector<double> separation;
  std::size_t n_samples = 0;                   // of that motion; 0: none was found
  std::size_t n_motions = 0, n_simulated = 0;  // that there are; those of them that were simulated
  bool had_time = true;                        // false: the deadline ended the search
};

using RankedModels = std::vector<const RankedModel*>;

// Motions of the inputs that tell the models apart, the surest first: of what one of them has and the first lacks, or
// the other way round. Of all inputs where none of these was moved in the recordings.
std::vector<PlannedMotion> motions_between(const Problem& problem, const RankedModel& first,
                                           const RankedModels& others);

// The best of these motions that was found by the deadline.
NextExperiment next_experiment(Device& device, const Problem& problem, const Variant& base, const RankedModel& first,
                               const RankedModels& others, std::size_t n_processes, Clock::time_point deadline);

// What a motion is worth that separates others by these [noise].
double worth_of(const std::vector<double>& separations);

// The length of `difference` beyond what columns can make up for, each of which is known to one (its prior).
double separation_of(const Eigen::VectorXd& difference, const Eigen::MatrixXd& columns);

}  // namespace pvg::diagnose
