// Where a run is at a time, by what was measured around it, and what is not known of it.
#pragma once
#include <vector>

#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

struct Start {
  InitialState state;
  std::vector<Unknown> unknowns;
};

// As the scene says where nothing was measured. t0 [s] of the run's clock.
Start start_of(const Problem& problem, const Run& run, double t0);

// Whether two directions are the same or opposite ones, so far as measurements go.
bool is_along(const Vec3& a, const Vec3& b);

}  // namespace pvg::diagnose
