// phyvisgen evaluate: the success rate of a set with its interval, the reasons of failures, and the recorded steps in
// which surfaces intersect. A Failure where one does.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/progress.hpp"
#include "host/base/statistics.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/episode_set.hpp"
#include "pipeline/episode/intersections.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::string folder;     // of a set that generate made
  std::size_t every = 1;  // look for intersections in each so many steps
  bool as_json = false;
};

void run_evaluate(const EvaluateOptions& options) {
  if (options.folder.empty()) throw UsageError("evaluate needs the folder of a set; --help shows an example");
  if (!fs::is_directory(options.folder))
    throw UsageError(options.folder + " is no folder; name one that generate made");
  const SetStatus status = read_status(options.folder);
  const std::size_t n = status.done.size() + status.failed.size();
  if (n == 0) throw UsageError(options.folder + " holds no episodes; make some with `phyvisgen generate`");
  std::vector<fs::path> records;
  for (const std::uint64_t episode : status.done)
    records.push_back(episode_folder(options.folder, episode) / "states.h5");
  for (const FailedEpisode& failed : status.failed)
    records.push_back(failed_folder(options.folder, failed.episode) / "states.h5");
  std::size_t steps = 0, intersected = 0, without_record = 0;
  std::string first;
  Progress progress("intersections", "episodes", records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (fs::exists(records[i])) {
      const IntersectedSteps counted = count_intersected_steps(records[i], options.every);
      if (first.empty() && !counted.first.empty()) first = records[i].string() + ", " + counted.first;
      steps += counted.steps;
      intersected += counted.intersected;
    } else {
      ++without_record;
    }
    progress.advance_to(i + 1);
  }
  const RateInterval interval = wilson_interval(status.done.size(), n);
  const double rate = double(status.done.size()) / double(n);
  if (options.as_json) {
    Json json = {{"schema", 1},
                 {"folder", options.folder},
                 {"episodes", n},
                 {"succeeded", status.done.size()},
                 {"rate", rate},
                 {"rate_low", interval.low},
                 {"rate_high", interval.high},
                 {"steps", steps},
                 {"intersected_steps", intersected},
                 {"episodes_without_record", without_record}};
    Json& reasons = json["failed"] = Json::array();
    for (const FailedEpisode& failed : status.failed)
      reasons.push_back({{"episode", failed.episode}, {"reason", failed.reason}});
    std::printf("%s\n", json.dump(2).c_str());
  } else {
    std::printf("%s: %zu of %s succeeded, %.1f %% (95 %% interval by Wilson: %.1f to %.1f %%)\n",
                options.folder.c_str(), status.done.size(), counted(n, "episode").c_str(), 100 * rate,
                100 * interval.low, 100 * interval.high);
    std::printf("%zu of %s intersected, %s without a record\n", intersected, counted(steps, "recorded step").c_str(),
                counted(without_record, "episode").c_str());
    for (const FailedEpisode& failed : status.failed)
      std::printf("  episode %llu: %s\n", static_cast<unsigned long long>(failed.episode), failed.reason.c_str());
  }
  if (intersected > 0)
    throw Failure(counted(intersected, "recorded step intersects", "recorded steps intersect") +
                  ", the first: " + first);
}

}  // namespace

void add_evaluate(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("evaluate", "Success rate of a set of episodes, and whether anything intersects in them");
  const auto options = std::make_shared<EvaluateOptions>();
  command->callback([command, options] {  // not where one of its own commands was asked for
    if (command->get_subcommands().empty()) run_evaluate(*options);
  });
  EvaluateOptions& o = *options;
  command->add_option("SET", o.folder,
                      "Folder that generate made; with --keep-failed the failed ones are looked at, too");
  command->add_option("--every", o.every, "Look for intersections in every so many recorded steps")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer(
      "Exit codes: 0 nothing intersects, 1 something does, 2 wrong use.\n"
      "Example:\n  phyvisgen generate data/tasks/place_dish.yaml -n 20 --no-render --keep-failed -o out/dish\n"
      "  phyvisgen evaluate out/dish");
}

}  // namespace pvg
