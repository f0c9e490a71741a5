#include "pipeline/command_line/command_line.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"

namespace pvg {
namespace {

constexpr double LARGEST = 1e9;  // of an option that names no range of its own

// As CLI11 writes it behind the type of an option: "UINT:INT in [1 - 64]".
struct WrittenRange {
  std::string low, high;
};

std::optional<WrittenRange> range_in(const std::string& kind) {
  const std::size_t from = kind.find(" in ["), middle = kind.find(" - ", from), to = kind.find(']', from);
  if (from == std::string::npos || middle == std::string::npos || to == std::string::npos || middle > to) return {};
  const std::size_t low = from + 5, high = middle + 3;
  return WrittenRange{kind.substr(low, middle - low), kind.substr(high, to - high)};
}

void check_whole(const std::string& text, const std::string& kind) {
  const bool is_above_0 = kind.find("POSITIVE") != std::string::npos;
  std::uint64_t low = is_above_0 ? 1 : 0, high = std::numeric_limits<std::uint64_t>::max();
  if (kind.starts_with("INT")) high = std::uint64_t(std::numeric_limits<int>::max());
  if (const auto range = range_in(kind)) {
    low = parse_whole(range->low, 0, high);
    high = parse_whole(range->high, low, high);
  }
  parse_whole(text, low, high);
}

void check_real(const std::string& text, const std::string& kind) {
  double low = 0, high = LARGEST;
  if (const auto range = range_in(kind)) {
    low = std::stod(range->low), high = std::stod(range->high);
    // they are rounded: what is at its very ends is left to CLI11
    constexpr double ROUNDED = 1e-5;
    const double near = std::strtod(text.c_str(), nullptr);
    if (std::abs(near - low) <= ROUNDED * std::abs(low) || std::abs(near - high) <= ROUNDED * std::abs(high)) {
      parse_real(text, -LARGEST, LARGEST);
      return;
    }
  }
  const double value = parse_real(text, low, high);
  if (kind.find("POSITIVE") != std::string::npos && !(value > 0))
    throw std::invalid_argument("must be above 0, but is `" + text + "`");
}

// What is wrong with the text; empty: nothing. kind: as CLI11 calls the type of the option and its range.
std::string fault_of(const std::string& text, const std::string& kind) {
  try {
    kind.starts_with("FLOAT") ? check_real(text, kind) : check_whole(text, kind);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

bool is_number(const std::string& kind) {
  return kind.starts_with("UINT") || kind.starts_with("INT") || kind.starts_with("FLOAT");
}

void make_strict(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    const std::string kind = option->get_type_name();
    if (!is_number(kind)) continue;
    // in front of the range that the option may have, which would read `inf` and 0x10 as numbers
    option->transform(CLI::Validator([kind](std::string& text) { return fault_of(text, kind); }, ""));
  }
  for (CLI::App* inner : command.get_subcommands({})) make_strict(*inner);
}

std::vector<std::string> names_in(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// The command of this name among those of `app`; nullptr: none.
const CLI::App* command_in(const CLI::App& app, const std::string& name) {
  const std::vector<const CLI::App*> found =
      app.get_subcommands([&](const CLI::App* command) { return command->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

// The command that the words named, and how it is called: "phyvisgen bench physics".
std::pair<const CLI::App*, std::string> named_command(const CLI::App& program) {
  std::pair<const CLI::App*, std::string> named(&program, program.get_name());
  while (!named.first->get_subcommands().empty()) {
    named.first = named.first->get_subcommands().front();
    named.second += " " + named.first->get_name();
  }
  return named;
}

// Of words that no option and no place takes.
std::string sentence_on_extra(const CLI::App& command, const std::string& name, std::string word) {
  const std::string help = " `" + name + " --help` lists what there is";
  if (!word.starts_with("-")) return "`" + word + "` is a word too many for `" + name + "`;" + help;
  word = word.substr(0, word.find('='));
  std::vector<std::string> options;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& each : option->get_lnames()) options.push_back(each);
  const std::string nearest = nearest_word(word.substr(word.find_first_not_of('-')), options);
  return "`" + name + "` has no option " + word + (nearest.empty() ? ";" : "; did you mean --" + nearest + "?") + help;
}

}  // namespace

void make_numbers_strict(CLI::App& program) { make_strict(program); }

void check_command_names(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* app = &program;
  std::string said;  // the commands so far
  for (const std::string& word : words) {
    const std::vector<std::string> names = names_in(*app);
    if (names.empty() || word.starts_with('-')) return;
    const CLI::App* inner = command_in(*app, word);
    if (!inner) {
      const std::string nearest = nearest_word(word, names);
      const bool is_needed = app->get_require_subcommand_min() > 0;
      // where a file may stand instead, as in `evaluate SET`, a word that is near no command is one
      if (!is_needed && (nearest.empty() || std::filesystem::exists(word))) return;
      throw UsageError("there is no command `" + said + word + "`" +
                       (nearest.empty() ? "; the" : "; did you mean `" + said + nearest + "`? The") +
                       " commands are: " + joined(names));
    }
    said += word + " ";
    app = inner;
  }
}

void check_flags(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* app = &program;
  std::string said = program.get_name();
  for (const std::string& word : words) {
    if (const CLI::App* inner = command_in(*app, word)) {
      app = inner;
      said += " " + word;
    } else if (word == "--" || app->get_prefix_command()) {
      return;  // what follows is a file, or read by another program
    } else if (const std::size_t equals = word.find('='); word.starts_with("--") && equals != std::string::npos) {
      const std::string name = word.substr(0, equals);
      const CLI::Option* option = app->get_option_no_throw(name);
      if (option && option->get_items_expected_max() == 0)
        throw UsageError(name + " of `" + said + "` takes no value, but is given `" + word.substr(equals + 1) +
                         "`; write " + name + " alone, or leave it out");
    }
  }
}

std::string sentence_of(const CLI::App& program, const CLI::ParseError& error) {
  const auto [command, name] = named_command(program);
  const std::vector<std::string> extra = program.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) && !extra.empty())
    return sentence_on_extra(*command, name, extra.front());
  if (dynamic_cast<const CLI::RequiredError*>(&error) && command->get_require_subcommand_min() > 0)
    return "`" + name + "` needs a command: " + joined(names_in(*command)) + " (--help says what each does)";
  std::string sentence = error.what();
  if (const std::size_t colon = sentence.find(": must be "); colon != std::string::npos) sentence.erase(colon, 1);
  return sentence + " (--help shows how)";
}

std::string sentence_of(const std::exception& error) {
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return (file->path1().empty() ? std::string("a file") : file->path1().string()) +
           (file->path2().empty() ? " could not be read or written: "
                                  : " could not be brought to " + file->path2().string() + ": ") +
           file->code().message();
  if (dynamic_cast<const std::bad_alloc*>(&error) || dynamic_cast<const std::length_error*>(&error))
    return "the memory of this machine is used up; a number in the input may be far too large";
  return "this input met a fault of the program itself, which nothing was lost by; please report it with the command "
         "and its files";
}

}  // namespace pvg
