#include "host/identify/search/explained.hpp"

#include <fmt/format.h>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/held_out.hpp"

namespace pvg::diagnose {

bool is_explained(Workflow& flow, const FitData& data, const Fit& named, double length) {
  const double left = rms(named.residual);
  if (left >= criteria().unexplained) return false;
  const Agreement by_samples = agreement_of(flow.problem, data.windows, named.residual);
  if (by_samples.is_agreement) return true;
  HeldOut held_out;
  flow.ends_in_time(criteria().time_search, "whether held-out runs need another effect", [&] {
    const std::size_t most = most_windows(flow.problem, flow.settings.simulated_seconds, length);
    held_out = judge_held_out(flow.fitter, flow.problem, length, most, {named.model}, true);
  });
  if (!(held_out.after > criteria().explained_held_out * held_out.floor)) return true;
  flow.notes.push_back(
      fmt::format("{} leaves {:.3g} times the noise in the fitted runs ({}) and {:.3g} in held-out ones",
                  named.model.parts.back()->label(), left, text_of(by_samples), held_out.after));
  return false;
}

}  // namespace pvg::diagnose
