// The program without its commands: reads a command line, calls the command.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace pvg {

// One per file of pipeline/commands.
using AddCommand = void (*)(CLI::App& program);
// All of them, sorted by name. The build makes this function from the names of the files.
std::span<const AddCommand> all_commands();

// Runs the command that the words after the program's name ask for. Help is printed; a wrong option is a UsageError.
void run_command_line(std::span<const AddCommand> commands, const std::vector<std::string>& words);

// "0.2.0 (commit 07d9377)", or "0.2.0 (built outside of a git checkout)".
std::string program_version();

}  // namespace pvg
