#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>

#include "host/base/atomic_files.hpp"
#include "host/base/program_pipe.hpp"
#include "host/formats/video.hpp"
#include "host/load/task_file.hpp"
#include "pipeline/commands/commands.hpp"
#include "pipeline/commands/data_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Failure(path.string() + " could not be read; is the installation complete?");
  return {std::istreambuf_iterator<char>(in), {}};
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

}  // namespace

void run_submit(const SubmitOptions& options) {
  if (options.task.empty()) throw UsageError("submit needs a task file; `phyvisgen submit --help` shows an example");
  if (options.folder.empty()) throw UsageError("submit needs an output folder: -o DIR");
  if (options.n_shards > options.n_episodes)
    throw UsageError("--shards " + std::to_string(options.n_shards) + " is more than the set has episodes, " +
                     std::to_string(options.n_episodes));
  load_task(options.task);  // what is wrong with it shows here, not on the cluster
  const fs::path folder = fs::absolute(options.folder).lexically_normal(), jobs = folder / "jobs";
  make_writable_folder(jobs);
  std::string extra, directives;
  for (const std::string& option : options.generate_options) extra += " " + quoted(option);
  for (const std::string& directive : options.sbatch_options) directives += "#SBATCH " + directive + "\n";
  const std::map<std::string, std::string> values = {
      {"PROGRAM", quoted(fs::read_symlink("/proc/self/exe").string())},
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
  std::printf("%s: array job %s of %llu shards, merge job %s; `phyvisgen status %s` once it has run\n", folder.c_str(),
              array.c_str(), static_cast<unsigned long long>(options.n_shards), merge.c_str(), folder.c_str());
}

}  // namespace pvg
