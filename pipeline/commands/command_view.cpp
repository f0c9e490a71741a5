#include <cstdio>
#include <fstream>
#include <iterator>

#include "host/base/atomic_files.hpp"
#include "host/base/progress.hpp"
#include "pipeline/commands/commands.hpp"
#include "pipeline/commands/data_folder.hpp"
#include "pipeline/episode/episode_set.hpp"
#include "pipeline/episode/report_data.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* THREE = "/usr/share/javascript/three";  // of the Debian package libjs-three

std::string text_of(const fs::path& path, const std::string& remedy) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UsageError(path.string() + " could not be read: " + remedy);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Inside <script> only "</" could end it.
std::string safe_in_script(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) text.insert(at + 1, "\\");
  return text;
}

void replace(std::string& page, const std::string& place, const std::string& text) {
  const std::size_t at = page.find(place);
  if (at == std::string::npos) throw Failure("data/view/report.html lacks " + place);
  page.replace(at, place.size(), text);
}

Json set_report(const fs::path& folder, std::uint64_t n_whole) {
  const EpisodeSet set = read_set(folder);
  const SetStatus status = read_status(folder);
  Json episodes = Json::array();
  Progress progress("view", "episodes", status.done.size());
  for (std::size_t i = 0; i < status.done.size(); ++i) {
    episodes.push_back(episode_report(episode_folder(folder, status.done[i]), i < n_whole));
    progress.advance_to(i + 1);
  }
  for (const FailedEpisode& failed : status.failed)
    episodes.push_back(episode_report(failed_folder(folder, failed.episode), false));
  return {{"status", Json::parse(status_json(set))}, {"episodes", episodes}};
}

}  // namespace

void run_view(const ViewOptions& options) {
  if (options.folder.empty()) throw UsageError("view needs the folder of a set or an episode; `phyvisgen view --help`");
  if (options.output.empty()) throw UsageError("view needs a page to write: -o FILE.html");
  const fs::path folder = fs::path(options.folder).lexically_normal();
  const fs::path named = folder.has_filename() ? folder : folder.parent_path();
  Json report;
  if (fs::exists(named / "set.json"))
    report = set_report(named, options.n_episodes);
  else if (fs::exists(named / "summary.json"))
    report = {{"episodes", Json::array({episode_report(named, true)})}};
  else
    throw UsageError(named.string() + " holds neither set.json nor summary.json; name a set or an episode of generate");
  const std::string ours = "is the installation complete?", package = "install the Debian package libjs-three";
  std::string page = text_of(data_folder() / "view/report.html", ours);
  replace(page, "/*DATA*/", safe_in_script(report.dump()));
  replace(page, "/*SCRIPT*/", text_of(data_folder() / "view/report.js", ours));
  replace(page, "/*CONTROLS*/", text_of(fs::path(THREE) / "examples/js/controls/OrbitControls.js", package));
  replace(page, "/*THREE*/", safe_in_script(text_of(fs::path(THREE) / "three.min.js", package)));
  const fs::path output = fs::absolute(options.output);
  make_writable_folder(output.parent_path());
  write_text_atomically(output, page);
  std::printf("%s: %.1f MB\n", options.output.c_str(), double(page.size()) / 1e6);
}

}  // namespace pvg
