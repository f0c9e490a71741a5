#include "pipeline/validation/recording.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "host/base/error.hpp"

namespace pvg {
namespace {

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

const std::vector<double>& Recording::operator[](const std::string& name) const {
  const auto found = columns.find(name);
  if (found == columns.end()) throw Failure(file.string() + " has no column `" + name + "`");
  return found->second;
}

Recording read_recording(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) throw Failure(file.string() + " cannot be read, or is empty");
  const std::vector<std::string> names = cells_of(line);
  Recording recording;
  recording.file = file;
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = cells_of(line);
    const std::string place = file.string() + ", line " + std::to_string(recording.n_rows + 2);
    if (cells.size() != names.size()) throw Failure(place + " has another number of columns than the header");
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = 0;
      const char* end = cells[i].data() + cells[i].size();
      if (std::from_chars(cells[i].data(), end, value).ptr != end || cells[i].empty())
        throw Failure(place + ": `" + cells[i] + "` is no number");
      recording.columns[names[i]].push_back(value);
    }
    ++recording.n_rows;
  }
  return recording;
}

std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder, const std::string& prefix) {
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
