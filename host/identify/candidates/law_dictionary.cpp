#include "host/identify/candidates/law_dictionary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "host/identify/criteria.hpp"
#include "host/identify/data/start_places.hpp"
#include "host/identify/data/window.hpp"

namespace pvg::diagnose {
namespace {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// Of one measured number over all runs.
struct Range {
  double low = 0, high = 0, fastest = 0;  // [unit], [unit/s]
  bool is_there = false;
  double at(double share) const { return low + share * (high - low); }
};

template <class Value>
Range range_of(const Problem& problem, const Value& value_of) {
  const std::size_t apart = criteria().law_speed_n_samples;
  Range range{INFINITY, -INFINITY, 0, false};
  for (const Run& run : problem.runs) {
    if (run.is_held_out) continue;
    for (std::size_t i = 0; i < run.t.size(); ++i) {
      const double value = value_of(run, i);
      if (!std::isfinite(value)) continue;
      range.low = std::min(range.low, value);
      range.high = std::max(range.high, value);
      if (i < apart || !(run.t[i] > run.t[i - apart])) continue;
      const double speed = std::abs(value - value_of(run, i - apart)) / (run.t[i] - run.t[i - apart]);
      if (std::isfinite(speed)) range.fastest = std::max(range.fastest, speed);
    }
  }
  range.is_there = range.high > range.low;
  return range;
}

// Of a joint that no channel measures itself: from starts of short windows, which the places of its bodies tell.
Range range_of_starts(const Problem& problem, std::size_t joint) {
  Range range{INFINITY, -INFINITY, 0, false};
  for (const Window& window : make_windows(problem, false, criteria().locate_window, criteria().n_windows_most)) {
    range.low = std::min(range.low, window.initial.position[joint]);
    range.high = std::max(range.high, window.initial.position[joint]);
    range.fastest = std::max(range.fastest, std::abs(window.initial.rate[joint]));
  }
  range.is_there = range.high > range.low;
  return range;
}

// site joint position: constant, powers, waves, saturating, local and one-sided laws; site joint rate: drags and
// frictions; and both. What brakes has a positive coefficient, since that is tried first: with the other sign a drag on
// v^2 lets a motion grow beyond all bounds in a finite time, for which all worlds of a batch wait.
std::vector<Law> joint_laws(const Range& q) {
  std::vector<Law> laws;
  const auto add = [&](const std::string& formula) { laws.push_back({{formula}, formula}); };
  for (const char* power : {"1", "q", "q * q", "q * q * q"}) add(power);
  for (const double n : criteria().law_waves) {
    add("sin(" + number(n) + " * q)");
    if (n > 1) add("cos(" + number(n) + " * q)");
  }
  const double reach = std::max(std::abs(q.low), std::abs(q.high));
  for (const double share : criteria().law_bump_widths)
    add("q * exp(-q * q / " + number(share * share * reach * reach) + ")");
  for (const double share : criteria().law_onsets) add("fmax(q - " + number(q.at(share)) + ", 0)");
  const std::string sliding = "tanh(v / " + number(criteria().law_sliding_speed * q.fastest) + ")";
  for (const std::string& law :
       {std::string("-v"), std::string("-fabs(v) * v"), "-" + sliding, "q * " + sliding, std::string("-q * q * v")})
    add(law);
  return laws;
}

// place: constant, linear in each direction, a pull that begins at a distance from the origin; velocity: linear in each
// direction, drag, friction, and friction of a ring about the origin
std::vector<Law> force_laws(const Range& distance, double fastest) {
  std::vector<Law> laws;
  const std::string place[] = {"x", "y", "z"}, velocity[] = {"vx", "vy", "vz"};
  const auto add_component = [&](std::size_t i, const std::string& formula) {
    Law law{{"0", "0", "0"}, ""};
    law.formulas[i] = formula;
    law.shown = "(" + law.formulas[0] + ", " + law.formulas[1] + ", " + law.formulas[2] + ")";
    laws.push_back(law);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    add_component(i, "1");
    for (int k = 0; k < 3; ++k) {
      add_component(i, place[k]);
      add_component(i, velocity[k]);
    }
  }
  // `factor` holds r and |v|, which are written out in the formula
  const auto along = [&](const std::string& factor, const std::string(&direction)[3]) {
    const std::pair<std::string, std::string> meant[] = {
        {"|v|", "sqrt(vx * vx + vy * vy + vz * vz + " + number(1e-6 * fastest * fastest) + ")"},
        {"{r}", "sqrt(x * x + y * y + z * z + 1e-12)"}};
    Law law{{}, factor + " (" + direction[0] + ", " + direction[1] + ", " + direction[2] + ")"};
    std::string text = factor;
    for (const auto& [name, formula] : meant)
      for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name))
        text.replace(at, name.size(), formula);
    for (const std::string& component : direction) law.formulas.push_back(text + " * " + component);
    for (std::size_t at = law.shown.find("{r}"); at != std::string::npos; at = law.shown.find("{r}"))
      law.shown.replace(at, 3, "r");
    laws.push_back(law);
  };
  along("-|v|", velocity);
  along("-1 / |v|", velocity);
  for (const double share : criteria().law_pull_distances)
    along("fmax(1 - " + number(distance.at(share)) + " / {r}, 0)", place);
  const std::string width = number(criteria().law_ring_width * (distance.high - distance.low));
  for (const double share : criteria().law_ring_distances)
    along("-exp(-pow(({r} - " + number(distance.at(share)) + ") / " + width + ", 2)) / |v|", velocity);
  return laws;
}

