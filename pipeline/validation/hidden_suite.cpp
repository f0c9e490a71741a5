#include "pipeline/validation/hidden_suite.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "host/base/child_program.hpp"
#include "host/base/error.hpp"
#include "host/base/progress.hpp"
#include "host/base/stop_signal.hpp"
#include "host/identify/report/score.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// This program on one case; its messages go to `log`. Returns its exit code.
int diagnose_case(const fs::path& recording, const fs::path& folder, const std::vector<std::string>& options) {
  std::vector<std::string> words = {"diagnose", recording.string(), "-o", folder.string()};
  words.insert(words.end(), options.begin(), options.end());
  const int log = open((folder / "log.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  ChildProgram child(fs::read_symlink("/proc/self/exe"), words, {-1, log, log}, ChildProgram::Signals::shared);
  close(log);
  return child.wait();
}

}  // namespace

void run_hidden_suite(const HiddenSuite& suite) {
  const fs::path& out = suite.reports;
  if (!fs::is_directory(suite.cases)) throw UsageError(suite.cases.string() + ": there is no such folder of cases");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(suite.cases))
    if (fs::exists(entry.path() / "recording.yaml")) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  if (names.empty()) throw UsageError(suite.cases.string() + " holds no folder with a recording.yaml");
  std::erase_if(names, [&](const std::string& name) { return fs::exists(out / name / "report.json"); });
  Progress progress("hidden effects", "cases", names.size());
  std::atomic<std::size_t> next = 0, done = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < names.size() && !stop_on_signals(); i = next++) {
      fs::create_directories(out / names[i]);
      diagnose_case(suite.cases / names[i], out / names[i], suite.options);
      progress.advance_to(++done);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < std::max(suite.n_jobs, 1); ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  if (stop_on_signals()) throw TryAgain("stopped; the cases that are done are kept, call again to continue");
  const diagnose::Score result = diagnose::score(suite.cases.string(), out.string());
  std::ofstream(out / "score.json") << result.json;
  std::printf("%s", suite.as_json ? result.json.c_str() : result.text.c_str());
}

}  // namespace pvg
