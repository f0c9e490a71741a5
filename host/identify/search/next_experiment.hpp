// The motion, of a family, that best separates two models that the recordings leave confused: their predictions differ
// most there in units of the noise, beyond what other starts and other values of the second model's parameters would
// make up for. With d the difference of their residuals and the columns U of what makes up, each known to one:
//   separation = |(1 + U U^T)^-1 d| <= |d|
// so a motion whose |d| is below the best separation so far needs no columns. Those with the largest |d| get theirs
// first.
#pragma once
#include <vector>

#include "host/identify/search/diagnosis.hpp"
#include "host/identify/search/motion_family.hpp"

namespace pvg::diagnose {

struct NextExperiment {
  PlannedMotion motion;
  double separation = 0;      // root of the sum of the squares of what is left [noise]: beyond 3 the two are told apart
  std::size_t n_samples = 0;  // of that motion; 0: none was found
  std::size_t n_motions = 0, n_simulated = 0;  // that there are; those of them that were simulated
  bool had_time = true;                        // false: the deadline ended the search
};

// Motions of the inputs that tell the models apart, the surest first: of what one of them has and the other lacks. Of
// all inputs where none of these was moved in the recordings.
std::vector<PlannedMotion> motions_between(const Problem& problem, const RankedModel& first, const RankedModel& second);

// The best of these motions that was found by the deadline.
NextExperiment next_experiment(Device& device, const Problem& problem, const Variant& base, const RankedModel& first,
                               const RankedModel& second, std::size_t n_processes, Clock::time_point deadline);

// The length of `difference` beyond what columns can make up for, each of which is known to one (its prior).
double separation_of(const Eigen::VectorXd& difference, const Eigen::MatrixXd& columns);

}  // namespace pvg::diagnose
