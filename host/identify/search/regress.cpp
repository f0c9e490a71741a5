#include "host/identify/search/regress.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "host/identify/candidates/law_dictionary.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/search/round.hpp"
#include "host/identify/search/screening.hpp"

namespace pvg::diagnose {
namespace {

using Eigen::VectorXd;

constexpr std::size_t SIMULATIONS_PER_LAW = 2;  // for its signature: to find the size of the change, and the change
constexpr double LAW_COMPILATION = 5;  // of the kernels of a site's laws, which no deadline ends [processor seconds]

// all ascending sets of `size` numbers below n
template <class Visit>
void for_each_subset(std::size_t n, std::size_t size, std::vector<std::size_t>& chosen, const Visit& visit) {
  if (chosen.size() == size) {
    visit(chosen);
    return;
  }
  for (std::size_t i = chosen.empty() ? 0 : chosen.back() + 1; i < n; ++i) {
    chosen.push_back(i);
    for_each_subset(n, size, chosen, visit);
    chosen.pop_back();
  }
}

// A sum of laws of a site, and the candidate that it is.
struct Sum {
  const LawSite* site;
  std::vector<std::size_t> laws;
  Candidate candidate;
  VectorXd start, scale;  // of its coefficients
};

// the best sums of a site's laws, from their signatures
void add_sums(const Screening& screening, const ChosenWindows& chosen, const LawSite& site, std::deque<Sum>& sums) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < site.laws.size(); ++i) all.push_back(i);
  const Candidate whole = law_candidate(site, all);
  const Signatures found = signatures_of(screening.fitter, screening.data, chosen.base, {&whole});
  for (const std::vector<std::size_t>& columns : best_subsets(found, criteria().n_laws, criteria().n_sums)) {
    Sum sum{&site, {}, {}, VectorXd(Eigen::Index(columns.size())), VectorXd(Eigen::Index(columns.size()))};
    for (std::size_t i = 0; i < columns.size(); ++i) {
      sum.laws.push_back(found.parameter[columns[i]]);
      sum.scale[Eigen::Index(i)] = std::abs(found.step[columns[i]]);
    }
    const VectorXd x = optimum_of(found, columns);
    sum.candidate = law_candidate(site, sum.laws);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const Parameter& p = sum.candidate.parameters[i];
      sum.start[Eigen::Index(i)] = std::clamp(x[Eigen::Index(i)] * found.step[columns[i]], p.low, p.high);
    }
    sums.push_back(std::move(sum));
  }
}

// those where most of the misfit is
std::vector<LawSite> worst_sites(const Problem& problem, const std::vector<Cell>& where) {
  std::vector<LawSite> sites = law_sites(problem);
  const PhysicalScene& scene = problem.scene.scene;
  const auto share_of = [&](const LawSite& site) {
    double share = 0;
    for (const Cell& cell : where)
      for (const Joint& joint : scene.joints)
        if (cell.body == site.target ||
            (joint.name == site.target && scene.rigid_bodies[std::size_t(joint.child)].name == cell.body)) {
          share += cell.share;
          break;
        }
    return share;
  };
  std::stable_sort(sites.begin(), sites.end(),
                   [&](const LawSite& a, const LawSite& b) { return share_of(a) > share_of(b); });
  if (sites.size() > criteria().n_law_sites) sites.resize(criteria().n_law_sites);
  return sites;
}

}  // namespace

std::vector<std::vector<std::size_t>> best_subsets(const Signatures& signatures, std::size_t most, std::size_t n_each) {
  std::vector<std::vector<std::size_t>> best;
  const std::size_t n = std::size_t(signatures.g.size());
  for (std::size_t size = 1; size <= std::min(most, n); ++size) {
    std::vector<std::pair<double, std::vector<std::size_t>>> found;
    std::vector<std::size_t> chosen;
    for_each_subset(n, size, chosen, [&](const std::vector<std::size_t>& columns) {
      found.emplace_back(-gain_at(signatures, columns, optimum_of(signatures, columns)), columns);
    });
    const std::size_t kept = std::min(n_each, found.size());
    std::partial_sort(found.begin(), found.begin() + std::ptrdiff_t(kept), found.end());
    for (std::size_t i = 0; i < kept; ++i) best.push_back(found[i].second);
  }
  return best;
}

