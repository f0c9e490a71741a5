// Stage 7: what was selected, proved on the held-out runs, in windows and whole.
#pragma once
#include <string>
#include <vector>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// The effects that the held-out runs confirm, and the curves. Without a held-out run the floor is 0.
struct Proof {
  Selection selected;  // without the effects that proved nothing
  std::vector<NamedEffect> effects;
  std::vector<AdjustedNumber> adjusted;
  Model nuisances;  // the same as a model
  HeldOut held_out;
  WholeRuns whole;
  std::vector<Curve> curves;
  bool is_at_bound = false;  // a number of what was named ended there
};

// Whether held-out errors are small enough for what was named. Two laws together imitate many a third one: where the
// first of several closes less than gap_closed_least alone, all of them have to leave no more than `unexplained`.
bool closes_enough(const HeldOut& held_out);

// unit: of held-out errors, as measure() says.
Proof prove(Workflow& flow, const ChosenWindows& chosen, Selection selected, const std::string& unit);

}  // namespace pvg::diagnose
