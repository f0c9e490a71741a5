// The interpreter and the programs that read and write Parquet files.
#pragma once
#include <filesystem>
#include <string>

namespace pvg {

// $PVG_PYTHON, or the environment that scripts/install_pack.sh makes. Throws a UsageError that says how to install it.
std::filesystem::path python_with_pyarrow();

// name: read_parquet.py or write_parquet.py
std::filesystem::path parquet_script(const std::string& name);

}  // namespace pvg
