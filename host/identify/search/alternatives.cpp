#include "host/identify/search/alternatives.hpp"

#include <algorithm>
#include <iterator>

#include "host/identify/criteria.hpp"
#include "host/identify/fit/held_out.hpp"
#include "host/identify/search/round.hpp"
#include "host/identify/search/screening.hpp"

namespace pvg::diagnose {

bool leave_the_same(const Fit& a, const Fit& b) {
  std::vector<Eigen::VectorXd> apart;
  for (std::size_t w = 0; w < a.residual.size(); ++w) apart.push_back(a.residual[w] - b.residual[w]);
  return rms(apart) < criteria().same_residual;
}

bool is_worth_a_second(const Fit& base, const Fit& alternative) {
  return closed(rms(base.residual), rms(alternative.residual), 1) >= criteria().second_gain_least;
}

std::vector<Fit> alternatives_of(Workflow& flow, const FitData& data, const Fit& base,
                                 const std::vector<Fit>& first_round, std::vector<Fit> tried) {
  std::vector<Fit> alternatives;
  for (const Fit& fit : first_round) {
    if (alternatives.size() == criteria().n_alternatives) break;
    if (!is_worth_a_second(base, fit) || !gets_nearer(flow.problem, data, base, fit.residual)) continue;
    if (std::any_of(tried.begin(), tried.end(), [&](const Fit& other) { return leave_the_same(other, fit); })) continue;
    tried.push_back(fit);
    alternatives.push_back(fit);
  }
  return alternatives;
}

std::vector<Screened> pairs_beside(Workflow& flow, const std::vector<Candidate>& candidates, const FitData& data,
                                   const std::vector<Fit>& alternatives) {
  std::vector<Screened> pairs;
  for (std::size_t i = 0; i < alternatives.size(); ++i) {
    const Fit& alternative = alternatives[i];
    flow.report_progress(4, 0.7,
                         "looking for an effect beside " + alternative.model.parts.back()->label() + " instead");
    const Screening screening(flow, data, alternative);
    std::vector<Screened> screened =
        screen(screening.fitter, screening.data, alternative, others_than(candidates, alternative.model));
    flow.files.write_screen("beside_alternative_" + std::to_string(i + 1), screened);
    screened.resize(std::min(screened.size(), criteria().n_pairs_of_one));
    std::move(screened.begin(), screened.end(), std::back_inserter(pairs));
  }
  return pairs;
}

}  // namespace pvg::diagnose
