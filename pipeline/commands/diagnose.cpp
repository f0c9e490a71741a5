// phyvisgen diagnose: where a recording and its scene disagree, and what is missing.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "host/base/stop_signal.hpp"
#include "host/formats/parquet_tables.hpp"
#include "host/identify/criteria.hpp"
#include "host/identify/report/report.hpp"
#include "host/identify/search/plan_next.hpp"
#include "host/load/recording/robot_set.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/parquet_python.hpp"
#include "pipeline/validation/hidden_suite.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct DiagnoseOptions {
  std::string recording, folder;  // folder of recording.yaml or a set of episodes, folder of the report
  std::string task;               // whose robots made that set
  std::string device;
  int max_effects = 2;                // named together
  double minutes = 5;                 // after which the report is written, whatever is left out
  bool is_quick = false;              // in one minute
  bool halves_step = false;           // half the time step that would be used
  bool plans_next = false;            // the next experiment, whether names are confused or not
  std::string decide = "workflow";    // or, to compare: retune, lowest, weak
  bool only_checks = false;           // say what is wrong with the recording and end
  bool lists_effects = false;         // print the names of all candidates and end
  bool lists_criteria = false;        // print the constants that decide and end
  std::vector<std::string> criteria;  // NAME=VALUE of such constants
  bool keeps_simulations = false;     // the journal is not removed at the end
  bool does_not_simulate = false;     // end with an error where the journal does not hold a result
  std::string suite;                  // folder of cases instead of a recording
  int n_jobs = 0;                     // cases at once, or processes of one; 0: one case, as many processes as cores
  bool as_json = false;
};

// `--minutes` counts from here: on a busy machine what comes before the first stage takes seconds by the clock
const diagnose::Clock::time_point PROGRAM_BEGAN = diagnose::Clock::now();

constexpr unsigned MOST_PROCESSES = 16;
constexpr double QUICK_MINUTES = 1;

void list_effects(bool as_json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const diagnose::CandidateKind& kind : diagnose::candidate_kinds()) {
    if (!as_json) {
      std::printf("%-28s %-12s %s\n", kind.name.c_str(), diagnose::family_name(kind.family), kind.meaning.c_str());
      continue;
    }
    nlohmann::ordered_json one = {{"name", kind.name},
                                  {"family", diagnose::family_name(kind.family)},
                                  {"site", kind.site},
                                  {"law", kind.law},
                                  {"meaning", kind.meaning}};
    one["parameters"] = nlohmann::ordered_json::array();
    for (const diagnose::Parameter& p : kind.parameters)
      one["parameters"].push_back(
          {{"name", p.name}, {"unit", p.unit}, {"low", p.low}, {"high", p.high}, {"off", p.off}});
    list.push_back(std::move(one));
  }
  if (as_json) std::printf("%s\n", nlohmann::ordered_json{{"schema", 1}, {"effects", list}}.dump(2).c_str());
}

void list_criteria(bool as_json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const diagnose::Criterion& one : diagnose::list_criteria()) {
    if (!as_json) {
      std::printf("%-28s %8g %-14s %s\n", one.name.c_str(), one.usual, one.unit.c_str(), one.meaning.c_str());
      continue;
    }
    list.push_back({{"name", one.name},
                    {"stage", one.stage},
                    {"value", one.usual},
                    {"unit", one.unit},
                    {"is_count", one.is_count},
                    {"meaning", one.meaning},
                    {"evidence", one.evidence}});
    if (!one.series.empty()) list.back()["series"] = one.series;
  }
  if (as_json) std::printf("%s\n", nlohmann::ordered_json{{"schema", 1}, {"criteria", list}}.dump(2).c_str());
}

diagnose::Decide decide_named(const std::string& name) {
  using diagnose::Decide;
  return name == "retune"   ? Decide::retune
         : name == "lowest" ? Decide::lowest
         : name == "weak"   ? Decide::weak
                            : Decide::workflow;
}

// PoCL's usual device wakes its threads for every kernel, which takes longer than what small worlds compute. Its device
// `basic` works in the thread that asks. Who has set POCL_DEVICES is obeyed; other drivers do not know the variable.
void prefer_short_waits() { setenv("POCL_DEVICES", "basic", 0); }

