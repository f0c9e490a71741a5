#include "host/identify/search/alternatives.hpp"

#include <algorithm>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/held_out.hpp"
#include "host/identify/search/round.hpp"

namespace pvg::diagnose {

bool leave_the_same(const Fit& a, const Fit& b) {
  std::vector<Eigen::VectorXd> apart;
  for (std::size_t w = 0; w < a.residual.size(); ++w) apart.push_back(a.residual[w] - b.residual[w]);
  return rms(apart) < criteria().same_residual;
}

bool is_worth_a_second(const Fit& base, const Fit& alternative) {
  return closed(rms(base.residual), rms(alternative.residual), 1) >= criteria().second_gain_least;
}

std::optional<FoundPair> find_beside_alternatives(Workflow& flow, const std::vector<Candidate>& candidates,
                                                  const FitData& data, const Fit& base,
                                                  const std::vector<Fit>& first_round, std::vector<Fit> tried,
                                                  double most, double expected_seconds) {
  std::size_t n = 0;
  for (const Fit& alternative : first_round) {
    if (n == criteria().n_alternatives) break;
    if (!is_worth_a_second(base, alternative) || !gets_nearer(data, base, alternative.residual)) continue;
    if (std::any_of(tried.begin(), tried.end(), [&](const Fit& other) { return leave_the_same(other, alternative); }))
      continue;
    const std::string label = alternative.model.parts.back()->label();
    if (!flow.has_time("an effect beside " + label, expected_seconds)) break;
    tried.push_back(alternative);
    flow.report_progress(4, 0.7, "looking for an effect beside " + label + " instead");
    const Round round =
        run_round(flow, candidates, data, alternative, "beside_alternative_" + std::to_string(++n), 0.75);
    if (round.decision.chosen < 0) continue;
    const Judged& chosen = round.decision.ranking[std::size_t(round.decision.chosen)];
    if (rms(chosen.fit->residual) >= most) continue;
    FoundPair found{*chosen.fit, ranked(chosen), {}};
    for (const std::size_t i : round.decision.inseparable)
      found.inseparable.push_back(round.decision.ranking[i].fit->model.parts.back()->label());
    return found;
  }
  return std::nullopt;
}

}  // namespace pvg::diagnose
