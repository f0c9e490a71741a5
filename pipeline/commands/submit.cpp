// phyvisgen submit: a Slurm array job that makes the set in shards and a job that merges them, in DIR/jobs.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "host/base/atomic_files.hpp"
#include "host/base/counted.hpp"
#include "host/base/files.hpp"
#include "host/base/program_pipe.hpp"
#include "host/formats/video.hpp"
#include "host/load/task_file.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/data_folder.hpp"
#include "pipeline/episode/episode_set.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct SubmitOptions {
  std::string task, folder;  // task file, folder of the set
  std::uint64_t n_episodes = 1, n_shards = 1, seed = 0;
  std::uint64_t n_at_once = 0;                                // shards that run at a time; 0: all
  std::vector<std::string> generate_options, sbatch_options;  // for generate; lines for Slurm, such as --partition=gpu
  bool runs = false;                                          // submit, not only write
};

std::string text_of(const fs::path& path) {
  const std::optional<std::string> text = read_whole_file(path);
  if (!text) throw Failure(path.string() + " could not be read; is the installation complete?");
  return *text;
}

// In single quotes, as a shell takes every character for itself.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

// Every {{NAME}} becomes its value; a name that is not known is our own mistake.
std::string filled(std::string text, const std::map<std::string, std::string>& values, const fs::path& file) {
  for (std::size_t at = 0; (at = text.find("{{", at)) != std::string::npos;) {
    const std::size_t end = text.find("}}", at);
    const std::string name = text.substr(at + 2, end == std::string::npos ? end : end - at - 2);
    const auto found = values.find(name);
    if (found == values.end()) throw Failure(file.string() + ": {{" + name + "}} is not known");
    text.replace(at, end + 2 - at, found->second);
    at += found->second.size();
  }
  return text;
}