std::size_t n_processes(const DiagnoseOptions& options, const DeviceInfo& device) {
  const bool works_in_this_thread = device.name.starts_with("basic");
  if (options.n_jobs > 1 && !works_in_this_thread)
    throw UsageError("--jobs " + std::to_string(options.n_jobs) + " needs PoCL's device `basic`, not " + device.name +
                     "; leave out --device and POCL_DEVICES, or --jobs");
  if (options.n_jobs > 0 || !works_in_this_thread) return std::size_t(std::max(options.n_jobs, 1));
  return std::clamp(std::thread::hardware_concurrency(), 1u, MOST_PROCESSES);
}

void print_sizes(const diagnose::Problem& problem) {
  std::printf("%s: %s, %s, scene %s\n", problem.recording.file.string().c_str(),
              counted(problem.runs.size(), "run").c_str(), counted(problem.channels.size(), "channel").c_str(),
              problem.recording.scene.filename().string().c_str());
  for (const diagnose::Run& run : problem.runs)
    std::printf("  %s, %s: %zu samples over %.4g s\n", run.name.c_str(), run.is_held_out ? "held out" : "fit",
                run.t.size(), run.t.back() - run.t.front());
  for (const std::string& sentence : diagnose::warnings(problem)) std::printf("  note: %s\n", sentence.c_str());
}

double minutes_of(const DiagnoseOptions& options) { return options.is_quick ? QUICK_MINUTES : options.minutes; }

HiddenSuite hidden_suite(const DiagnoseOptions& options) {
  HiddenSuite suite;
  suite.cases = options.suite;
  suite.reports = options.folder.empty() ? suite.cases / "reports" : fs::path(options.folder);
  suite.options = {"--max-effects", std::to_string(options.max_effects), "--decide", options.decide,
                   "--minutes",     std::to_string(minutes_of(options))};
  if (options.n_jobs > 1) suite.options.insert(suite.options.end(), {"--jobs", "1"});
  for (const std::string& text : options.criteria) suite.options.insert(suite.options.end(), {"--set-criterion", text});
  if (options.keeps_simulations) suite.options.push_back("--keep-simulations");
  if (!options.device.empty()) suite.options.insert(suite.options.end(), {"--device", options.device});
  suite.n_jobs = options.n_jobs;
  suite.as_json = options.as_json;
  return suite;
}

// A folder with recording.yaml, or what a task's robots did.
diagnose::Problem problem_of(const DiagnoseOptions& options) {
  if (options.task.empty()) {
    if (is_robot_set(options.recording))
      throw UsageError(
          options.recording +
          " holds no recording.yaml; if it is a set of episodes, name the task of its robots: --task TASK");
    return diagnose::make_problem(options.recording);
  }
  const auto parquet = [](const std::vector<fs::path>& files, const std::vector<std::string>& columns) {
    return read_parquet(python_with_pyarrow(), parquet_script("read_parquet.py"), files, columns);
  };
  if (!options.folder.empty()) check_not_within(options.folder, options.recording, "diagnose");
  return diagnose::make_problem(load_robot_set(options.recording, options.task, parquet));
}

void run_diagnose(const DiagnoseOptions& options) {
  if (options.lists_effects) return list_effects(options.as_json);
  if (options.lists_criteria) return list_criteria(options.as_json);
  for (const std::string& text : options.criteria) diagnose::set_criterion(text);
  stop_on_signals();
  if (!options.suite.empty()) return run_hidden_suite(hidden_suite(options));
  if (options.recording.empty())
    throw UsageError(
        "diagnose needs a recording: a folder with recording.yaml; `phyvisgen diagnose --help` shows an example");
  diagnose::Problem problem = problem_of(options);
  if (options.only_checks) return print_sizes(problem);
  if (options.folder.empty()) throw UsageError("diagnose needs a folder for its report: -o DIR");
  for (const std::string& sentence : diagnose::warnings(problem))
    std::fprintf(stderr, "phyvisgen: note: %s\n", sentence.c_str());
  if (std::all_of(problem.runs.begin(), problem.runs.end(), [](const diagnose::Run& run) { return run.is_held_out; }))
    throw UsageError(problem.recording.file.string() + ": every run is held out; give at least one the role `fit`");
  make_writable_folder(options.folder);
  for (const char* name : {"report.html", "report.json", "scene_amended.yaml"})
    check_output_file(fs::path(options.folder) / name);
  prefer_short_waits();
  Device device(options.device);
  diagnose::Settings settings;
  settings.max_effects = options.max_effects;
  settings.minutes = minutes_of(options);
  settings.began = PROGRAM_BEGAN;
  settings.plans_next = options.plans_next;
  settings.halves_step = options.halves_step;
  settings.keeps_simulations = options.keeps_simulations;
  settings.simulates = !options.does_not_simulate;
  settings.decide = decide_named(options.decide);
  settings.n_processes = n_processes(options, device.info());
  diagnose::Diagnosis found = diagnose::diagnose(device, problem, settings, options.folder);
  diagnose::write_report(problem, found, options.folder);
  std::printf("%s\n", found.sentence.c_str());
  std::fprintf(stderr, "%s\n", (fs::path(options.folder) / "report.html").string().c_str());
  if (!diagnose::wants_next(settings, found)) return;
  diagnose::plan_next(device, problem, settings, found);
  diagnose::write_report(problem, found, options.folder);
  if (!found.next_experiment.empty()) std::fprintf(stderr, "next experiment: %s\n", found.next_experiment.c_str());
}

}  // namespace

