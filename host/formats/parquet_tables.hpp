// Parquet files by the program scripts/write_parquet.py (Python with pyarrow), fed with one JSON line per table.
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
