// Measured data as tables of numbers: CSV with a header, or HDF5 with one array per column. An empty cell, or `nan`, is
// a gap and reads as NaN.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pvg {

struct MeasuredTable {
  std::map<std::string, std::vector<double>> columns;  // by the header's names [n_rows each]
  std::size_t n_rows = 0;
  std::filesystem::path file;
  bool has(const std::string& name) const { return columns.contains(name); }
  // Throws a UsageError that names the file where the column is missing.
  const std::vector<double>& operator[](const std::string& name) const;
};

// CSV may have lines before the names, and names in several lines above each other (motion capture): see names_in in
// table.cpp. .h5 and .hdf5 are HDF5, whose arrays at the top are the columns. Throws a UsageError naming file and line
// where a row is not as long as the header or a cell holds something else than a number.
MeasuredTable read_table(const std::filesystem::path& file);

// The same with the named columns alone, where they are arrays of HDF5: others may have other lengths, and names may be
// paths such as `camera/angle`.
MeasuredTable read_columns_of(const std::filesystem::path& file, const std::vector<std::string>& columns);

// Throws a UsageError that says what to do for files of other programs: logs of ROS and of motion capture, which
// scripts/convert_log.py makes tables of, and what has to be exported as CSV.
void demand_table(const std::filesystem::path& file);

// The files of a folder whose names begin with `prefix` and end with .csv, in the order of their names.
std::vector<std::filesystem::path> tables_in(const std::filesystem::path& folder, const std::string& prefix);

}  // namespace pvg
