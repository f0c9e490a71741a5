#include "pipeline/command_line/program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "host/base/error.hpp"
#include "pipeline/command_line/command.hpp"
#include "pipeline/command_line/command_line.hpp"

namespace pvg {
namespace {

// first words of several commands, with what their help says
constexpr std::pair<const char*, const char*> GROUPS[] = {
    {"bench", "Measure speed and memory"},
    {"calibrate", "Fit the renderer to a real camera"},
    {"capture", "Rooms and objects from what a camera saw"},
};

}  // namespace

CLI::App& command_group(CLI::App& program, const std::string& name) {
  for (CLI::App* there : program.get_subcommands([&](CLI::App* each) { return each->check_name(name); })) return *there;
  const auto group = std::find_if(std::begin(GROUPS), std::end(GROUPS), [&](const auto& g) { return g.first == name; });
  if (group == std::end(GROUPS)) throw std::logic_error("there is no group of commands `" + name + "`");
  CLI::App* added = program.add_subcommand(name, group->second);
  added->require_subcommand(1);
  return *added;
}

void run_command_line(std::span<const AddCommand> commands, const std::vector<std::string>& words) {
  CLI::App program("Robot-learning data: soft-gripper manipulation, simulated with contact and path traced",
                   "phyvisgen");
  program.set_version_flag("--version", program_version());
  program.require_subcommand(1);
  for (const AddCommand add : commands) add(program);
  make_numbers_strict(program);
  check_command_names(program, words);
  check_flags(program, words);
  try {
    program.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes them from the back
  } catch (const CLI::Success& help) {
    program.exit(help);
  } catch (const CLI::ParseError& error) {
    throw UsageError(sentence_of(program, error));
  }
}

}  // namespace pvg
