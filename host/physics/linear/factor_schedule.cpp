#include "host/physics/linear/factor_schedule.hpp"

#include <algorithm>
#include <limits>

#include "host/physics/linear/elimination_tree.hpp"

namespace pvg {
namespace {

constexpr u32 NOT_YET = ~0u;

struct Stages {
  std::vector<u32> stage, task_root;  // of each front; task_root: the front that its task ends with
  double seconds = 0;
};

// Stage k takes the largest subtrees of what is left whose time is within the limit, and single fronts whose children
// are done. Each limit is `growth` times the one before.
Stages divide(std::span<const u32> parent, std::span<const double> seconds, double limit, double growth, double launch,
              unsigned n_units) {
  const std::size_t n = parent.size();
  Stages stages{std::vector<u32>(n, NOT_YET), std::vector<u32>(n), 0};
  std::vector<double> left(n);  // of the subtree [s]
  std::vector<char> fits(n), is_alone(n);
  std::size_t n_left = n;
  for (u32 stage = 0; n_left > 0; ++stage, limit *= growth) {
    std::fill(left.begin(), left.end(), 0.0);
    std::fill(is_alone.begin(), is_alone.end(), true);
    for (std::size_t s = 0; s < n; ++s) {
      if (stages.stage[s] != NOT_YET) continue;
      left[s] += seconds[s];
      fits[s] = is_alone[s] || left[s] <= limit;
      if (parent[s] == NO_PARENT) continue;
      left[parent[s]] += left[s];
      is_alone[parent[s]] = false;
    }
    double longest = 0, total = 0;
    for (std::size_t s = n; s-- > 0;) {
      if (stages.stage[s] != NOT_YET || !fits[s]) continue;
      const u32 above = parent[s];
      const bool joins = above != NO_PARENT && stages.stage[above] == stage;
      stages.stage[s] = stage;
      stages.task_root[s] = joins ? stages.task_root[above] : u32(s);
      if (!joins) longest = std::max(longest, left[s]), total += left[s];
      --n_left;
    }
    stages.seconds += launch + std::max(longest, total / n_units);
  }
  return stages;
}

FactorSchedule lists_of(const Stages& stages) {
  const std::size_t n = stages.stage.size();
  FactorSchedule schedule;
  schedule.seconds = stages.seconds;
  const u32 n_stages = n ? *std::max_element(stages.stage.begin(), stages.stage.end()) + 1 : 0;
  std::vector<std::vector<u32>> roots(n_stages), members(n);
  for (u32 s = 0; s < n; ++s) {
    members[stages.task_root[s]].push_back(s);
    if (stages.task_root[s] == s) roots[stages.stage[s]].push_back(s);
  }
  schedule.stage_first = schedule.task_first = {0};
  for (const std::vector<u32>& stage : roots) {
    for (const u32 root : stage) {
      schedule.front.insert(schedule.front.end(), members[root].begin(), members[root].end());
      schedule.task_first.push_back(u32(schedule.front.size()));
    }
    schedule.stage_first.push_back(u32(schedule.task_first.size() - 1));
  }
  return schedule;
}

}  // namespace

FactorSchedule make_schedule(std::span<const u32> parent, std::span<const double> seconds, double launch,
                             unsigned n_units) {
  double total = 0;
  for (const double each : seconds) total += each;
  Stages best{{}, {}, std::numeric_limits<double>::infinity()};
  for (double part = 1; part <= 4096; part *= 2)
    for (const double growth : {2.0, 4.0, 16.0}) {
      Stages stages = divide(parent, seconds, total / part, growth, launch, std::max(1u, n_units));
      if (stages.seconds < best.seconds) best = std::move(stages);
    }
  return lists_of(best);
}

}  // namespace pvg
