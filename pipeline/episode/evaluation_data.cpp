#include "pipeline/episode/evaluation_data.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/files.hpp"
#include "host/base/outputs.hpp"
#include "host/dataset/json_file.hpp"
#include "pipeline/episode/report_data.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr const char* WHICH_FILE =
    "view takes a file that `evaluate policy --json` printed, or the folder of a set or of an episode";

// Reads what the page needs from one mapping of the file; `at` is where that stands in it.
class Checked {
 public:
  Checked(const fs::path& file, std::string at, const Json& json) : file_(file), at_(std::move(at)), json_(json) {
    if (!json.is_object()) refuse("`" + at_ + "` is no mapping");
  }
  const Json& list(const std::string& key) const {
    return demand(key, "a list", [](const Json& j) { return j.is_array(); });
  }
  const Json& mapping(const std::string& key) const {
    return demand(key, "a mapping", [](const Json& j) { return j.is_object(); });
  }
  void numbers(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) demand(key, "a number", [](const Json& j) { return j.is_number(); });
  }
  void text(const std::string& key) const {
    demand(key, "a text", [](const Json& j) { return j.is_string(); });
  }
  void truth(const std::string& key) const {
    demand(key, "true or false", [](const Json& j) { return j.is_boolean(); });
  }
  Checked within(const std::string& key) const { return {file_, path(key), mapping(key)}; }
  std::vector<Checked> rows(const std::string& key) const {
    std::vector<Checked> all;
    for (const Json& row : list(key)) all.push_back({file_, path(key) + "[" + std::to_string(all.size()) + "]", row});
    return all;
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw UsageError(file_.string() + ": " + why + "; " + WHICH_FILE);
  }

 private:
  std::string path(const std::string& key) const { return at_.empty() ? key : at_ + "." + key; }
  template <class Is>
  const Json& demand(const std::string& key, const std::string& kind, const Is& is) const {
    if (!json_.contains(key)) refuse("the key `" + path(key) + "` is missing");
    if (!is(json_[key])) refuse("`" + path(key) + "` is not " + kind);
    return json_[key];
  }

  const fs::path& file_;
  std::string at_;
  const Json& json_;
};

// Rate, intervals, events and episodes of one policy.
void check_result(const Checked& result, std::size_t n_episodes) {
  result.numbers({"episodes", "success", "low", "high"});
  const Json& beta = result.list("beta");
  if (beta.size() != 2 || !beta[0].is_number() || !beta[1].is_number()) result.refuse("a `beta` is not two numbers");
  for (const auto& [name, count] : result.mapping("events").items())
    if (!count.is_number()) result.refuse("the number of the event `" + name + "` is no number");
  if (result.list("episodes_detail").size() != n_episodes)
    result.refuse("two policies have different numbers of episodes");
  for (const Checked& episode : result.rows("episodes_detail")) {
    episode.numbers({"seed", "periods"});
    episode.truth("success");
    episode.text("reason");
    for (const Json& event : episode.list("events"))
      if (!event.is_string()) episode.refuse("an event is no text");
  }
}

void check(const Checked& evaluation) {
  evaluation.text("policy");
  const std::size_t n = evaluation.list("episodes_detail").size();
  check_result(evaluation, n);
  const Checked baselines = evaluation.within("baselines");
  for (const auto& [name, unused] : evaluation.mapping("baselines").items()) {
    const Checked baseline = baselines.within(name);
    check_result(baseline, n);
    baseline.within("policy_above").numbers({"difference", "low", "high", "gained", "lost", "p"});
  }
  for (const Checked& curve : evaluation.rows("perturbed")) {
    curve.text("quantity");
    if (curve.list("points").size() < 2) curve.refuse("a curve has fewer than two points");
    for (const Checked& point : curve.rows("points")) point.numbers({"amount", "success", "low", "high"});
    curve.within("control").numbers({"spread", "shuffled_spread_95", "p"});
  }
}

// As the evaluation named it, or beside the file, where the folder was moved.
std::string video_source(const fs::path& named, const fs::path& file) {
  for (const fs::path& place : {named, file.parent_path() / named.filename(), file.parent_path() / named})
    if (is_file(place)) {
      const std::optional<std::string> bytes = read_whole_file(place);
      if (!bytes) throw UsageError(place.string() + " could not be read");
      return "data:video/mp4;base64," +
             base64(std::span(reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()));
    }
  throw UsageError(
      file.string() + " names the video " + named.string() +
      ", which is not there; start the command where the evaluation was started, or put it beside the file");
}

}  // namespace

Json evaluation_report(const fs::path& file) {
  const std::optional<Json> evaluation = read_json_file(file, WHICH_FILE);
  if (!evaluation) throw UsageError(file.string() + " could not be read");
  const Checked checked(file, "", *evaluation);
  check(checked);
  Json videos = Json::array();
  for (const Json& video : checked.list("videos")) {
    if (!video.is_string()) checked.refuse("a video's name is no text");
    const fs::path named = video.get<std::string>();
    videos.push_back({{"name", named.stem().string()}, {"source", video_source(named, file)}});
  }
  return {{"file", file.filename().string()}, {"evaluation", *evaluation}, {"videos", videos}};
}

}  // namespace pvg
