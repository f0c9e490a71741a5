// phyvisgen view: one HTML page that needs nothing else, of a set, of an episode or of an evaluation of a policy.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <string>

#include "host/base/atomic_files.hpp"
#include "host/base/files.hpp"
#include "host/base/outputs.hpp"
#include "host/base/progress.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/data_folder.hpp"
#include "pipeline/episode/episode_set.hpp"
#include "pipeline/episode/evaluation_data.hpp"
#include "pipeline/episode/report_data.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ViewOptions {
  std::string source, output;    // folder of a set or of an episode, or file of an evaluation; HTML file
  std::uint64_t n_episodes = 6;  // of a set, shown with videos and motion; all others stand in the table
};

constexpr const char* THREE = "/usr/share/javascript/three";  // of the Debian package libjs-three

std::string text_of(const fs::path& path, const std::string& remedy) {
  const std::optional<std::string> text = read_whole_file(path);
  if (!text) throw UsageError(path.string() + " could not be read: " + remedy);
  return *text;
}

// Of a library: inside <script> "</" could end it.
std::string safe_in_script(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) text.insert(at + 1, "\\");
  return text;
}

// Of data, whose texts may also hold "<!--" and "<script", after which the page's own end of the script does not count.
std::string safe_json(const Json& data) {
  std::string text = data.dump();
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 6) text.replace(at, 1, "\\u003c");
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

Json folder_report(const fs::path& folder, std::uint64_t n_whole) {
  if (fs::exists(folder / "set.json")) return set_report(folder, n_whole);
  if (fs::exists(folder / "summary.json")) return {{"episodes", Json::array({episode_report(folder, true)})}};
  throw UsageError(folder.string() + " holds neither set.json nor summary.json; name a set or an episode of generate");
}

std::string page_of(const Json& report, const std::string& script, bool shows_motion) {
  const std::string ours = "is the installation complete?", package = "install the Debian package libjs-three";
  const auto three = [&](const char* file) {
    return shows_motion ? safe_in_script(text_of(fs::path(THREE) / file, package)) : std::string();
  };
  const fs::path view = data_folder() / "view";
  std::string page = text_of(view / "report.html", ours);
  replace(page, "/*DATA*/", safe_json(report));
  replace(page, "/*SCRIPT*/", text_of(view / "page.js", ours) + text_of(view / script, ours));
  replace(page, "/*CONTROLS*/", three("examples/js/controls/OrbitControls.js"));
  replace(page, "/*THREE*/", three("three.min.js"));
  return page;
}

void run_view(const ViewOptions& options) {
  if (options.source.empty())
    throw UsageError(
        "view needs the folder of a set or an episode, or a file of an evaluation; `phyvisgen view --help`");
  if (options.output.empty()) throw UsageError("view needs a page to write: -o FILE.html");
  const fs::path output = fs::absolute(options.output);
  if (output.extension() == ".html" || output.extension() == ".htm") make_writable_folder(output.parent_path());
  check_output_file(options.output, {".html", ".htm"});
  const fs::path source = fs::path(options.source).lexically_normal();
  const fs::path named = source.has_filename() ? source : source.parent_path();
  const std::string page = is_file(named) ? page_of(evaluation_report(named), "evaluation.js", false)
                                          : page_of(folder_report(named, options.n_episodes), "report.js", true);
  write_text_atomically(output, page);
  std::printf("%s: %.1f MB\n", options.output.c_str(), double(page.size()) / 1e6);
}

}  // namespace

void add_view(CLI::App& program) {
  CLI::App* command = program.add_subcommand("view", "One HTML page of an episode, a set or an evaluation of a policy");
  ViewOptions& o = options_of_command(*command, run_view);
  command->add_option("SOURCE", o.source,
                      "Folder of a set or of an episode, or a file that `evaluate policy --json` printed");
  command->add_option("-o,--output", o.output, "Page to write (.html); it needs no other file");
  command->add_option("-n,--episodes", o.n_episodes, "So many episodes of a set with videos and 3D")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->footer(
      "Examples:\n  phyvisgen view out/beaker -o beaker.html\n  phyvisgen view out/evaluation.json -o evaluation.html");
}

}  // namespace pvg
