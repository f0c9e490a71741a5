// phyvisgen merge: parts of one set into one folder. A UsageError where they are of different origin. What is there
// already stays, so that it can be called again.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "host/base/atomic_files.hpp"
#include "host/base/outputs.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct MergeOptions {
  std::vector<std::string> folders;  // parts of one set
  std::string output;                // may be one of them
  bool removes = false;              // the parts, once they are merged
  bool mixes_devices = false;        // parts of several devices or drivers: an episode's bits depend on who made it
};

bool are_equal(const fs::path& first, const fs::path& second) {
  std::error_code missing;
  if (fs::file_size(first, missing) != fs::file_size(second, missing) || missing) return false;
  std::ifstream a(first, std::ios::binary), b(second, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return std::equal(Bytes(a), Bytes(), Bytes(b), Bytes());
}

void demand_same_origin(const EpisodeSet& first, const EpisodeSet& other, bool mixes_devices) {
  const auto demand = [&](bool is_same, const std::string& what) {
    if (!is_same)
      throw UsageError(other.folder.string() + " and " + first.folder.string() +
                       " are not parts of one set, which alone can be merged: they hold episodes of different " + what);
  };
  demand(other.task == first.task, "tasks (" + other.task + " and " + first.task + ")");
  demand(other.seed == first.seed, "seeds (" + std::to_string(other.seed) + " and " + std::to_string(first.seed) + ")");
  demand(other.configuration == first.configuration, "configurations (the task file or an option differs)");
  for (const auto& version : other.versions)
    if (!mixes_devices || !version.first.starts_with("opencl_"))
      demand(std::find(first.versions.begin(), first.versions.end(), version) != first.versions.end(),
             "versions (" + version.first + " " + version.second + ")" +
                 (version.first.starts_with("opencl_") ? "; with --mixed-devices they are merged all the same" : ""));
}

// The same file by another name where the file system can, a copy elsewhere.
void link_or_copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_hard_link(from, to, error);
  if (error) fs::copy_file(from, to);
}

void put(const fs::path& from, const fs::path& to) {
  fs::create_directories(to.parent_path());
  PartialFolder folder(to);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(from)) {
    const fs::path there = folder.path() / entry.path().lexically_relative(from);
    if (entry.is_directory())
      fs::create_directory(there);
    else
      link_or_copy(entry.path(), there);
  }
  folder.finish();
}

struct Merged {
  std::size_t n_put = 0, n_there = 0;
};

void merge_one(const EpisodeSet& part, const EpisodeSet& whole, Merged& merged) {
  const SetStatus status = read_status(part.folder);
  for (const std::uint64_t episode : status.done) {
    const fs::path from = episode_folder(part.folder, episode), to = episode_folder(whole.folder, episode);
    if (is_done(whole, episode)) {
      if (!are_equal(from / "states.h5", to / "states.h5"))
        throw Failure("episode " + std::to_string(episode) + " differs in " + part.folder.string() + " and " +
                      whole.folder.string() + ", though both are of one set; make one of them anew");
      ++merged.n_there;
      continue;
    }
    put(from, to);
    std::error_code ignored;
    fs::remove_all(failed_folder(whole.folder, episode), ignored);
    ++merged.n_put;
  }
  for (const FailedEpisode& failed : status.failed) {
    if (is_done(whole, failed.episode) || failure_of(whole.folder, failed.episode)) continue;
    put(failed_folder(part.folder, failed.episode), failed_folder(whole.folder, failed.episode));
  }
}

// A folder that is merged is neither around nor inside the whole, unless it is the whole, and stands there once.
void check_folders(const MergeOptions& options) {
  std::error_code ignored;
  for (std::size_t i = 0; i < options.folders.size(); ++i) {
    if (!fs::equivalent(options.folders[i], options.output, ignored))
      check_not_within(options.output, options.folders[i], "merge");
    for (std::size_t k = 0; k < i; ++k)
      if (fs::equivalent(options.folders[i], options.folders[k], ignored))
        throw UsageError(options.folders[k] + " and " + options.folders[i] +
                         " are the same folder twice; name it once");
  }
}

