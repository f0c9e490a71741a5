// The backward check of forward selection: a model of several effects with one of them left out or replaced.
#pragma once
#include <string>
#include <vector>

#include "host/identify/fit/prepared.hpp"
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// The fits of a round that may stand in the place of another effect: those that passed, best first; the others are
// tried where fewer than n_swaps passed, since an effect that leaves much beside what is still missing may pass no test
// alone and be half of the truth.
struct StandIns {
  std::vector<Fit> passed, others;
  std::vector<Fit> all() const;
};
StandIns stand_ins_of(const Decision& decision);

// An effect is dropped if the model without it fits equally well from where the others are now. The newest is dropped
// too: the earlier ones may have been short of their optimum, or in windows that were prepared for the scene without
// them, and a second effect makes up for that. The first is replaced by another effect of the first round if that is
// better beside the later one; beside that alternative the later effect may be replaced by one of its own round.
struct Revision {
  Fit fit;
  // Labels of what was fitted in the place of the first effect beside the later one, that effect among them: those as
  // good as what is there in the end, which is one of them, and those that are worse.
  std::vector<std::string> as_good, worse;
};
Revision revised(Workflow& flow, Prepared& prepared, const Fit& fit, const StandIns& first_round,
                 const StandIns& this_round);

// What the data do not tell from the first effect, that one among them; empty: nothing. set: what was not told from
// `before`, then the first effect, while the second was missing: beside it some may be worse. now: the first effect.
std::vector<std::string> told_with_first(const std::vector<std::string>& set, const std::string& before,
                                         const std::string& now, const Revision& revision);

}  // namespace pvg::diagnose
