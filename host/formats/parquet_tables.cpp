#include "host/formats/parquet_tables.hpp"

#include "host/base/error.hpp"

namespace pvg {

nlohmann::json read_parquet(const std::filesystem::path& python, const std::filesystem::path& script,
                            const std::vector<std::filesystem::path>& files, const std::vector<std::string>& columns) {
  std::string names;
  for (const std::string& column : columns) names += (names.empty() ? "" : ",") + column;
  std::vector<std::string> arguments = {script.string(), names};
  for (const std::filesystem::path& file : files) arguments.push_back(file.string());
  std::string text;
  try {
    ProgramPipe pipe(python, arguments, ProgramPipe::Direction::from_program, "Parquet");
    char bytes[65536];
    for (std::size_t n = sizeof bytes; n == sizeof bytes;) text.append(bytes, n = pipe.read(bytes, sizeof bytes));
    pipe.finish();
  } catch (const Failure& failure) {
    throw UsageError(failure.what());
  }
  return nlohmann::json::parse(text);
}

ParquetTables::ParquetTables(const std::filesystem::path& python, const std::filesystem::path& script)
    : pipe_(python, {script.string()}, ProgramPipe::Direction::to_program, "Parquet") {}

void ParquetTables::write(const ParquetTable& table) {
  using Json = nlohmann::ordered_json;
  Json columns = Json::array();
  for (const ParquetColumn& column : table.columns)
    columns.push_back({{"name", column.name}, {"type", column.type}, {"values", column.values}});
  const Json json = {{"path", table.path.string()}, {"columns", columns}, {"metadata", table.metadata}};
  const std::string line = json.dump() + "\n";
  pipe_.write(line.data(), line.size());
}

void ParquetTables::finish() { pipe_.finish(); }

}  // namespace pvg