// c_i * law, summed up, of each component
std::vector<std::string> sums_of(const LawSite& site, std::span<const std::size_t> laws,
                                 const std::vector<std::string>& coefficients) {
  std::vector<std::string> sums(site.laws.front().formulas.size());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    for (std::size_t i = 0; i < laws.size(); ++i) {
      const std::string& formula = site.laws[laws[i]].formulas[k];
      if (formula == "0") continue;
      sums[k] += (sums[k].empty() ? "" : " + ") + coefficients[i] + (formula == "1" ? "" : " * " + formula);
    }
    if (sums[k].empty()) sums[k] = "0";
  }
  return sums;
}

void add_joint(const Problem& problem, std::size_t j, std::vector<LawSite>& sites) {
  const Joint& joint = problem.scene.scene.joints[j];
  const RigidBody& child = problem.scene.scene.rigid_bodies[std::size_t(joint.child)];
  const auto channel = std::find_if(problem.channels.begin(), problem.channels.end(), [&](const Channel& c) {
    return c.joint == int(j) && c.sensor->start == StartRole::place;
  });
  const bool is_measured = channel != problem.channels.end();
  const std::vector<int> seen = joints_seen_by_places(problem);
  const bool is_seen = problem.can_restart && std::find(seen.begin(), seen.end(), int(j)) != seen.end();
  if ((!is_measured && !is_seen) || !can_move(child)) return;
  const std::size_t c = std::size_t(channel - problem.channels.begin());
  const Range q = is_measured ? range_of(problem, [&](const Run& run, std::size_t i) { return run.values[c][i]; })
                              : range_of_starts(problem, j);
  const bool turns = joint.type == Joint::Type::revolute;
  if (q.is_there)
    sites.push_back({"regressed_effort", joint.name, turns ? "N m" : "N", criteria().law_change * 9.81 * child.mass,
                     joint_laws(q)});
}

void add_body(const Problem& problem, std::size_t b, std::vector<LawSite>& sites) {
  const PhysicalScene& scene = problem.scene.scene;
  const RigidBody& body = scene.rigid_bodies[b];
  const bool is_carried =
      std::any_of(scene.joints.begin(), scene.joints.end(), [&](const Joint& joint) { return joint.child == int(b); });
  const auto channel = std::find_if(problem.channels.begin(), problem.channels.end(), [&](const Channel& c) {
    return c.rigid == int(b) && c.sensor->start == StartRole::place && c.width == 3;
  });
  if (is_carried || !can_move(body) || channel == problem.channels.end()) return;
  const std::size_t c = std::size_t(channel - problem.channels.begin());
  const auto place = [&](const Run& run, std::size_t i) {
    return Vec3(run.values[c][3 * i], run.values[c][3 * i + 1], run.values[c][3 * i + 2]);
  };
  const Range distance = range_of(problem, [&](const Run& run, std::size_t i) { return place(run, i).norm(); });
  double fastest = 0;
  for (int k = 0; k < 3; ++k)
    fastest =
        std::hypot(fastest, range_of(problem, [&](const Run& run, std::size_t i) { return place(run, i)[k]; }).fastest);
  if (distance.is_there)
    sites.push_back(
        {"regressed_force", body.name, "N", criteria().law_change * 9.81 * body.mass, force_laws(distance, fastest)});
}

}  // namespace

std::vector<LawSite> law_sites(const Problem& problem) {
  std::vector<LawSite> sites;
  for (std::size_t j = 0; j < problem.scene.scene.joints.size(); ++j) add_joint(problem, j, sites);
  for (std::size_t b = 0; b < problem.scene.scene.rigid_bodies.size(); ++b) add_body(problem, b, sites);
  return sites;
}

namespace {
std::vector<std::string> coefficient_names(std::size_t n) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < n; ++i) names.push_back("c" + std::to_string(i));
  return names;
}
}  // namespace

Effect law_effect(const LawSite& site, std::span<const std::size_t> laws, std::span<const double> coefficients) {
  Effect effect{site.effect, site.target, {}, sums_of(site, laws, coefficient_names(laws.size()))};
  effect.parameters.assign(coefficients.begin(), coefficients.end());
  return effect;
}

Candidate law_candidate(const LawSite& site, std::span<const std::size_t> laws) {
  Candidate candidate;
  candidate.name = site.effect;
  candidate.target = site.target;
  candidate.meaning = "a law that a regression found";
  for (const std::string& name : coefficient_names(laws.size()))
    candidate.parameters.push_back({name, site.unit, -criteria().law_coefficient_most * site.scale,
                                    criteria().law_coefficient_most * site.scale, 0, site.scale});
  candidate.equation = law_effect(site, laws, {}).formulas[0];
  std::vector<std::size_t> all(site.laws.size());
  std::iota(all.begin(), all.end(), 0);
  candidate.apply = [whole = law_effect(site, all, std::vector<double>(all.size(), 0.0)),
                     places = std::vector<std::size_t>(laws.begin(), laws.end())](Variant& variant,
                                                                                  std::span<const double> values) {
    Effect effect = whole;
    for (std::size_t i = 0; i < places.size(); ++i) effect.parameters[places[i]] = values[i];
    variant.scene.effects.push_back(std::move(effect));
  };
  candidate.amend = amend_last_effect;
  return candidate;
}

std::string shown_sum(const LawSite& site, std::span<const std::size_t> laws, std::span<const double> coefficients) {
  std::string sum;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const bool is_negative = site.laws[laws[i]].shown.starts_with("-");
    const std::string law = site.laws[laws[i]].shown.substr(is_negative);
    const double c = is_negative ? -coefficients[i] : coefficients[i];
    sum += sum.empty() ? number(c) : (c < 0 ? " - " : " + ") + number(std::abs(c));
    if (law != "1") sum += " " + law;
  }
  return sum;
}

}  // namespace pvg::diagnose
