#include "host/identify/search/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "host/base/counted.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/fit/held_out.hpp"
#include "host/identify/search/identifiability.hpp"
#include "host/identify/search/round.hpp"
#include "host/identify/search/screening.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;
using Columns = std::vector<std::size_t>;

// Scenes that cannot restart from a measured state are simulated as whole runs. A swing whose frequency is a tenth off
// is out of phase after some periods, where a small change does not predict a large one: pairs are searched in the
// first part of the runs and fitted to longer and longer parts.

Pair pair_of(const Signatures& s, const Columns& first, const Columns& second, double n_data) {
  Pair pair{s.candidate[first[0]], s.candidate[second[0]], {}, 0};
  pair.model = model_of({pair.first, pair.second});
  Columns both = first;
  both.insert(both.end(), second.begin(), second.end());
  VectorXd dx = optimum_of(s, both);
  for (std::size_t i = 0; i < both.size(); ++i) {
    const std::size_t column = both[i], k = s.parameter[column];
    const Parameter& p = s.candidate[column]->parameters[k];
    const Eigen::Index place = Eigen::Index(i < first.size() ? k : pair.first->parameters.size() + k);
    const double x = std::clamp(p.off + dx[Eigen::Index(i)] * s.step[column], p.low, p.high);
    dx[Eigen::Index(i)] = (x - p.off) / s.step[column];
    pair.model.x[place] = x;
    pair.model.scale[place] = std::abs(s.step[column]);
  }
  pair.gain = gain_at(s, both, dx) - 0.5 * double(pair.model.x.size()) * std::log(n_data);
  return pair;
}

}  // namespace

std::vector<Pair> best_pairs(const Signatures& signatures, double n_data) {
  std::vector<Columns> columns;  // of each candidate
  for (std::size_t i = 0; i < signatures.candidate.size(); ++i) {
    if (i == 0 || signatures.candidate[i] != signatures.candidate[i - 1]) columns.emplace_back();
    columns.back().push_back(i);
  }
  std::vector<Pair> all;
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (std::size_t k = i + 1; k < columns.size(); ++k) {
      Pair pair = pair_of(signatures, columns[i], columns[k], n_data);
      if (pair.gain > 0) all.push_back(std::move(pair));
    }
  std::stable_sort(all.begin(), all.end(), [](const Pair& a, const Pair& b) { return a.gain > b.gain; });
  std::vector<Pair> best;
  std::map<const Candidate*, std::size_t> n_of;
  for (Pair& pair : all) {
    if (best.size() >= criteria().n_pairs) break;
    if (n_of[pair.first] >= criteria().n_pairs_of_one || n_of[pair.second] >= criteria().n_pairs_of_one) continue;
    ++n_of[pair.first];
    ++n_of[pair.second];
    best.push_back(std::move(pair));
  }
  return best;
}

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

