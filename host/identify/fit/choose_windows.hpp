// Whole runs, or shorter windows where the present model is too far from the measurement to be linearised.
#pragma once
#include <optional>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

struct ChosenWindows {
  double length = 0;  // [s], 0: whole runs
  FitData data;
  Fit base;  // the scene as it stands, starts fitted, and what fit_as_it_stands fits besides
};

// simulated_seconds: of all windows of one evaluation, about. Throws a Failure where none can be simulated. Where the
// time is over, what was chosen by then: perhaps no window.
ChosenWindows choose_windows(Fitter& fitter, const Problem& problem, double simulated_seconds);

// Whole fitting runs, however long, with the scene as it stands; nothing where the start's error grows too much or a
// run cannot be simulated to its end.
std::optional<ChosenWindows> choose_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds);

// The scene as it stands, no effect: the starts are fitted, and the numbers that are free in every model.
Fit fit_as_it_stands(Fitter& fitter, const FitData& data);

// The same windows up to `share` of their lengths.
FitData first_part(const Problem& problem, const FitData& data, double share);

// Whether a fit follows the measurement closely enough in most windows to be linearised. times: of the bound.
bool is_coherent(const Problem& problem, const FitData& data, const Fit& fit, double times = 1);

// How many windows of this length are affordable.
std::size_t most_windows(const Problem& problem, double simulated_seconds, double length);

}  // namespace pvg::diagnose
