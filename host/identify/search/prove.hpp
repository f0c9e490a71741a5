// Stage 7: what was selected, proved on the held-out runs, in windows and whole.
#pragma once
#include <string>
#include <vector>

#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// A number with its interval of two standard deviations, within its bounds. Of one that is fitted in its logarithm it
// is x e^(-2 sigma / x) to x e^(2 sigma / x).
NamedParameter named_parameter(const Parameter& parameter, double x, double sigma);

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

// Whether held-out errors are small enough for what was named. Two laws together imitate many a third one. So where the
// first of several closes less than gap_closed_least alone, they either leave no more than `unexplained`, or n of them
// close share_of_effects(gap_closed_least, n), 84 % for two, and are ahead of every other model of as many effects that
// was fitted, and of the one with an effect less, by gain_sigma.
bool closes_enough(const HeldOut& held_out);

// unit: of held-out errors, as measure() says.
Proof prove(Workflow& flow, const ChosenWindows& chosen, Selection selected, const std::string& unit);

// Whether no further effect need be looked for beside `named`: not where it leaves more than `unexplained`; less is
// judged by its samples, and where these say that more than noise is left, by held-out runs, which it must explain as
// a report asks for. A model of the wrong effects may leave hardly more than the noise where it was fitted.
// length: of windows [s] in held-out runs, 0: whole ones.
bool is_explained(Workflow& flow, const FitData& data, const Fit& named, double length);

}  // namespace pvg::diagnose
