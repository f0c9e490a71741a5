// phyvisgen evaluate correlate: how well success in simulation foretells success in reality.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/correlation.hpp"
#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "pipeline/command_line/command.hpp"

namespace pvg {
namespace {

using Json = nlohmann::ordered_json;

struct CorrelateOptions {
  std::string simulated, real;  // CSV files
  bool as_json = false;
};

// Rows `name,success` after a header line of these two words.
std::vector<std::pair<std::string, double>> read_rates(const std::string& file) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file))
    throw UsageError(file + " cannot be read; name a CSV file with the columns name,success");
  std::vector<std::pair<std::string, double>> rates;
  std::map<std::string, int> first_line;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::string place = file + ":" + std::to_string(number) + ": ";
    if (number == 1) {
      if (line != "name,success") throw UsageError(place + "the header is not `name,success`");
      continue;
    }
    if (line.empty()) continue;
    const std::size_t comma = line.find(',');
    if (comma == 0 || comma == std::string::npos)
      throw UsageError(place + "a row is a name, a comma and a rate from 0 to 1");
    const std::string name = line.substr(0, comma);
    if (!first_line.emplace(name, number).second)
      throw UsageError(place + "`" + name + "` stands in line " + std::to_string(first_line[name]) + " already");
    try {
      rates.emplace_back(name, parse_real(line.substr(comma + 1), 0, 1));
    } catch (const std::invalid_argument& error) {
      throw UsageError(place + "`success` " + error.what());
    }
  }
  return rates;
}

void run_correlate(const CorrelateOptions& options) {
  if (options.simulated.empty() || options.real.empty())
    throw UsageError("evaluate correlate needs two CSV files: SIM.csv REAL.csv; --help shows an example");
  const auto simulated = read_rates(options.simulated), measured = read_rates(options.real);
  std::map<std::string, double> by_name(measured.begin(), measured.end());
  std::vector<double> all, predicted, real;
  for (const auto& [name, rate] : simulated) {
    all.push_back(rate);
    if (!by_name.contains(name)) continue;
    predicted.push_back(rate);
    real.push_back(by_name[name]);
    by_name.erase(name);
  }
  if (!by_name.empty())
    throw UsageError(options.real + " names `" + by_name.begin()->first + "`, which " + options.simulated + " lacks");
  if (real.size() < 2) throw UsageError("at least two names must stand in both files to correlate them");
  const double pearson = pearson_correlation(predicted, real), violation = mean_rank_violation(predicted, real);
  const RectifiedMean rectified = rectified_mean(all, predicted, real);
  if (options.as_json) {
    const Json json = {{"schema", 1},
                       {"names", real.size()},
                       {"pearson", std::isfinite(pearson) ? Json(pearson) : Json(nullptr)},
                       {"mmrv", violation},
                       {"rectified", {{"mean", rectified.mean}, {"low", rectified.low}, {"high", rectified.high}}}};
    std::printf("%s\n", json.dump(2).c_str());
    return;
  }
  std::printf("Pearson's r %.3f, mean maximum rank violation %.3f, of %s\n", pearson, violation,
              counted(real.size(), "name").c_str());
  std::printf("real success of all %zu simulated, rectified: %.3f (95 %% interval %.3f to %.3f)\n", all.size(),
              rectified.mean, rectified.low, rectified.high);
}

}  // namespace

void add_evaluate_correlate(CLI::App& program) {
  CLI::App* command = command_group(program, "evaluate")
                          .add_subcommand("correlate", "How well success in simulation foretells success in reality");
  CorrelateOptions& o = options_of_command(*command, run_correlate);
  command->add_option("SIM", o.simulated, "CSV file, columns name,success: rates of policies in simulation");
  command->add_option("REAL", o.real, "The same in reality; of fewer policies, or of all");
  command->add_flag("--json", o.as_json, "Print JSON");
  command->footer("Example:\n  phyvisgen evaluate correlate simulated.csv real.csv --json");
}

}  // namespace pvg
