// Scores of the hidden-effect suite, from report.json and truth.json of each case. truth.json, schema 1:
//   kind: single | null | off_library | retune | two | control     strength: error over the noise floor     source: who
//   made it effects: [{name, target, parameters: {name: value}, accept: [other names that say the same]}] body, phases:
//   where it acts                           onset_s
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "host/base/counted.hpp"
#include "host/identify/report/score.hpp"

namespace pvg::diagnose {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

struct Case {
  std::string name;
  json truth, report;  // report: null where the case failed
};

std::vector<Case> cases_of(const fs::path& suite, const fs::path& reports) {
  std::vector<Case> cases;
  for (const auto& entry : fs::directory_iterator(suite)) {
    const std::string name = entry.path().filename().string();
    if (!fs::exists(entry.path() / "truth.json")) continue;
    Case one{name, json::parse(std::ifstream(entry.path() / "truth.json")), {}};
    if (fs::exists(reports / name / "report.json"))
      one.report = json::parse(std::ifstream(reports / name / "report.json"));
    cases.push_back(std::move(one));
  }
  std::sort(cases.begin(), cases.end(), [](const Case& a, const Case& b) { return a.name < b.name; });
  return cases;
}

std::string kind_of(const Case& c) { return c.truth["kind"]; }
std::string verdict_of(const Case& c) { return c.report.is_null() ? "failed" : c.report["verdict"].get<std::string>(); }

bool same(const json& truth, const std::string& name) {
  if (truth["name"] == name) return true;
  if (!truth.contains("accept")) return false;
  return std::any_of(truth["accept"].begin(), truth["accept"].end(), [&](const json& other) { return other == name; });
}

bool names(const Case& c, const json& effect) {
  if (c.report.is_null()) return false;
  return std::any_of(c.report["effects"].begin(), c.report["effects"].end(),
                     [&](const json& e) { return same(effect, e["name"]); });
}

bool names_all(const Case& c) {
  const std::size_t n = c.report.is_null() ? 0 : c.report["effects"].size();
  return n > 0 && n <= c.truth["effects"].size() &&
         std::all_of(c.truth["effects"].begin(), c.truth["effects"].end(), [&](const json& e) { return names(c, e); });
}

// Wilson's interval of a share, 95 %
std::string share_of(std::size_t k, std::size_t n) {
  if (n == 0) return "no case";
  const double z = 1.96, p = double(k) / double(n), m = double(n);
  const double middle = (p + z * z / (2 * m)) / (1 + z * z / m);
  const double half = z * std::sqrt(p * (1 - p) / m + z * z / (4 * m * m)) / (1 + z * z / m);
  char text[80];
  std::snprintf(text, sizeof text, "%zu of %zu, %.0f %% [%.0f, %.0f]", k, n, 100 * p,
                100 * std::max(middle - half, 0.0), 100 * (middle + half));
  return text;
}

std::string median_of(std::vector<double> values) {
  if (values.empty()) return "no case";
  std::sort(values.begin(), values.end());
  char text[80];
  std::snprintf(text, sizeof text, "%.1f %% (quartiles %.1f, %.1f; %s)", 100 * values[values.size() / 2],
                100 * values[values.size() / 4], 100 * values[values.size() * 3 / 4],
                pvg::counted(values.size(), "case").c_str());
  return text;
}

using Test = std::function<bool(const Case&)>;

std::string counted(const std::vector<Case>& cases, const Test& belongs, const Test& holds) {
  std::size_t n = 0, k = 0;
  for (const Case& c : cases) {
    if (!belongs(c)) continue;
    ++n;
    k += holds(c);
  }
  return share_of(k, n);
}

bool is_single(const Case& c) { return kind_of(c) == "single"; }

std::vector<double> parameter_errors(const std::vector<Case>& cases) {
  std::vector<double> errors;
  for (const Case& c : cases) {
    if (c.report.is_null() || !names_all(c)) continue;
    for (const json& truth : c.truth["effects"])
      for (const json& found : c.report["effects"])
        if (truth["name"] == found["name"])
          for (const auto& [name, value] : truth["parameters"].items())
            if (found["parameters"].contains(name) && value.get<double>() != 0)
              errors.push_back(std::abs(found["parameters"][name]["value"].get<double>() / value.get<double>() - 1));
  }
  return errors;
}

// Whether the interval of two standard deviations of each parameter holds the truth.
std::vector<bool> intervals_that_hold(const std::vector<Case>& cases) {
  std::vector<bool> held;
  for (const Case& c : cases) {
    if (c.report.is_null() || !names_all(c)) continue;
    for (const json& truth : c.truth["effects"])
      for (const json& found : c.report["effects"])
        if (truth["name"] == found["name"])
          for (const auto& [name, value] : truth["parameters"].items())
            if (found["parameters"].contains(name)) {
              const json& p = found["parameters"][name];
              held.push_back(p["low"].get<double>() <= value.get<double>() &&
                             value.get<double>() <= p["high"].get<double>());
            }
  }
  return held;
}

bool names_something(const Case& c) { return !c.report.is_null() && !c.report["effects"].empty(); }

// true name: in the chosen effects or in a reported inseparable set
bool in_set(const Case& c) {
  if (c.report.is_null()) return false;
  return std::all_of(c.truth["effects"].begin(), c.truth["effects"].end(), [&](const json& effect) {
    if (names(c, effect)) return true;
    for (const json& set : c.report["inseparable"])
      for (const json& label : set)
        if (same(effect, label.get<std::string>().substr(0, label.get<std::string>().find(" at ")))) return true;
    return false;
  });
}

bool right_place(const Case& c) {
  if (c.report.is_null() || c.report["where"].empty() || !c.truth.contains("body")) return false;
  const json& top = c.report["where"][0];
  const json& phases = c.truth["phases"];
  return top["body"] == c.truth["body"] && std::find(phases.begin(), phases.end(), top["phase"]) != phases.end();
}

using Row = std::array<std::string, 3>;  // metric, what it must be, what was found

Row row_of_kind(const char* metric, const char* must, const std::vector<Case>& cases, const char* kind,
                bool (*holds)(const Case&)) {
  return {metric, must,
          counted(
              cases, [kind](const Case& c) { return kind_of(c) == kind; }, holds)};
}

bool is_strong(const Case& c) { return c.truth.value("strength", 0.0) >= 9.9; }
bool is_none(const Case& c) { return verdict_of(c) == "none"; }
bool names_an_effect(const Case& c) { return verdict_of(c) == "effect"; }
bool lies_outside(const Case& c) { return kind_of(c) == "off_library" || kind_of(c) == "control"; }
bool is_worse_after(const Case& c) { return c.report["held_out"]["after"] > c.report["held_out"]["before"]; }

// What was named, and where.
void add_rows_of_names(const std::vector<Case>& cases, std::vector<Row>& rows) {
  rows.push_back({"right name first, error >= 10x floor", ">= 90 %",
                  counted(
                      cases, [](const Case& c) { return is_single(c) && is_strong(c); }, names_all)});
  rows.push_back({"right name first, error about 3x floor", ">= 70 %",
                  counted(
                      cases, [](const Case& c) { return is_single(c) && !is_strong(c); }, names_all)});
  rows.push_back(row_of_kind("an effect named on a null", "<= 5 %", cases, "null", names_something));
  rows.push_back(row_of_kind("an effect named on a control", "<= 2 %", cases, "control", names_something));
  rows.push_back(row_of_kind("none on off-library cases: recall", ">= 80 %", cases, "off_library", is_none));
  rows.push_back({"none on off-library cases: precision", ">= 80 %", counted(cases, is_none, lies_outside)});
  rows.push_back(row_of_kind("a retune trap named as a new effect", "<= 10 %", cases, "retune", names_an_effect));
  rows.push_back(row_of_kind("a retune trap: the right parameter", "", cases, "retune", names_all));
  rows.push_back({"right body and phase", ">= 95 %",
                  counted(
                      cases, [](const Case& c) { return is_single(c) && c.truth.contains("body"); }, right_place)});
}

std::vector<double> gaps_closed(const std::vector<Case>& cases) {
  std::vector<double> gaps;
  for (const Case& c : cases)
    if ((is_single(c) || kind_of(c) == "two" || kind_of(c) == "retune") && !c.report.is_null() &&
        c.report["held_out"]["floor"].get<double>() > 0)
      gaps.push_back(names_something(c) ? c.report["held_out"]["gap_closed"].get<double>() : 0);
  return gaps;
}

// Of what was named.
std::vector<double> gaps_closed_of_whole_runs(const std::vector<Case>& cases) {
  std::vector<double> gaps;
  for (const Case& c : cases)
    if (names_something(c) && c.report["held_out"].contains("whole_runs") &&
        c.report["held_out"]["whole_runs"].contains("gap_closed"))
      gaps.push_back(c.report["held_out"]["whole_runs"]["gap_closed"].get<double>());
  return gaps;
}

std::vector<Row> table_of(const std::vector<Case>& cases) {
  std::vector<Row> rows;
  add_rows_of_names(cases, rows);
  rows.push_back({"parameter error, median", "<= 10 %", median_of(parameter_errors(cases))});
  rows.push_back({"held-out gap closed, median", ">= 90 %", median_of(gaps_closed(cases))});
  rows.push_back({"the same of whole runs, of what was named", ">= 95 %", median_of(gaps_closed_of_whole_runs(cases))});
  const std::vector<bool> held = intervals_that_hold(cases);
  rows.push_back({"stated intervals hold the truth", ">= 90 %",
                  share_of(std::size_t(std::count(held.begin(), held.end(), true)), held.size())});
  rows.push_back({"held-out made worse", "<= 2 %", counted(cases, names_something, is_worse_after)});
  rows.push_back(row_of_kind("two effects, both named", ">= 70 %", cases, "two", names_all));
  const auto is_named_single = [](const Case& c) {
    return (is_single(c) || kind_of(c) == "retune") && names_something(c);
  };
  rows.push_back({"true effect inside the reported set", ">= 98 %", counted(cases, is_named_single, in_set)});
  return rows;
}

std::string truth_label(const Case& c) {
  if (c.truth["effects"].empty()) return kind_of(c) == "null" ? "agrees" : "none";
  std::string label;
  for (const json& e : c.truth["effects"]) label += (label.empty() ? "" : " + ") + e["name"].get<std::string>();
  return label;
}

std::string report_label(const Case& c) {
  if (c.report.is_null()) return "failed";
  if (c.report["effects"].empty()) return verdict_of(c);
  std::string label;
  for (const json& e : c.report["effects"]) label += (label.empty() ? "" : " + ") + e["name"].get<std::string>();
  return label;
}

}  // namespace