void add_diagnose(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "diagnose", "Find where a recording and its scene disagree, and name the effect that is missing");
  DiagnoseOptions& o = options_of_command(*command, run_diagnose);
  command->add_option("RECORDING", o.recording,
                      "Folder with recording.yaml, or that file; with --task a set or states.h5");
  command->add_option("--task", o.task, "RECORDING is a set of episodes, ours or LeRobot's, of this task's robots")
      ->type_name("TASK");
  command->add_option("-o,--output", o.folder, "Folder for report.html, report.json and scene_amended.yaml");
  command->add_option("--max-effects", o.max_effects, "Effects that may be named together")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  command
      ->add_option("--minutes", o.minutes,
                   "After so many the report is written: it says what was left out for want of time")
      ->check(CLI::Range(0.1, 1e4))
      ->capture_default_str();
  command->add_flag("--next", o.plans_next,
                    "Compute the motion that best separates the two best names, and write next_experiment.yaml, also "
                    "where they are not confused; after the report, in a tenth of --minutes at most");
  command->add_flag("--half-step", o.halves_step,
                    "Simulate with half the time step that would be used: no verdict should depend on it");
  command->add_flag("--quick", o.is_quick, "In one minute: --minutes 1")->excludes("--minutes");
  command
      ->add_option(
          "--decide", o.decide,
          "How to choose; all but `workflow` are for comparison: the best existing number, the lowest training "
          "error, sparse regression")
      ->check(CLI::IsMember({"workflow", "retune", "lowest", "weak"}))
      ->capture_default_str();
  command->add_flag("--check", o.only_checks, "Say what is wrong with the recording and end");
  command->add_flag("--list-effects", o.lists_effects, "Print all that can be named and end");
  command->add_flag("--list-criteria", o.lists_criteria, "Print the constants that decide a diagnosis and end");
  command->add_option("--set-criterion", o.criteria, "NAME=VALUE: another value of such a constant, for studies");
  command->add_flag("--keep-simulations", o.keeps_simulations,
                    "Leave the simulated results in simulated.bin, so that the next diagnosis in this folder reads "
                    "those that it needs, too");
  command->add_flag("--no-simulation", o.does_not_simulate,
                    "Read simulated.bin only: an error where it does not hold a result that is needed");
  command->add_option("--suite", o.suite, "Folder of hidden-effect cases: diagnose all, print the table of scores");
  command
      ->add_option(
          "--jobs", o.n_jobs,
          "Processes that simulate at once, by default one per core (of a suite: cases at once, by default one)")
      ->check(CLI::Range(1, 64));
  command->add_option("--device", o.device, "OpenCL device: an index, part of its name, cpu or gpu");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Examples:\n  phyvisgen diagnose recordings/pendulum -o out/pendulum\n"
      "  phyvisgen diagnose recordings/pendulum -o out/pendulum --jobs 1\n"
      "  phyvisgen diagnose recordings/pendulum --check\n  phyvisgen diagnose --list-effects --json\n"
      "  phyvisgen diagnose --suite data/hidden -o out/hidden --jobs 2");
}

}  // namespace pvg
