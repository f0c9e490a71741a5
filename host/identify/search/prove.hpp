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
  HeldOut held_out;
  WholeRuns whole;
  std::vector<Curve> curves;
  bool is_at_bound = false;  // a number of what was named ended there
};

// unit: of held-out errors, as measure() says.
Proof prove(Workflow& flow, const ChosenWindows& chosen, Selection selected, const std::string& unit);

}  // namespace pvg::diagnose