std::optional<Regressed> regress(Workflow& flow, const ChosenWindows& chosen, const std::vector<Cell>& where,
                                 bool in_noise) {
  const std::vector<LawSite> sites = worst_sites(flow.problem, where);
  std::deque<Sum> sums;  // candidates stay where they are
  const Screening screening(flow, chosen.data, chosen.base);
  for (const LawSite& site : sites) add_sums(screening, chosen, site, sums);
  std::vector<Screened> starts;
  for (const Sum& sum : sums)
    starts.push_back({&sum.candidate, joined(chosen.base.model, {{&sum.candidate}, sum.start, sum.scale}), 0, 0});
  if (starts.empty()) return std::nullopt;
  const std::vector<Fit> fits = fit_best(flow, chosen.data, chosen.base, starts);
  const Decision decision = decide(chosen.data, chosen.base, fits);
  if (decision.chosen < 0) return std::nullopt;
  const Judged& best = decision.ranking[std::size_t(decision.chosen)];
  const Sum& sum = *std::find_if(sums.begin(), sums.end(),
                                 [&](const Sum& other) { return &other.candidate == best.fit->model.parts.back(); });
  const std::size_t most = most_windows(flow.problem, flow.settings.simulated_seconds, chosen.length);
  HeldOut judged = judge_held_out(flow.fitter, flow.problem, chosen.length, most, {best.fit->model}, in_noise);
  const double gap_closed = closed(judged.before, judged.after, judged.floor);
  if (judged.floor == 0 || gap_closed < criteria().gap_closed_least) return std::nullopt;
  const std::vector<double> coefficients(best.fit->model.x.begin() + best.fit->model.n_nuisances(),
                                         best.fit->model.x.end());
  RegressedLaw law{sum.site->effect,
                   sum.site->target,
                   sum.site->unit,
                   shown_sum(*sum.site, sum.laws, coefficients),
                   {},
                   judged.before,
                   judged.after,
                   judged.floor,
                   gap_closed,
                   best.error};
  std::vector<Curve> curves = std::move(judged.curves);
  const std::vector<Curve> fitted = curves_of(flow.problem, chosen.data, chosen.base, *best.fit, CURVES_OF_FITTED_RUNS);
  curves.insert(curves.end(), fitted.begin(), fitted.end());
  law.amended = law_effect(*sum.site, sum.laws, coefficients);
  return Regressed{std::move(law), std::move(curves)};
}

namespace {

std::size_t n_laws_tried(const Problem& problem, const std::vector<Cell>& where) {
  std::size_t n = 0;
  for (const LawSite& site : worst_sites(problem, where)) n += site.laws.size();
  return n;
}

}  // namespace

std::optional<Regressed> find_law(Workflow& flow, const ChosenWindows& chosen, const std::vector<Cell>& where,
                                  const std::string& unit) {
  std::optional<Regressed> found;
  double expected = flow.by_the_clock(LAW_COMPILATION);
  if (flow.is_costly()) {  // else not even the changes that the laws make come to their end
    const double each = flow.seconds() / double(std::max<std::size_t>(flow.predictor.n_simulations(), 1));
    expected += each * double(SIMULATIONS_PER_LAW * n_laws_tried(flow.problem, where));
  }
  if (!flow.has_time("a law without a name", expected, criteria().time_proof)) return found;
  flow.report_progress(7, 0.6, "none of the known effects explains it all: looking for a law of the motion");
  flow.ends_in_time(criteria().time_proof, "a law without a name",
                    [&] { found = regress(flow, chosen, where, unit == "noise"); });
  return found;
}

}  // namespace pvg::diagnose
