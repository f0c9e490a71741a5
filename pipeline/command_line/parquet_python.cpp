#include "pipeline/command_line/parquet_python.hpp"

#include <cstdlib>

#include "host/base/error.hpp"
#include "pipeline/command_line/data_folder.hpp"

namespace pvg {

namespace fs = std::filesystem;

fs::path python_with_pyarrow() {
  if (const char* named = std::getenv("PVG_PYTHON")) return named;
  const fs::path python = data_folder().parent_path() / ".venv-pack/bin/python";
  if (fs::exists(python)) return python;
  throw UsageError("LeRobot's formats need Python with pyarrow: run " +
                   (data_folder().parent_path() / "scripts/install_pack.sh").string() +
                   ", which installs it beside the program, or name an interpreter in the variable PVG_PYTHON");
}

fs::path parquet_script(const std::string& name) { return data_folder().parent_path() / "scripts" / name; }

}  // namespace pvg
