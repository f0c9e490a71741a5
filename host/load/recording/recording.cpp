#include "host/load/recording/recording.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>

#include "host/base/error.hpp"
#include "host/load/fields/yaml_section.hpp"
#include "host/load/read_sections.hpp"
#include "host/load/recording/channels.hpp"

namespace pvg {
namespace {

RecordedRun read_run(YamlSection& section) {
  RecordedRun run;
  run.name = section.text("file");
  run.is_held_out = section.choice("role", {"fit", "held_out"}) == 1;
  try {
    run.table = read_table(section.file("file"));
  } catch (const Failure& failure) {
    throw UsageError(failure.what());
  }
  section.done();
  const std::string file = run.table.file.string();
  if (!run.table.has("t")) throw UsageError(file + " has no column `t`, the time in seconds; name its first column so");
  const std::vector<double>& t = run.table["t"];
  if (t.size() < 8) throw UsageError(file + " holds " + std::to_string(t.size()) + " rows; a run needs at least 8");
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) throw UsageError(file + ": the time of row " + std::to_string(i + 1) + " is missing");
    if (i > 0 && !(t[i] > t[i - 1]))
      throw UsageError(file + ": the time of row " + std::to_string(i + 1) + " does not come after the one before");
  }
  return run;
}

RecordedInput read_input(YamlSection& section) {
  RecordedInput input{read_columns(section), section.text("target"), section.text("unit", "")};
  section.done();
  return input;
}

void read_initial(YamlSection& root, Recording& recording) {
  if (!root.has("initial")) return;
  const YAML::Node node = YAML::LoadFile(recording.file.string())["initial"];
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
  recording.file = std::filesystem::is_directory(path) ? path / "recording.yaml" : path;
  YamlSection root = YamlSection::load(recording.file, "recording");
  check_schema(root);
  recording.scene = root.file("scene");
  for (YamlSection& section : root.sections("runs")) recording.runs.push_back(read_run(section));
  for (YamlSection& section : root.sections("inputs")) recording.inputs.push_back(read_input(section));
  for (YamlSection& section : root.sections("channels")) read_channel(section, recording);
  read_initial(root, recording);
  root.done();
  if (recording.runs.empty()) root.fail("runs", "holds no run: there is nothing to compare with");
  if (recording.channels.empty()) root.fail("channels", "holds no channel: nothing was measured");
  demand_different_runs(recording);
  for (RecordedRun& run : recording.runs) add_pictures(recording, run);
  for (const RecordedRun& run : recording.runs) {
    const auto check = [&](const std::vector<std::string>& columns, const std::string& key) {
      for (const std::string& column : columns)
        if (!run.table.has(column))
          root.fail(key, "names the column `" + column + "`, which " + run.table.file.string() + " does not have");
    };
    for (const RecordedInput& input : recording.inputs) check(input.columns, "inputs");
    for (const RecordedChannel& channel : recording.channels) check(channel.columns, "channels");
  }
  return recording;
}

}  // namespace pvg
