// phyvisgen evaluate policy: the Python package `phyvisgen`, started with this program and the user's words.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "host/base/child_program.hpp"
#include "host/base/error.hpp"
#include "host/base/outputs.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/data_folder.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

// $PVG_PYTHON, or the environment that scripts/install_policy.sh makes.
fs::path python_with_package() {
  if (const char* named = std::getenv("PVG_PYTHON")) {
    if (!is_file(named)) throw UsageError("PVG_PYTHON names " + std::string(named) + ", which is no file");
    return named;
  }
  const fs::path root = data_folder().parent_path();
  const fs::path python = root / ".venv-policy/bin/python";
  if (fs::exists(python)) return python;
  throw UsageError("policies are evaluated by the Python package phyvisgen: run " +
                   (root / "scripts/install_policy.sh").string() +
                   ", which installs it beside the program, or name an interpreter that has it in PVG_PYTHON");
}

// asked: as the user wrote it
void run_policy(const std::vector<std::string>& asked) {
  std::vector<std::string> words = {"-m", "phyvisgen.evaluate"};
  words.insert(words.end(), asked.begin(), asked.end());
  const fs::path program = fs::read_symlink("/proc/self/exe");
  setenv("PHYVISGEN_PROGRAM", program.c_str(), 1);
  ChildProgram python(python_with_package(), words, {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO},
                      ChildProgram::Signals::shared);
  const int code = python.wait();
  if (code == 2) throw UsageError("evaluate policy was used wrongly; its message stands above");
  if (code != 0) throw Failure("evaluate policy did not finish; its message stands above");
}

}  // namespace

void add_evaluate_policy(CLI::App& program) {
  CLI::App* command =
      command_group(program, "evaluate").add_subcommand("policy", "Success of a policy in the loop, beside baselines");
  command->prefix_command();  // all words from the first on are the package's
  command->callback([command] { run_policy(command->remaining()); });
  command->footer(
      "Words: TASK --policy ws://HOST:PORT|blind|nearest|expert, and those of `phyvisgen evaluate policy TASK "
      "--help`.\n"
      "Examples:\n  phyvisgen evaluate policy data/tasks/weigh_beaker.yaml --policy ws://localhost:8000 -n 20 --json\n"
      "  phyvisgen evaluate policy push.yaml --policy blind --baseline expert --videos out/failures");
}

}  // namespace pvg
