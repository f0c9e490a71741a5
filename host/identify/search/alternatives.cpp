#include "host/identify/search/alternatives.hpp"

#include <algorithm>

#include "host/identify/criteria.hpp"
#include "host/identify/search/round.hpp"

namespace pvg::diagnose {
namespace {}  // namespace

bool leave_the_same(const Fit& a, const Fit& b) {
  std::vector<Eigen::VectorXd> apart;
  for (std::size_t w = 0; w < a.residual.size(); ++w) apart.push_back(a.residual[w] - b.residual[w]);
  return rms(apart) < criteria().same_residual;
}

std::optional<Fit> find_beside_alternatives(Workflow& flow, const FitData& data, const std::vector<Fit>& first_round,
                                            std::vector<Fit> tried, double most, double expected_seconds) {
  std::size_t n = 0;
  for (const Fit& alternative : first_round) {
    if (n == criteria().n_alternatives) break;
    if (std::any_of(tried.begin(), tried.end(), [&](const Fit& other) { return leave_the_same(other, alternative); }))
      continue;
    const std::string label = alternative.model.parts.back()->label();
    if (!flow.has_time("an effect beside " + label, expected_seconds)) break;
    tried.push_back(alternative);
    flow.report_progress(4, 0.7, "looking for an effect beside " + label + " instead");
    const Round round = run_round(flow, data, alternative, "beside_alternative_" + std::to_string(++n), 0.75);
    if (round.decision.chosen < 0) continue;
    const Judged& chosen = round.decision.ranking[std::size_t(round.decision.chosen)];
    if (rms(chosen.fit->residual) >= most) continue;
    flow.out.ranking.insert(flow.out.ranking.begin(), ranked(chosen));
    flow.out.inseparable.resize(std::min<std::size_t>(flow.out.inseparable.size(), 1));  // of the first effect
    std::vector<std::string> set;
    for (const std::size_t i : round.decision.inseparable)
      set.push_back(round.decision.ranking[i].fit->model.parts.back()->label());
    if (!set.empty()) flow.out.inseparable.push_back(std::move(set));
    return *chosen.fit;
  }
  return std::nullopt;
}

}  // namespace pvg::diagnose