// The number of the job, as `sbatch --parsable` prints it.
std::string submit(const fs::path& sbatch, const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {"--parsable"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  ProgramPipe pipe(sbatch, all, ProgramPipe::Direction::from_program, "sbatch");
  std::string said(256, '\0');
  said.resize(pipe.read(said.data(), said.size()));
  pipe.finish();
  return said.substr(0, said.find_first_of(";\n"));
}

fs::path this_program() { return fs::read_symlink("/proc/self/exe"); }

// What generate would say of the options on the cluster shows here: it reads them, draws its graph and ends.
void check_generate_options(const SubmitOptions& options) {
  if (options.generate_options.empty()) return;
  std::vector<std::string> all = {"generate", options.task, "-o", options.folder, "--shard=0/1", "-n", "1", "--graph"};
  all.insert(all.end(), options.generate_options.begin(), options.generate_options.end());
  ProgramPipe pipe(this_program(), all, ProgramPipe::Direction::from_program, "--generate");
  try {
    char graph[4096];
    while (pipe.read(graph, sizeof graph) > 0) {
    }
    pipe.finish();
  } catch (const Failure& failure) {
    std::string said = failure.what();
    if (const std::size_t at = said.find("phyvisgen: "); at != std::string::npos) said.erase(at, 11);
    throw UsageError(said);
  }
}

void check_sbatch_options(const SubmitOptions& options) {
  for (const std::string& line : options.sbatch_options)
    if (!line.starts_with("-") || line.find_first_of("\n\r") != std::string::npos)
      throw UsageError("--sbatch `" + line.substr(0, line.find_first_of("\n\r")) +
                       "` must be one option of sbatch in one line, such as --partition=gpu");
}

void run_submit(const SubmitOptions& options) {
  if (options.task.empty()) throw UsageError("submit needs a task file; `phyvisgen submit --help` shows an example");
  if (options.folder.empty()) throw UsageError("submit needs an output folder: -o DIR");
  if (options.n_shards > options.n_episodes)
    throw UsageError("--shards " + std::to_string(options.n_shards) + " is more than the set has episodes, " +
                     std::to_string(options.n_episodes));
  check_training_seed(options.seed);
  check_sbatch_options(options);
  check_generate_options(options);
  load_task(options.task);  // what is wrong with it shows here, not on the cluster
  const fs::path folder = fs::absolute(options.folder).lexically_normal(), jobs = folder / "jobs";
  make_writable_folder(jobs);
  std::string extra, directives;
  for (const std::string& option : options.generate_options) extra += " " + quoted(option);
  for (const std::string& directive : options.sbatch_options) directives += "#SBATCH " + directive + "\n";
  const std::map<std::string, std::string> values = {
      {"PROGRAM", quoted(this_program().string())},
      {"TASK", quoted(fs::absolute(options.task).lexically_normal().string())},
      {"FOLDER", quoted(folder.string())},
      {"JOBS", jobs.string()},
      {"EPISODES", std::to_string(options.n_episodes)},
      {"SEED", std::to_string(options.seed)},
      {"SHARDS", std::to_string(options.n_shards)},
      {"LAST_SHARD", std::to_string(options.n_shards - 1)},
      {"AT_ONCE", std::to_string(options.n_at_once > 0 ? options.n_at_once : options.n_shards)},
      {"GENERATE_OPTIONS", extra},
      {"DIRECTIVES", directives}};
  const fs::path templates = data_folder().parent_path() / "scripts/slurm";
  for (const char* name : {"generate.sbatch", "merge.sbatch"})
    write_text_atomically(jobs / name, filled(text_of(templates / name), values, templates / name));
  if (!options.runs) {
    std::printf(
        "%s: generate.sbatch and merge.sbatch are written; submit them by\n"
        "  generate=$(sbatch --parsable %s)\n"
        "  sbatch --dependency=afterany:$generate %s\n",
        jobs.c_str(), quoted((jobs / "generate.sbatch").string()).c_str(),
        quoted((jobs / "merge.sbatch").string()).c_str());
    return;
  }
  const fs::path sbatch = find_program("sbatch", "slurm-client");
  const std::string array = submit(sbatch, {(jobs / "generate.sbatch").string()});
  const std::string merge = submit(sbatch, {"--dependency=afterany:" + array, (jobs / "merge.sbatch").string()});
  std::printf("%s: array job %s of %s, merge job %s; `phyvisgen status %s` once it has run\n", folder.c_str(),
              array.c_str(), counted(options.n_shards, "shard").c_str(), merge.c_str(), folder.c_str());
}

}  // namespace

void add_submit(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("submit", "Make an episode set on a Slurm cluster: array job and merge job");
  SubmitOptions& o = options_of_command(*command, run_submit);
  command->add_option("TASK", o.task, "Task file (YAML)");
  command->add_option("-n,--episodes", o.n_episodes, "How many episodes the set has")
      ->check(CLI::Range(std::uint64_t(1), MOST_EPISODES))
      ->capture_default_str();
  command->add_option("--shards", o.n_shards, "Into how many jobs it is split")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--at-once", o.n_at_once, "How many of them run at a time; else all");
  command->add_option("--seed", o.seed, "Seed of the set")->capture_default_str();
  command->add_option("-o,--output", o.folder,
                      "Folder of the set, which all nodes see; scripts and logs lie in its jobs");
  command
      ->add_option("--sbatch", o.sbatch_options, "A line for Slurm, such as --partition=gpu; may stand several times")
      ->allow_extra_args(false);
  command
      ->add_option("--generate", o.generate_options,
                   "An option for generate, such as --samples=64; may stand several times")
      ->allow_extra_args(false);
  command->add_flag("--run", o.runs, "Submit the jobs; else they are only written");
  command->footer(
      "Example:\n  phyvisgen submit data/tasks/weigh_beaker.yaml -n 10000 --shards 100 --sbatch=--gres=gpu:1 \\\n"
      "      --sbatch=--time=12:00:00 -o /shared/beaker --run");
}

}  // namespace pvg