namespace {

std::vector<Screened> pairs_to_fit(const Signatures& signatures, const Fit& base) {
  double n_data = 0;
  for (const VectorXd& r : base.residual) n_data += double(r.size());
  std::vector<Screened> starts;
  for (Pair& pair : best_pairs(signatures, n_data))
    starts.push_back({pair.first, joined(base.model, pair.model), pair.gain, 0});
  return starts;
}

std::vector<Screened> pairs_to_fit(Workflow& flow, const std::vector<Candidate>& all, const FitData& data,
                                   const Fit& base) {
  std::vector<const Candidate*> candidates;
  for (const Candidate& c : all) candidates.push_back(&c);
  const Screening screening(flow, data, base);
  return pairs_to_fit(signatures_of(screening.fitter, screening.data, base, candidates), base);
}

bool has_same_parts(const Model& a, const Model& b) {
  return std::is_permutation(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end());
}

// The pairs, each fitted to longer and longer first parts.
std::vector<Screened> pairs_of_first_parts(Workflow& flow, const std::vector<Candidate>& all, const FitData& data) {
  std::vector<Screened> starts;
  const double first_share = criteria().pair_first_part;
  for (const double share : {first_share, criteria().pair_second_part}) {
    const FitData part = first_part(flow.problem, data, share);
    const Fit base = fit_as_it_stands(flow.fitter, part);
    if (share == first_share) starts = pairs_to_fit(flow, all, part, base);
    if (starts.empty()) break;
    std::vector<Screened> next;
    for (Fit& fit : fit_best(flow, part, base, starts))
      if (fit.succeeded && !fit.is_given_up) next.push_back({fit.model.parts.back(), std::move(fit.model), 0, 0});
    starts = std::move(next);
  }
  return starts;
}

// Beside each alternative the effects that explain most of what it leaves, each pair from where both were found.
std::vector<Screened> pairs_beside(Workflow& flow, const std::vector<Candidate>& candidates, const FitData& data,
                                   const std::vector<Fit>& alternatives, const Changes& known) {
  std::vector<Screened> pairs;
  for (std::size_t i = 0; i < alternatives.size(); ++i) {
    const Fit& alternative = alternatives[i];
    flow.report_progress(4, 0.7,
                         "looking for an effect beside " + alternative.model.parts.back()->label() + " instead");
    const std::vector<const Candidate*> others = others_than(candidates, alternative.model);
    std::vector<Screened> screened;
    if (known.trials.empty()) {
      const Screening screening(flow, data, alternative);
      screened = screen(screening.fitter, screening.data, alternative, others, nullptr, effort_of(flow)).best;
    } else {
      screened = screen_by_changes(data, alternative, others, known);
    }
    flow.files.write_screen("beside_alternative_" + std::to_string(i + 1), screened);
    screened.resize(std::min(screened.size(), known.trials.empty() ? criteria().n_pairs_of_one : 1));
    std::move(screened.begin(), screened.end(), std::back_inserter(pairs));
  }
  return pairs;
}

}  // namespace

std::optional<FoundPair> find_pair(Workflow& flow, const std::vector<Candidate>& candidates, const FitData& data,
                                   const Fit& base, const std::vector<Fit>& alternatives, double most,
                                   const FirstRound& first_round) {
  const bool are_known = !first_round.changes.trials.empty();
  std::vector<Screened> starts = are_known                  ? pairs_to_fit(first_round.signatures, base)
                                 : flow.problem.can_restart ? pairs_to_fit(flow, candidates, data, base)
                                                            : pairs_of_first_parts(flow, candidates, data);
  if (are_known) starts.resize(std::min(starts.size(), effort_of(flow).n_fitted));
  // what was simulated beside an alternative is a better start than a sum of small changes
  for (Screened& pair : pairs_beside(flow, candidates, data, alternatives, first_round.changes)) {
    std::erase_if(starts, [&](const Screened& sum) { return has_same_parts(sum.model, pair.model); });
    starts.push_back(std::move(pair));
  }
  if (starts.empty()) return std::nullopt;
  flow.report_progress(5, 0.8, "fitting " + counted(starts.size(), "pair") + " of candidates");
  const std::vector<Fit> fits = fit_best(flow, data, base, starts);
  const Decision decision = decide(data, base, fits);
  flow.files.write_fits("pairs", decision);
  if (decision.chosen < 0) return std::nullopt;
  const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
  if (rms(chosen.fit->residual) >= most) return std::nullopt;
  std::map<std::string, std::size_t> n_of;  // inseparable pairs that hold an effect
  for (const std::size_t i : decision.inseparable)
    for (const Candidate* part : decision.ranking[i].fit->model.effects()) ++n_of[part->label()];
  FoundPair found{*chosen.fit, ranked(chosen), {}};
  for (const auto& [label, n] : n_of)  // what all of them hold is not in doubt
    if (n < decision.inseparable.size()) found.inseparable.push_back(label);
  return found;
}

}  // namespace pvg::diagnose
