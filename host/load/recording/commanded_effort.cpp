#include "host/load/recording/commanded_effort.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace pvg {
namespace {

struct UnitOfCommand {
  const char* name;
  double in_si;
};

struct Command {
  const char *suffix, *name, *per, *example;  // of the target; what it is; end of the constant's unit
  std::vector<UnitOfCommand> units;
};

const std::vector<Command>& commands() {
  static const std::vector<Command> all = {{"/current", "current", "/A", "0.05 N m/A", {{"A", 1}, {"mA", 1e-3}}},
                                           {"/pressure",
                                            "pressure",
                                            "/Pa",
                                            "3e-4 N/Pa, the area of a piston",
                                            {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"bar", 1e5}}}};
  return all;
}

std::string names_of(const std::vector<UnitOfCommand>& units) {
  std::string names;
  for (std::size_t i = 0; i < units.size(); ++i)
    names += (i == 0 ? "" : i + 1 < units.size() ? ", " : " or ") + std::string(units[i].name);
  return names;
}

}  // namespace

void make_effort(YamlSection& section, RecordedInput& input, std::vector<RecordedRun>& runs) {
  const auto command = std::find_if(commands().begin(), commands().end(), [&](const Command& one) {
    return input.target.starts_with("joint/") && input.target.ends_with(one.suffix);
  });
  if (command == commands().end()) return;
  const std::string constant = section.text("constant"), column = input.columns[0];
  char* end = nullptr;
  const double value = std::strtod(constant.c_str(), &end);
  std::string effort_unit = end;
  effort_unit.erase(0, effort_unit.find_first_not_of(' '));
  const std::size_t per = effort_unit.find('/');
  if (end == constant.c_str() || !std::isfinite(value) || value == 0 || per == std::string::npos ||
      effort_unit.substr(per) != command->per)
    section.fail("constant",
                 "must be an effort per " + std::string(command->name) + ", such as " + std::string(command->example));
  const auto unit = std::find_if(command->units.begin(), command->units.end(),
                                 [&](const UnitOfCommand& one) { return input.unit == one.name; });
  if (unit == command->units.end())
    section.fail("unit", "of a " + std::string(command->name) + " must be " + names_of(command->units));
  const std::string effort = column + " x " + constant;
  for (RecordedRun& run : runs) {
    if (!run.table.has(column)) continue;  // an error names it later
    std::vector<double> values = run.table[column];
    for (double& commanded : values) commanded *= value * unit->in_si;
    run.table.columns[effort] = std::move(values);
  }
  const bool is_everywhere =
      std::all_of(runs.begin(), runs.end(), [&](const RecordedRun& run) { return run.table.has(effort); });
  if (is_everywhere) input.columns = {effort};
  input.target.replace(input.target.rfind('/'), std::string::npos, "/torque");
  input.unit = effort_unit.substr(0, per);
}

}  // namespace pvg
