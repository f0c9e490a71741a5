// phyvisgen status: what of a set is done, failed and why, missing; reads files only.
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "host/base/counted.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace pvg {
namespace {

struct StatusOptions {
  std::string folder;  // of a set
  bool as_json = false;
};

// "beaker ends 12.3 mm from its target" and "... 14.1 mm ..." are the same reason: numbers do not tell them apart
std::string without_numbers(const std::string& reason) {
  std::string text;
  bool is_in_number = false;
  for (const char c : reason) {
    const bool is_digit = c >= '0' && c <= '9', goes_on = is_in_number && c == '.';
    if (is_digit && !is_in_number) text += '#';
    if (!is_digit && !goes_on) text += c;
    is_in_number = is_digit || goes_on;
  }
  return text;
}

void run_status(const StatusOptions& options) {
  if (options.folder.empty()) throw UsageError("status needs the folder of a set; `phyvisgen status --help`");
  const EpisodeSet set = read_set(options.folder);
  if (options.as_json) {
    std::printf("%s", status_json(set).c_str());
    return;
  }
  const SetStatus status = read_status(set.folder);
  const std::size_t n_missing = missing(set, status).size();
  std::printf("%s: task %s, seed %llu, %s asked for\n", set.folder.c_str(), set.task.c_str(),
              static_cast<unsigned long long>(set.seed), counted(set.n_asked, "episode").c_str());
  std::printf("  done     %6zu\n  failed   %6zu\n  missing  %6zu\n", status.done.size(), status.failed.size(),
              n_missing);
  const RateInterval interval = success_interval(status);
  if (!status.done.empty() || !status.failed.empty())
    std::printf("  success rate %.1f %% (95 %% interval by Wilson: %.1f to %.1f %%)\n", 100 * success_rate(status),
                100 * interval.low, 100 * interval.high);
  std::map<std::string, std::size_t> reasons;
  for (const FailedEpisode& failed : status.failed) ++reasons[without_numbers(failed.reason)];
  std::vector<std::pair<std::string, std::size_t>> by_number(reasons.begin(), reasons.end());
  std::stable_sort(by_number.begin(), by_number.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [reason, n] : by_number) std::printf("  %6zu x %s\n", n, reason.c_str());
}

}  // namespace

void add_status(CLI::App& program) {
  CLI::App* command = program.add_subcommand("status", "What of an episode set is done, failed and missing");
  StatusOptions& o = options_of_command(*command, run_status);
  command->add_option("DIR", o.folder, "Folder of the set");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen status out/beaker");
}

}  // namespace pvg
