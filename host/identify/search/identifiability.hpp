// What recordings could show at all, before anything is fitted, from the sensitivities of their residuals with all
// starts free: the smallest size of each candidate that stands out of the noise, and which other candidate mimics it
// best. So "agrees" has a meaning, and names that these data cannot tell apart are told together.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "host/identify/search/screen.hpp"

namespace pvg::diagnose {

struct Showable {
  const Candidate* candidate = nullptr;
  std::string parameter, unit;            // its first one that is seen
  double sigma = 0;                       // standard deviation with which it would be measured [unit]
  double smallest = 0;                    // what could have been shown: some of these deviations
  const Candidate* look_alike = nullptr;  // with which in the model the deviation is largest; null: no other is seen
  double sigma_beside = 0;                // then [unit]; infinite: the two cannot be told apart
};

// One row per candidate that changes the residuals, in the candidates' order.
std::vector<Showable> identifiability(const Signatures& signatures);

// Candidates whose best size leaves less than told_apart of what `values` of `named` change: no data of these runs
// tell them apart. values: of all its parameters [unit].
std::vector<const Candidate*> look_alikes(const Signatures& signatures, const Candidate& named,
                                          const Eigen::VectorXd& values);

// "joint_spring at hinge: preload from 0.02 N m, told from bias at hinge from 0.5 N m"
std::string text_of(const Showable& row);

// Where C is least with these columns alone, and by how much it falls at x.
Eigen::VectorXd optimum_of(const Signatures& signatures, std::span<const std::size_t> columns);
double gain_at(const Signatures& signatures, std::span<const std::size_t> columns, const Eigen::VectorXd& x);

}  // namespace pvg::diagnose
