// Whether anything is left to be explained.
#pragma once
#include "host/identify/search/workflow.hpp"

namespace pvg::diagnose {

// Whether no further effect need be looked for beside `named`: not where it leaves more than `unexplained`; less is
// judged by its samples, and where these say that more than noise is left, by held-out runs, which it must explain as
// a report asks for. A model of the wrong effects may leave hardly more than the noise where it was fitted.
// length: of windows [s] in held-out runs, 0: whole ones.
bool is_explained(Workflow& flow, const FitData& data, const Fit& named, double length);

}  // namespace pvg::diagnose
