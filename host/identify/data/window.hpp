// A window: a stretch of a run that is simulated by itself, from a start that is measured, or as the scene says.
// With windows the error of a wrong model or of an impact does not spread over a whole run.
#pragma once
#include <cstddef>
#include <vector>

#include "host/identify/data/problem.hpp"

namespace pvg::diagnose {

// One number that is compared.
struct Datum {
  int channel = 0;
  std::size_t sample = 0;
  int component = 0;
};

struct Window {
  int run = 0;
  double start = 0, end = 0;  // [s] of the run's clock
  InitialState initial;
  std::vector<Unknown> unknowns;
  std::vector<Datum> data;
  bool is_settled = false;  // what rests on something starts on it (support.hpp)
  // what finer steps would add to the residuals [n_data, noise]; empty: nothing
  Eigen::VectorXd correction;
};

// Windows of about `length` [s] (0: whole runs) over the runs of one role, at most `most` of them, evenly chosen.
std::vector<Window> make_windows(const Problem& problem, bool held_out, double length, std::size_t most);

// `initial` moved by `by` along an unknown.
void move(InitialState& initial, const Unknown& unknown, double by);

// Places the bodies of `scene`, a variant of the problem's, as `initial` says.
void start_at(const Problem& problem, const InitialState& initial, PhysicalScene& scene);

}  // namespace pvg::diagnose
