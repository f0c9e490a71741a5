#include "pipeline/diagnose/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;
using Columns = std::vector<std::size_t>;

Model model_of(const std::vector<const Candidate*>& parts) {
  Model model{parts, {}, {}};
  const std::vector<const Parameter*> parameters = model.parameters();
  model.x.resize(Eigen::Index(parameters.size()));
  model.scale.resize(model.x.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    model.x[Eigen::Index(i)] = parameters[i]->off;
    model.scale[Eigen::Index(i)] = parameters[i]->scale;
  }
  return model;
}

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
    if (best.size() >= MOST_PAIRS) break;
    if (n_of[pair.first] >= MOST_OF_ONE || n_of[pair.second] >= MOST_OF_ONE) continue;
    ++n_of[pair.first];
    ++n_of[pair.second];
    best.push_back(std::move(pair));
  }
  return best;
}

std::optional<Fit> find_pair(Workflow& flow, const FitData& data, const Fit& base, double most) {
  std::vector<const Candidate*> candidates;
  for (const Candidate& c : *flow.out.candidates) candidates.push_back(&c);
  double n_data = 0;
  for (const VectorXd& r : base.residual) n_data += double(r.size());
  std::vector<Screened> starts;
  for (Pair& pair : best_pairs(signatures_of(flow.fitter, data, base, candidates), n_data))
    starts.push_back({pair.first, std::move(pair.model), pair.gain, 0});
  if (starts.empty()) return std::nullopt;
  flow.tell(5, 0.8, "fitting " + std::to_string(starts.size()) + " pairs of candidates");
  const std::vector<Fit> fits = fit_best(flow.fitter, data, starts);
  const Decision decision = decide(data, base, fits);
  if (decision.chosen < 0) return std::nullopt;
  const Judged& chosen = decision.ranking[std::size_t(decision.chosen)];
  if (rms(chosen.fit->residual) >= most) return std::nullopt;
  flow.out.ranking.insert(flow.out.ranking.begin(), ranked(chosen));
  std::set<std::string> labels;
  for (const std::size_t i : decision.inseparable)
    for (const Candidate* part : decision.ranking[i].fit->model.parts) labels.insert(part->label());
  flow.out.inseparable.clear();
  if (!labels.empty()) flow.out.inseparable.push_back({labels.begin(), labels.end()});
  return *chosen.fit;
}

}  // namespace pvg::diagnose
