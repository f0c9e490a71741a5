#include "host/load/recording/recording.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/load/fields/yaml_section.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/recording/channels.hpp"
#include "host/load/recording/commanded_effort.hpp"

namespace pvg {
namespace {

// The numbers under `key`: a value, or {value: .., sigma: ..}; a value is a number with its unit, or a list of them.
StatedNumbers read_stated(YamlSection& section, const YAML::Node& parent, const std::string& key) {
  StatedNumbers stated;
  if (!section.has(key)) return stated;
  YamlSection entries = section.section(key);
  for (const auto& entry : parent[key]) {
    const std::string name = entry.first.Scalar();
    const bool has_parts = entry.second.IsMap();
    StatedNumber number;
    std::optional<YamlSection> parts;
    if (has_parts) parts = entries.section(name);
    YamlSection& where = parts ? *parts : entries;
    const std::string value = parts ? "value" : name;
    const YAML::Node node = has_parts ? entry.second["value"] : entry.second;
    if (node && node.IsSequence())
      number.value = where.texts(value);
    else if (node || !has_parts)
      number.value = {where.text(value)};
    if (parts) {
      number.sigma = parts->text("sigma", "");
      parts->done();
      if (number.value.empty() && number.sigma.empty()) parts->fail("", "must hold a `value`, a `sigma`, or both");
    }
    stated[name] = std::move(number);
  }
  entries.done();
  return stated;
}

// Leaves of a run what was recorded from one time to another; pictures without times belong to the rows that are left.
void crop(MeasuredTable& table, double from, double to) {
  const std::vector<double> t = table["t"];
  for (auto& [name, values] : table.columns) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < t.size(); ++i)
      if (t[i] >= from && t[i] <= to) kept.push_back(values[i]);
    values = std::move(kept);
  }
  table.n_rows = table["t"].size();
}

RecordedDisturbance read_disturbance(YamlSection& section) {
  constexpr double LARGEST = 1e5;  // [N], [N m]: as of the effect `push`
  RecordedDisturbance known;
  known.body = section.text("body");
  known.point = section.vector("point", Unit::length, -REACH, REACH, Vec3::Zero());
  if (section.has("columns") || section.has("column")) {
    known.is_torque = section.choice("kind", {"force", "torque"}) == 1;
    known.columns = read_columns(section);
    known.unit = section.text("unit", "");
    if (known.columns.size() != 3) section.fail("columns", "must name 3 columns, x y z of the world");
  } else {
    if (section.has("force") == section.has("torque"))
      section.fail("",
                   "must have either a `force` or a `torque`, such as [2 N, 0, 0], with `from` and `to`, or "
                   "`columns` of the run's table");
    known.is_torque = section.has("torque");
    known.value = known.is_torque ? section.vector("torque", Unit::torque, -LARGEST, LARGEST)
                                  : section.vector("force", Unit::force, -LARGEST, LARGEST);
    known.from = section.number("from", Unit::time, -1e9, 1e9);
    known.to = section.number("to", Unit::time, -1e9, 1e9);
    if (!(known.from < known.to)) section.fail("to", "must come after `from`");
  }
  if (known.is_torque && section.has("point")) section.fail("point", "is of a force; a torque has none, leave it out");
  section.done();
  return known;
}

RecordedRun read_run(YamlSection& section, const YAML::Node& node) {
  RecordedRun run;
  run.name = section.text("file");
  run.is_held_out = section.choice("role", {"fit", "held_out"}) == 1;
  run.table = read_table(section.file("file"));
  const std::string time = section.text("time", "t");
  const bool has_part = section.has("from") || section.has("to");
  const double from = section.number("from", Unit::time, -1e9, 1e9, -1e9);
  const double to = section.number("to", Unit::time, -1e9, 1e9, 1e9);
  run.set = read_stated(section, node, "set");
  run.initial = read_stated(section, node, "initial");
  for (YamlSection& disturbance : section.sections("disturbances"))
    run.disturbances.push_back(read_disturbance(disturbance));
  section.done();
  const std::string file = run.table.file.string();
  if (!run.table.has(time))
    throw UsageError(file + " has no column `" + time +
                     "`, the time in seconds; name its first column `t`, or let the run say `time: NAME`");
  if (time != "t") run.table.columns["t"] = run.table[time];
  if (has_part) crop(run.table, from, to);
  const std::vector<double>& t = run.table["t"];
  if (t.size() < 8 && has_part)
    section.fail("from", "and `to` leave " + counted(t.size(), "row") + " of " + file + "; a run needs at least 8");
  if (t.size() < 8) throw UsageError(file + " holds " + counted(t.size(), "row") + "; a run needs at least 8");
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) throw UsageError(file + ": the time of row " + std::to_string(i + 1) + " is missing");
    if (i > 0 && !(t[i] > t[i - 1]))
      throw UsageError(file + ": the time of row " + std::to_string(i + 1) + " does not come after the one before");
  }
  return run;
}

