// What was found in short windows, on whole runs. Each window has a start of its own, which takes up much of what a
// number changes: windows are needed where the scene as it stands is too far from what was measured, and no longer once
// the largest part of what it lacks is found.
#pragma once
#include <optional>

#include "host/identify/fit/fit.hpp"

namespace pvg::diagnose {

struct OnWholeRuns {
  FitData data;
  Fit fit;
};

// The model of `found` fitted to the whole fitting runs, from its numbers. Nothing where these cannot be simulated, the
// error of a start grows too much in them, or the model is too far from them to be linearised.
std::optional<OnWholeRuns> on_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds,
                                         const Fit& found);

// Which of these models, with the starts alone fitted, are near enough to the whole fitting runs to be linearised.
// Nothing where that cannot be told.
std::optional<std::vector<bool>> follow_whole_runs(Fitter& fitter, const Problem& problem, double simulated_seconds,
                                                   const std::vector<Model>& models);

}  // namespace pvg::diagnose
