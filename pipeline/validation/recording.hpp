// Measured data as tables: CSV with a header, numbers only.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pvg {

struct Recording {
  std::map<std::string, std::vector<double>> columns;  // by the header's names [n_rows each]
  std::size_t n_rows = 0;
  // Throws a Failure that names the file where the column is missing.
  const std::vector<double>& operator[](const std::string& name) const;
  std::filesystem::path file;
};

// Throws a Failure naming file and line where a row is not as long as the header or holds no numbers.
Recording read_recording(const std::filesystem::path& file);

// The files of a folder whose names begin with `prefix` and end with .csv, in the order of their names.
std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder, const std::string& prefix);

}  // namespace pvg
