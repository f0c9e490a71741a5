// What a command's file needs: pipeline/commands/<name>.cpp defines `void add_<name>(CLI::App& program)`, which adds
// the command with its options and its action. The list of commands is made from the file names.
#pragma once
#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "host/base/error.hpp"

namespace pvg {

// Options that live as long as the command; `run` is called with them after the command line was read. It returns when
// the work is done and reports everything else by the exceptions of host/base/error.hpp.
template <typename Options>
Options& options_of_command(CLI::App& command, void (*run)(const Options&)) {
  const auto options = std::make_shared<Options>();
  command.callback([options, run, &command] {
    // `evaluate fidelity` is its own command, not one of `evaluate`
    if (command.get_subcommands().empty()) run(*options);
  });
  return *options;
}

// `bench` or `calibrate`, the first word of several commands; added to the program when it is first asked for.
CLI::App& command_group(CLI::App& program, const std::string& name);

}  // namespace pvg
