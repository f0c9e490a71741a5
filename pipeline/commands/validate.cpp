// phyvisgen validate: the validation cases. A Failure if a number that must hold does not.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/stop_signal.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/data_folder.hpp"
#include "pipeline/validation/validation.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct ValidateOptions {
  std::vector<std::string> cases;  // names; empty: all
  std::string scenes, plots;       // folders; empty: data/validation, no plots
  std::string recordings;          // folder of measured data; empty: ../shared/realdata beside the source tree
  std::string device;
  bool is_quick = false, as_json = false;
  bool uses_all_recordings = false;
  bool lists = false;  // print the names of the chosen cases and nothing else
};

// data/validation, of the installation or of the source tree
fs::path scenes_folder(const ValidateOptions& options) {
  return options.scenes.empty() ? data_folder() / "validation" : fs::path(options.scenes);
}

fs::path recordings_folder(const ValidateOptions& options) {
  if (!options.recordings.empty()) return options.recordings;
  return fs::path(PVG_DATA_SOURCE_FOLDER).parent_path().parent_path() / "shared/realdata";
}

std::vector<ValidationCase> chosen_cases(const ValidateOptions& options) {
  std::vector<ValidationCase> chosen;
  std::string names;
  for (const ValidationCase& each : validation_cases()) {
    names += (names.empty() ? "" : ", ") + each.name;
    const bool is_named = std::find(options.cases.begin(), options.cases.end(), each.name) != options.cases.end();
    if (options.cases.empty() ? each.is_quick || !options.is_quick : is_named) chosen.push_back(each);
  }
  for (const std::string& name : options.cases)
    if (std::none_of(chosen.begin(), chosen.end(), [&](const auto& each) { return each.name == name; }))
      throw UsageError("--case " + name + ": there is no such case; there are: " + names);
  return chosen;
}

void print_list(const std::vector<ValidationCase>& cases) {
  for (const ValidationCase& each : cases)
    std::printf("%-18s %s%s\n", each.name.c_str(), each.what.c_str(), each.is_quick ? "" : " (not with --quick)");
}

std::string verdict(const ValidationRow& row) {
  return row.kind == ValidationRow::Kind::report ? "report" : row.passes() ? "pass" : "FAIL";
}

void print_row(const ValidationRow& row) {
  std::printf("%-6s %-14s %-52s %13.7g %13.7g %10.2e %9.2e %-9s %5.1f s  %s\n", verdict(row).c_str(),
              row.case_name.c_str(), row.quantity.c_str(), row.expected, row.measured, row.error(), row.tolerance,
              row.unit.c_str(), row.seconds, row.source.c_str());
  std::fflush(stdout);
}

nlohmann::ordered_json json_of(const ValidationRow& row) {
  return {{"case", row.case_name},
          {"quantity", row.quantity},
          {"unit", row.unit},
          {"expected", row.expected},
          {"measured", row.measured},
          {"error", row.error()},
          {"tolerance", row.tolerance},
          {"pass", row.kind == ValidationRow::Kind::report || row.passes()},
          {"kind", row.kind == ValidationRow::Kind::report ? "report" : "must"},
          {"source", row.source},
          {"seconds", row.seconds}};
}

// A case that cannot be run to its end fails, and says why; the others go on.
std::vector<ValidationRow> run_case(const ValidationCase& each, Validation& validation) {
  validation.rows.clear();
  validation.plots.clear();
  validation.skipped.clear();
  const auto start = std::chrono::steady_clock::now();
  try {
    each.run(validation);
  } catch (const Failure& failure) {
    std::fprintf(stderr, "phyvisgen: case %s: %s\n", each.name.c_str(), failure.what());
    validation.check_true("runs to its end", false, failure.what());
  }
  if (!validation.skipped.empty())
    std::fprintf(stderr, "phyvisgen: case %s is left out: %s\n", each.name.c_str(), validation.skipped.c_str());
  validation.add_step_rows();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (ValidationRow& row : validation.rows) {
    row.case_name = each.name;
    row.seconds = seconds;
  }
  return validation.rows;
}

void run_validate(const ValidateOptions& options) {
  const std::vector<ValidationCase> cases = chosen_cases(options);
  if (options.lists) return print_list(cases);
  const std::atomic<bool>& stop = stop_on_signals();
  if (!options.plots.empty()) make_writable_folder(options.plots);
  Device device(options.device);
  Validation validation(device, scenes_folder(options), options.is_quick, stop);
  validation.recordings = recordings_folder(options);
  validation.uses_all_recordings = options.uses_all_recordings;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::size_t n_must = 0, n_failed = 0;
  if (!options.as_json)
    std::printf("%-6s %-14s %-52s %13s %13s %10s %9s %-9s %7s  %s\n", "", "case", "quantity", "expected", "measured",
                "error", "tolerance", "unit", "", "source of the expected number");
  for (const ValidationCase& each : cases) {
    for (const ValidationRow& row : run_case(each, validation)) {
      list.push_back(json_of(row));
      if (!options.as_json) print_row(row);
      n_must += row.kind == ValidationRow::Kind::must;
      n_failed += row.kind == ValidationRow::Kind::must && !row.passes();
    }
    if (!options.plots.empty())
      for (const Plot& plot : validation.plots)
        write_text_atomically(fs::path(options.plots) / (plot.name + ".svg"), svg_of(plot));
  }
  if (options.as_json)
    std::printf("%s\n",
                nlohmann::ordered_json{{"schema", 1}, {"device", device.info().name}, {"cases", list}}.dump(2).c_str());
  if (n_failed > 0)
    throw Failure(std::to_string(n_failed) + " of " + counted(n_must, "number") + " that must hold " +
                  (n_failed == 1 ? "does" : "do") + " not");
  if (!options.as_json)
    std::printf("%s%s\n", n_must > 1 ? "all " : "",
                counted(n_must, "number that must hold does", "numbers that must hold do").c_str());
}

}  // namespace

void add_validate(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("validate", "Run the validation cases and print measured against expected");
  ValidateOptions& o = options_of_command(*command, run_validate);
  command->add_option("--case", o.cases, "Only this case; may stand several times")->allow_extra_args(false);
  command->add_option("--plots", o.plots, "Folder for the curves (SVG)");
  command->add_option("--scenes", o.scenes, "Folder of the cases' scene files");
  command->add_option("--recordings", o.recordings, "Folder of the measured data; without it those cases are left out");
  command->add_flag("--all-recordings", o.uses_all_recordings, "Every recording of those cases, not a number of them");
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--quick", o.is_quick, "Only what is done within 3 minutes");
  command->add_flag("--list", o.lists, "Print the names of the chosen cases and end");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Exit codes: 0 all that must hold does, 1 something does not, 2 wrong use.\n"
      "Examples:\n  phyvisgen validate --case slope --plots out/plots\n"
      "  phyvisgen validate --case cube_toss --recordings ../shared/realdata --all-recordings");
}

}  // namespace pvg
