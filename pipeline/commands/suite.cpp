#include "pipeline/commands/suite.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/progress.hpp"
#include "host/base/stop_signal.hpp"
#include "host/identify/report/score.hpp"

namespace pvg::diagnose {
namespace {

namespace fs = std::filesystem;

// This program on one case; its messages go to `log`. Returns its exit code.
int diagnose_case(const fs::path& recording, const fs::path& folder, const DiagnoseOptions& options) {
  const std::string program = fs::read_symlink("/proc/self/exe").string(), log = (folder / "log.txt").string();
  const std::string effects = std::to_string(options.max_effects), minutes = std::to_string(options.minutes);
  std::vector<std::string> words = {program,         "diagnose", recording.string(), "-o",           folder.string(),
                                    "--max-effects", effects,    "--decide",         options.decide, "--minutes",
                                    minutes};
  if (options.n_jobs > 1) words.insert(words.end(), {"--jobs", "1"});
  for (const std::string& text : options.criteria) words.insert(words.end(), {"--set-criterion", text});
  if (options.keeps_simulations) words.push_back("--keep-simulations");
  if (!options.device.empty()) words.insert(words.end(), {"--device", options.device});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw Failure("no process could be started for " + recording.string());
  if (child == 0) {
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file >= 0) dup2(file, 1), dup2(file, 2);
    execv(program.c_str(), arguments.data());
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

void run_suite(const DiagnoseOptions& options) {
  const fs::path suite = options.suite, out = options.folder.empty() ? suite / "reports" : fs::path(options.folder);
  if (!fs::is_directory(suite)) throw UsageError(options.suite + ": there is no such folder of cases");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(suite))
    if (fs::exists(entry.path() / "recording.yaml")) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  if (names.empty()) throw UsageError(options.suite + " holds no folder with a recording.yaml");
  std::erase_if(names, [&](const std::string& name) { return fs::exists(out / name / "report.json"); });
  Progress progress("hidden effects", "cases", names.size());
  std::atomic<std::size_t> next = 0, done = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < names.size() && !stop_on_signals(); i = next++) {
      fs::create_directories(out / names[i]);
      diagnose_case(suite / names[i], out / names[i], options);
      progress.advance_to(++done);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < std::max(options.n_jobs, 1); ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  if (stop_on_signals()) throw TryAgain("stopped; the cases that are done are kept, call again to continue");
  const Score result = score(suite.string(), out.string());
  std::ofstream(out / "score.json") << result.json;
  std::printf("%s", options.as_json ? result.json.c_str() : result.text.c_str());
}

}  // namespace pvg::diagnose
