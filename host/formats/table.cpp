#include "host/formats/table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"
#include "host/hdf5/file.hpp"

namespace pvg {
namespace {

constexpr double LARGEST = 1e15;  // of a measured number, in any unit
constexpr std::size_t MOST_HEADER_LINES = 50;

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
  const auto parsed = std::from_chars(begin, end, value);
  if (parsed.ptr != end || parsed.ec == std::errc::invalid_argument)
    throw UsageError(place + ": `" + cell + "` is no number");
  if (parsed.ec == std::errc::result_out_of_range) value = std::strtod(begin, nullptr);  // infinite, or next to 0
  if (std::abs(value) > LARGEST) throw UsageError(place + ": `" + cell + "` is too large for a measurement");
  return value;
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  if (!in.is_open()) throw UsageError(file.string() + ": there is no such table, or it cannot be read");
  if (lines.empty()) throw UsageError(file.string() + " is empty; it needs a header and rows of numbers");
  if (lines[0].starts_with("\xef\xbb\xbf")) lines[0].erase(0, 3);  // a byte-order mark, as some programs put first
  return lines;
}

bool is_empty(const std::string& line) { return line.empty() || line == "\r"; }

// numbers and gaps alone, one number at least
bool holds_numbers(const std::vector<std::string>& cells) {
  bool any = false;
  for (const std::string& cell : cells) {
    double value = 0;
    if (cell.empty()) continue;
    const auto parsed = std::from_chars(cell.data() + (cell[0] == '+'), cell.data() + cell.size(), value);
    if (parsed.ptr != cell.data() + cell.size() || parsed.ec == std::errc::invalid_argument) return false;
    any = true;
  }
  return any;
}

struct Header {
  std::vector<std::string> names;
  std::size_t n_lines = 1;  // until the first row
};

// The names in several lines above each other, as programs of motion capture write them: the last line's, and where it
// says one twice those above it that tell the columns apart, the uppermost first.
std::vector<std::string> names_in(const std::vector<std::vector<std::string>>& above) {
  const std::vector<std::string>& last = above.back();
  std::vector<std::string> names = last, front(last.size());
  for (std::size_t line = 0; line + 1 < above.size(); ++line) {
    std::vector<std::string> longer(last.size()), more = front;
    for (std::size_t i = 0; i < last.size(); ++i) {
      if (!above[line][i].empty()) more[i] += above[line][i] + " ";
      longer[i] = more[i] + last[i];
    }
    const auto n_distinct = [](const std::vector<std::string>& all) { return std::set(all.begin(), all.end()).size(); };
    if (n_distinct(longer) <= n_distinct(names)) continue;
    names = longer;
    front = more;
  }
  for (std::size_t i = 0; i < last.size(); ++i)
    if (!last[i].empty() && std::count(last.begin(), last.end(), last[i]) == 1) names[i] = last[i];
  for (std::string& name : names) name.erase(name.find_last_not_of(' ') + 1);
  return names;
}

// Lines before the names say how a file was made; one with another number of cells than the rows is among them.
Header header_of(const std::vector<std::string>& lines) {
  const Header plain{cells_of(lines[0]), 1};
  for (std::size_t row = 1; row < std::min<std::size_t>(lines.size(), MOST_HEADER_LINES); ++row) {
    const std::vector<std::string> cells = cells_of(lines[row]);
    if (is_empty(lines[row]) || !holds_numbers(cells)) continue;
    std::vector<std::vector<std::string>> above;
    std::size_t first = row;
    for (; first > 0 && cells_of(lines[first - 1]).size() == cells.size(); --first)
      above.insert(above.begin(), cells_of(lines[first - 1]));
    if (above.empty() || first == 0) return plain;
    return {names_in(above), row};
  }
  return plain;
}

MeasuredTable read_csv(const std::filesystem::path& file) {
  demand_table(file);
  const std::vector<std::string> lines = lines_of(file);
  const auto [names, n_header] = header_of(lines);
  if (names.size() == 1 && lines[0].find(';') != std::string::npos)
    throw UsageError(file.string() + ", line 1: the columns are parted by semicolons; part them by commas");
  MeasuredTable table;
  table.file = file;
  for (const std::string& name : names)
    if (!table.columns.emplace(name, std::vector<double>()).second)
      throw UsageError(file.string() + ", line " + std::to_string(n_header) + ": the column `" + name +
                       "` stands there twice");
  std::vector<std::vector<double>*> columns;
  for (const std::string& name : names) columns.push_back(&table.columns[name]);
  for (std::size_t line = n_header; line < lines.size(); ++line) {
    if (is_empty(lines[line])) continue;
    const std::vector<std::string> cells = cells_of(lines[line]);
    const std::string place = file.string() + ", line " + std::to_string(line + 1);
    if (cells.size() != names.size()) throw UsageError(place + " has another number of columns than the header");
    for (std::size_t i = 0; i < cells.size(); ++i) columns[i]->push_back(number_in(cells[i], place));
    ++table.n_rows;
  }
  return table;
}

bool is_hdf5(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  return kind == ".h5" || kind == ".hdf5";
}

MeasuredTable read_arrays(const hdf5::File& in, const std::filesystem::path& file,
                          const std::vector<std::string>& names) {
  MeasuredTable table;
  table.file = file;
  for (const std::string& name : names) {
    const std::string object = "/" + name;
    if (!in.has(object)) throw UsageError(file.string() + " has no column `" + name + "`");
    if (in.shape(object).size() != 1)
      throw UsageError(file.string() + ": `" + name + "` must be a list of numbers, one per row");
    table.columns[name] = in.read<double>(object).values;
  }
  for (const auto& [name, values] : table.columns) {
    if (table.n_rows == 0) table.n_rows = values.size();
    if (values.size() != table.n_rows)
      throw UsageError(file.string() + ": `" + name + "` holds " + counted(values.size(), "number") +
                       ", another column " + std::to_string(table.n_rows));
  }
  return table;
}

}  // namespace

void demand_table(const std::filesystem::path& file) {
  for (const char* kind : {".mcap", ".db3", ".bag", ".c3d"})
    if (file.extension() == kind)
      throw UsageError(file.string() + " is a log, no table: `scripts/convert_log.py " + file.string() +
                       " -o FOLDER` makes a recording of it");
  for (const char* kind : {".mat", ".npz", ".parquet"})
    if (file.extension() == kind)
      throw UsageError(file.string() + ": a table is a CSV or HDF5 file, and " + kind +
                       " files are not read; export its channels as CSV, one column each, with the time in seconds");
}

const std::vector<double>& MeasuredTable::operator[](const std::string& name) const {
  const auto found = columns.find(name);
  if (found == columns.end()) throw UsageError(file.string() + " has no column `" + name + "`");
  return found->second;
}

MeasuredTable read_table(const std::filesystem::path& file) {
  if (!is_hdf5(file)) return read_csv(file);
  const hdf5::File in = hdf5::File::open(file);
  return read_arrays(in, file, in.children("/"));
}

MeasuredTable read_columns_of(const std::filesystem::path& file, const std::vector<std::string>& columns) {
  if (!is_hdf5(file)) return read_csv(file);
  return read_arrays(hdf5::File::open(file), file, columns);
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
