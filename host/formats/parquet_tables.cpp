#include "host/formats/parquet_tables.hpp"

namespace pvg {

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