bool is_ours(const fs::path& file) {
  const std::string name = file.filename().string(), ending = file.extension().string();
  return name == "summary.json" || name == "states.h5" || name == "contact_sheet.png" || ending == ".mp4" ||
         name.ends_with("_masks.h5") || name.ends_with("_truth.h5");
}

// What generate made of a part; anything else that somebody has put there stays, and the folders around it.
void remove_ours(const fs::path& part) {
  std::error_code ignored;
  const SetStatus status = read_status(part);
  std::vector<fs::path> episodes;
  for (const std::uint64_t episode : status.done) episodes.push_back(episode_folder(part, episode));
  for (const FailedEpisode& failed : status.failed) episodes.push_back(failed_folder(part, failed.episode));
  for (const fs::path& episode : episodes) {
    std::vector<fs::path> files;
    const fs::path start = episode / "start";  // of cameras
    for (const fs::path& place : {episode, start})
      for (const fs::directory_entry& entry : fs::directory_iterator(place, ignored))
        if (entry.is_regular_file(ignored) && is_ours(entry.path())) files.push_back(entry.path());
    for (const fs::path& file : files) fs::remove(file, ignored);
    for (const fs::path& place : {start, episode}) fs::remove(place, ignored);  // where it is empty
  }
  fs::remove(part / "set.json", ignored);
  fs::remove(part / "failed", ignored);
  if (!fs::remove(part, ignored) && fs::exists(part, ignored))
    std::fprintf(stderr, "phyvisgen: note: %s stays: it holds files that are not of generate\n", part.c_str());
}

void run_merge(const MergeOptions& options) {
  if (options.folders.empty()) throw UsageError("merge needs the folders to merge; `phyvisgen merge --help`");
  if (options.output.empty()) throw UsageError("merge needs an output folder: -o DIR");
  std::vector<EpisodeSet> parts;
  for (const std::string& folder : options.folders) parts.push_back(read_set(folder));
  if (fs::exists(fs::path(options.output) / "set.json")) parts.push_back(read_set(options.output));
  check_folders(options);
  for (const EpisodeSet& part : parts) demand_same_origin(parts.front(), part, options.mixes_devices);
  EpisodeSet whole = parts.front();
  whole.folder = options.output;
  for (const EpisodeSet& part : parts) whole.n_asked = std::max(whole.n_asked, part.n_asked);

  for (const EpisodeSet& part : parts) read_status(part.folder);  // what is damaged shows before anything is made
  make_writable_folder(whole.folder);
  remove_leftovers(whole.folder);
  remove_leftovers(whole.folder / "failed");
  std::error_code ignored;
  Merged merged;
  for (const EpisodeSet& part : parts)
    if (!fs::equivalent(part.folder, whole.folder, ignored)) merge_one(part, whole, merged);
  write_set(whole);
  if (options.removes)
    for (const EpisodeSet& part : parts)
      if (!fs::equivalent(part.folder, whole.folder, ignored)) remove_ours(part.folder);
  const SetStatus status = read_status(whole.folder);
  std::printf("%s: %zu merged, %zu there before; %zu done, %zu failed, %zu missing of %llu\n", whole.folder.c_str(),
              merged.n_put, merged.n_there, status.done.size(), status.failed.size(), missing(whole, status).size(),
              static_cast<unsigned long long>(whole.n_asked));
}

}  // namespace

void add_merge(CLI::App& program) {
  CLI::App* command = program.add_subcommand("merge", "Put the parts of one episode set into one folder");
  MergeOptions& o = options_of_command(*command, run_merge);
  command->add_option("DIR", o.folders, "Folders that generate has filled, of the same task, seed and options");
  command->add_option("-o,--output", o.output, "Folder of the whole set; episodes that are there already stay");
  command->add_flag("--mixed-devices", o.mixes_devices,
                    "Merge parts that were made on different devices, too; the bits differ across devices");
  command->add_flag("--remove", o.removes, "Remove the given folders once they are merged");
  command->footer("Example:\n  phyvisgen merge out/shards/* -o out/beaker");
}

}  // namespace pvg