RecordedInput read_input(YamlSection& section, std::vector<RecordedRun>& runs) {
  RecordedInput input{read_columns(section), section.text("target"), section.text("unit", "")};
  make_effort(section, input, runs);
  section.done();
  return input;
}

// For a message: the names of a table's first columns.
std::string names_of(const MeasuredTable& table) {
  constexpr std::size_t MOST = 20;
  std::string names;
  std::size_t n = 0;
  for (const auto& [name, values] : table.columns)
    if (++n <= MOST) names += (names.empty() ? "" : ", ") + name;
  return names + (n > MOST ? ", .." : "");
}

void read_initial(YamlSection& root, const YAML::Node& whole, Recording& recording) {
  if (!root.has("initial")) return;
  const YAML::Node node = whole["initial"];
  if (!node.IsMap()) {
    recording.initial = Recording::Initial(root.choice("initial", {"first_sample", "fitted"}));
    return;
  }
  recording.initial = Recording::Initial::given;
  YamlSection section = root.section("initial");
  for (const auto& entry : node) {
    const std::string key = entry.first.Scalar();
    recording.given[key] = section.number(key, Unit::none, -1e6, 1e6);
  }
  section.done();
}

bool is_same(const MeasuredTable& a, const MeasuredTable& b) {
  const auto same_number = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return std::equal(
      a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(), [&](const auto& x, const auto& y) {
        return x.first == y.first &&
               std::equal(x.second.begin(), x.second.end(), y.second.begin(), y.second.end(), same_number);
      });
}

// A held-out run that the fit has seen proves nothing, and a run that is listed twice would count twice.
void demand_different_runs(const Recording& recording) {
  const std::vector<RecordedRun>& runs = recording.runs;
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (is_same(runs[i].table, runs[k].table))
        throw UsageError(recording.file.string() + ": the runs " + runs[k].name + " and " + runs[i].name +
                         " hold the same numbers" +
                         (runs[i].is_held_out != runs[k].is_held_out
                              ? ", so the held-out one proves nothing; record another motion for it"
                              : "; leave one of them away"));
}

}  // namespace

Recording load_recording(const std::filesystem::path& path) {
  Recording recording;
  demand_table(path);
  recording.file = std::filesystem::is_directory(path) ? path / "recording.yaml" : path;
  YamlSection root = YamlSection::load(recording.file, "recording");
  check_schema(root);
  recording.scene = root.file("scene");
  const YAML::Node whole = YAML::LoadFile(recording.file.string());
  for (YamlSection& section : root.sections("runs"))
    recording.runs.push_back(read_run(section, whole["runs"][recording.runs.size()]));
  for (YamlSection& section : root.sections("inputs")) recording.inputs.push_back(read_input(section, recording.runs));
  for (YamlSection& section : root.sections("channels")) read_channel(section, recording);
  read_initial(root, whole, recording);
  recording.priors = read_stated(root, whole, "priors");
  root.done();
  if (recording.runs.empty()) root.fail("runs", "holds no run: there is nothing to compare with");
  if (recording.channels.empty()) root.fail("channels", "holds no channel: nothing was measured");
  for (RecordedRun& run : recording.runs) {
    add_pictures(recording, run);
    add_channels_with_clocks(recording, run);
  }
  demand_different_runs(recording);
  for (const RecordedRun& run : recording.runs) {
    const auto check = [&](const std::vector<std::string>& columns, const std::string& key) {
      for (const std::string& column : columns)
        if (!run.table.has(column))
          root.fail(key, "names the column `" + column + "`, which " + run.table.file.string() +
                             " does not have; there are: " + names_of(run.table));
    };
    for (const RecordedDisturbance& known : run.disturbances) check(known.columns, "runs");
    for (const RecordedInput& input : recording.inputs) check(input.columns, "inputs");
    for (const RecordedChannel& channel : recording.channels) check(channel.columns, "channels");
  }
  return recording;
}

}  // namespace pvg
