#include "host/identify/search/localise.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>

#include "host/identify/criteria.hpp"

namespace pvg::diagnose {
namespace {

struct PhaseSum {
  double squares = 0;
  std::size_t n = 0;
  std::map<int, std::vector<std::pair<double, double>>> in_run;  // time, square
};

// The first time at which some squares in a row exceed what noise reaches with probability onset_p_value.
double onset_of(PhaseSum& sum) {
  double first = -1;
  for (auto& [run, squares] : sum.in_run) {
    std::sort(squares.begin(), squares.end());
    double stretch = 0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      stretch +=
          squares[i].second - (i >= criteria().onset_n_samples ? squares[i - criteria().onset_n_samples].second : 0);
      if (i + 1 < criteria().onset_n_samples ||
          chi_squared_tail(stretch, double(criteria().onset_n_samples)) > criteria().onset_p_value)
        continue;
      const double time = squares[i + 1 - criteria().onset_n_samples].first;
      if (first < 0 || time < first) first = time;
      break;
    }
  }
  return first;
}

std::set<std::string> bodies_of(const Problem& problem, const std::string& target) {
  const PhysicalScene& scene = problem.scene.scene;
  std::set<std::string> bodies = {target};
  for (const Joint& joint : scene.joints)
    if (joint.name == target)
      for (const int body : {joint.parent, joint.child})
        if (body >= 0) bodies.insert(scene.rigid_bodies[std::size_t(body)].name);
  for (const Channel& channel : problem.channels)
    if (channel.name == target) bodies.insert(channel.subject);
  if (const std::size_t cut = target.find('/'); cut != std::string::npos)
    bodies.insert({target.substr(0, cut), target.substr(cut + 1)});
  return bodies;
}

}  // namespace

double chi_squared_tail(double sum, double n) {
  if (n <= 0) return 1;
  const double spread = 2 / (9 * n);
  const double z = (std::cbrt(sum / n) - (1 - spread)) / std::sqrt(spread);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

std::vector<Cell> localise(const Problem& problem, const std::vector<Window>& windows,
                           const std::vector<Eigen::VectorXd>& residual,
                           const std::vector<std::vector<Phase>>& phases) {
  std::map<std::pair<std::string, std::string>, PhaseSum> sums;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const Run& run = problem.runs[std::size_t(windows[w].run)];
    for (std::size_t i = 0; i < windows[w].data.size(); ++i) {
      const Datum& datum = windows[w].data[i];
      const double square = residual[w][Eigen::Index(i)] * residual[w][Eigen::Index(i)];
      PhaseSum& sum = sums[{problem.channels[std::size_t(datum.channel)].subject, phase_name(phases[w][i])}];
      sum.squares += square;
      ++sum.n;
      sum.in_run[windows[w].run].push_back({run.t[datum.sample] - run.t.front(), square});
    }
  }
  std::vector<Cell> cells;
  double all = 0;
  for (auto& [name, sum] : sums) {
    Cell cell{name.first, name.second};
    cell.n = sum.n;
    cell.rms = std::sqrt(sum.squares / double(sum.n));
    cell.share = std::max(0.0, sum.squares - double(sum.n));
    cell.p_value = chi_squared_tail(sum.squares, double(sum.n));
    cell.onset = onset_of(sum);
    all += cell.share;
    cells.push_back(cell);
  }
  std::sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.p_value < b.p_value; });
  std::size_t n_significant = 0;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (cells[i].p_value <= criteria().false_discoveries * double(i + 1) / double(cells.size())) n_significant = i + 1;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].is_significant = i < n_significant;
    cells[i].share = all > 0 ? cells[i].share / all : 0;
    if (!cells[i].is_significant) cells[i].onset = -1;
  }
  std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.share > b.share; });
  return cells;
}

void order_by_place(const Problem& problem, const std::vector<Cell>& where, std::vector<Candidate>& candidates) {
  std::map<std::string, double> share_at;  // target
  for (const Candidate& candidate : candidates) {
    const auto [at, is_new] = share_at.try_emplace(candidate.target, 0);
    if (!is_new) continue;
    const std::set<std::string> bodies = bodies_of(problem, candidate.target);
    for (const Cell& cell : where)
      if (bodies.contains(cell.body)) at->second += cell.share;
  }
  std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
    return share_at.at(a.target) > share_at.at(b.target);
  });
  constexpr Family TURNS[] = {Family::parameter, Family::physical, Family::measurement};
  const auto turn = [&](Family family) {
    return std::find(std::begin(TURNS), std::end(TURNS), family) - std::begin(TURNS);
  };
  std::map<Family, std::size_t> n_of;
  std::vector<std::pair<std::size_t, std::ptrdiff_t>> key;  // round, turn
  for (const Candidate& c : candidates) key.push_back({n_of[c.family]++, turn(c.family)});
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  std::vector<Candidate> in_turns;
  for (const std::size_t i : order) in_turns.push_back(std::move(candidates[i]));
  candidates = std::move(in_turns);
}

}  // namespace pvg::diagnose
