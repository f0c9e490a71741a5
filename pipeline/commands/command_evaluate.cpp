// phyvisgen evaluate: how often a set's episodes succeeded, and whether anything intersects in what they recorded.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/error.hpp"
#include "host/base/progress.hpp"
#include "pipeline/commands/commands.hpp"
#include "pipeline/episode/episode_set.hpp"
#include "pipeline/episode/intersections.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double NORMAL_QUANTILE = 1.959963984540054;  // of 97.5 %: an interval of 95 %

}  // namespace

// Wilson 1927, "Probable inference, the law of succession, and statistical inference"
RateInterval wilson_interval(std::size_t successes, std::size_t n) {
  if (n == 0) return {0, 1};
  const double z = NORMAL_QUANTILE, total = double(n), rate = double(successes) / total;
  const double center = (rate + z * z / (2 * total)) / (1 + z * z / total);
  const double half = z / (1 + z * z / total) * std::sqrt(rate * (1 - rate) / total + z * z / (4 * total * total));
  return {std::max(0.0, center - half), std::min(1.0, center + half)};
}

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
    std::printf("%s: %zu of %zu episodes succeeded, %.1f %% (95 %% interval by Wilson: %.1f to %.1f %%)\n",
                options.folder.c_str(), status.done.size(), n, 100 * rate, 100 * interval.low, 100 * interval.high);
    std::printf("%zu of %zu recorded steps intersected, %zu episodes without a record\n", intersected, steps,
                without_record);
    for (const FailedEpisode& failed : status.failed)
      std::printf("  episode %llu: %s\n", static_cast<unsigned long long>(failed.episode), failed.reason.c_str());
  }
  if (intersected > 0) throw Failure(std::to_string(intersected) + " recorded steps intersect, the first: " + first);
}

}  // namespace pvg
