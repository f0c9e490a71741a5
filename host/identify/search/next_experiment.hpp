// The motion, of a family, that best separates two models that the recordings leave confused: their predictions differ
// most there in units of the noise, beyond what other starts and other values of the second model's parameters would
// make up for.
#pragma once
#include <optional>
#include <string>

#include "host/identify/search/diagnosis.hpp"
#include "host/identify/search/motion_family.hpp"

namespace pvg::diagnose {

struct NextExperiment {
  PlannedMotion motion;
  double separation = 0;  // root of the sum of the squares of what is left [noise]: beyond 3 the two are told apart
  std::size_t n_samples = 0;
};

// Nothing where the scene has no motion to choose, or none can be simulated.
std::optional<NextExperiment> next_experiment(Device& device, const Problem& problem, const Variant& base,
                                              const RankedModel& first, const RankedModel& second,
                                              std::size_t n_processes, Clock::time_point deadline);

// The length of `difference` beyond what columns can make up for, each of which is known to one (its prior).
double separation_of(const Eigen::VectorXd& difference, const Eigen::MatrixXd& columns);

}  // namespace pvg::diagnose
