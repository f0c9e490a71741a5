#include "host/formats/table.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>

#include "host/base/error.hpp"
#include "host/formats/hdf5.hpp"

namespace pvg {
namespace {

// between commas, without blanks at both ends; quotes around a name are taken off
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = line.find(',', begin);
    std::string cell = line.substr(begin, end == std::string::npos ? end : end - begin);
    cell.erase(0, cell.find_first_not_of(" \t\""));
    cell.erase(cell.find_last_not_of(" \t\r\"") + 1);
    cells.push_back(cell);
  }
  return cells;
}

double number_in(const std::string& cell, const std::string& place) {
  double value = 0;
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  const char* begin = cell.data() + (cell[0] == '+' ? 1 : 0);
  const char* end = cell.data() + cell.size();
  if (std::from_chars(begin, end, value).ptr != end) throw Failure(place + ": `" + cell + "` is no number");
  return value;
}

MeasuredTable read_csv(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) throw Failure(file.string() + " cannot be read, or is empty");
  const std::vector<std::string> names = cells_of(line);
  MeasuredTable table;
  table.file = file;
  for (const std::string& name : names)
    if (!table.columns.emplace(name, std::vector<double>()).second)
      throw Failure(file.string() + ", line 1: the column `" + name + "` stands there twice");
  std::vector<std::vector<double>*> columns;
  for (const std::string& name : names) columns.push_back(&table.columns[name]);
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r") continue;
    const std::vector<std::string> cells = cells_of(line);
    const std::string place = file.string() + ", line " + std::to_string(number);
    if (cells.size() != names.size()) throw Failure(place + " has another number of columns than the header");
    for (std::size_t i = 0; i < cells.size(); ++i) columns[i]->push_back(number_in(cells[i], place));
    ++table.n_rows;
  }
  return table;
}

MeasuredTable read_arrays(const std::filesystem::path& file) {
  const hdf5::File in = hdf5::File::open(file);
  MeasuredTable table;
  table.file = file;
  for (const std::string& name : in.children("/")) {
    const std::string object = "/" + name;
    if (in.shape(object).size() != 1)
      throw Failure(file.string() + ": `" + name + "` must be a list of numbers, one per row");
    table.columns[name] = in.read<double>(object).values;
  }
  for (const auto& [name, values] : table.columns) {
    if (table.n_rows == 0) table.n_rows = values.size();
    if (values.size() != table.n_rows)
      throw Failure(file.string() + ": `" + name + "` holds " + std::to_string(values.size()) +
                    " numbers, another column " + std::to_string(table.n_rows));
  }
  return table;
}

}  // namespace

const std::vector<double>& MeasuredTable::operator[](const std::string& name) const {
  const auto found = columns.find(name);
  if (found == columns.end()) throw Failure(file.string() + " has no column `" + name + "`");
  return found->second;
}

MeasuredTable read_table(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  return kind == ".h5" || kind == ".hdf5" ? read_arrays(file) : read_csv(file);
}

std::vector<std::filesystem::path> tables_in(const std::filesystem::path& folder, const std::string& prefix) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(".csv")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace pvg
