// What holds for the command line of every command: numbers are decimal, finite and in range; a command that is not
// there is named, with the nearest one; what reaches the user as the reason of a failure is a sentence of ours.
#pragma once
#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

namespace pvg {

// For all options of `program` and its commands that are numbers; call it when all of them are added.
void make_numbers_strict(CLI::App& program);

// A UsageError that names the first word which should be a command and is none.
void check_command_names(const CLI::App& program, const std::vector<std::string>& words);

// A UsageError that names the first flag which is given a value, as in `--json=3`.
void check_flags(const CLI::App& program, const std::vector<std::string>& words);

// What CLI11 found wrong, in our words: which option is not there and which one is near, which commands there are.
std::string sentence_of(const CLI::App& program, const CLI::ParseError& error);

// One sentence about an exception that is none of ours: libraries speak of themselves, not of the user's files.
std::string sentence_of(const std::exception& error);

}  // namespace pvg