Score score(const std::string& suite, const std::string& reports) {
  const std::vector<Case> cases = cases_of(suite, reports);
  Score result;
  json out = {{"schema", 1}, {"cases", cases.size()}};
  for (const auto& row : table_of(cases)) {
    char line[240];
    std::snprintf(line, sizeof line, "%-42s %-10s %s\n", row[0].c_str(), row[1].c_str(), row[2].c_str());
    result.text += line;
    out["table"].push_back({{"metric", row[0]}, {"must", row[1]}, {"found", row[2]}});
  }
  std::map<std::string, std::map<std::string, int>> confusion;
  double seconds = 0;
  std::vector<double> each;
  for (const Case& c : cases) {
    ++confusion[truth_label(c)][report_label(c)];
    if (c.report.is_null()) continue;
    each.push_back(c.report["seconds"].get<double>());
    seconds += each.back();
  }
  std::sort(each.begin(), each.end());
  result.text += "\ntruth -> named, number of cases\n";
  for (const auto& [truth, named] : confusion) {
    std::string line = truth + " ->";
    for (const auto& [name, n] : named) line += " " + name + " " + std::to_string(n) + ";";
    result.text += "  " + line + "\n";
    for (const auto& [name, n] : named) out["confusion"][truth][name] = n;
  }
  std::string misses;
  for (const Case& c : cases)
    if (truth_label(c) != report_label(c) && !names_all(c)) {
      misses += "  " + c.name + ": " + truth_label(c) + " -> " + report_label(c) + "\n";
      out["misses"].push_back({{"case", c.name}, {"truth", truth_label(c)}, {"named", report_label(c)}});
    }
  if (!misses.empty()) result.text += "\nnot as the truth\n" + misses;
  char line[120];
  std::snprintf(line, sizeof line, "\n%s, %.0f s each; median %.0f s, longest %.0f s\n",
                pvg::counted(cases.size(), "case").c_str(), cases.empty() ? 0 : seconds / double(cases.size()),
                each.empty() ? 0 : each[each.size() / 2], each.empty() ? 0 : each.back());
  result.text += line;
  result.json = out.dump(2) + "\n";
  return result;
}

}  // namespace pvg::diagnose
