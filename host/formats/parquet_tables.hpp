// Parquet files by the programs scripts/write_parquet.py, fed with one JSON line per table, and scripts/read_parquet.py
// (Python with pyarrow).
#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/program_pipe.hpp"

namespace pvg {

struct ParquetColumn {
  std::string name;
  std::string type;  // float, double, int64, string, or list<...> of these
  nlohmann::ordered_json values = nlohmann::ordered_json::array();
};

struct ParquetTable {
  std::filesystem::path path;
  std::vector<ParquetColumn> columns;
  std::map<std::string, std::string> metadata;  // of the schema
};

// The named columns of some files, one after the other: {COLUMN: [values of all rows]}. Throws a UsageError that says
// what is wrong with a file.
nlohmann::json read_parquet(const std::filesystem::path& python, const std::filesystem::path& script,
                            const std::vector<std::filesystem::path>& files, const std::vector<std::string>& columns);

class ParquetTables {
 public:
  // script: write_parquet.py; python: an interpreter that has pyarrow
  ParquetTables(const std::filesystem::path& python, const std::filesystem::path& script);
  void write(const ParquetTable& table);  // the folder of its path must exist
  void finish();                          // until all are on disk

 private:
  ProgramPipe pipe_;
};

}  // namespace pvg
