#include "host/capture/objects/ply_table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include "host/base/counted.hpp"
#include "host/base/error.hpp"

namespace pvg {
namespace {

namespace fs = std::filesystem;

struct Type {
  const char* names[2];
  std::size_t size;
  float (*value)(const unsigned char* bytes);  // in the machine's order
};

template <class T>
float value_of(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return float(value);
}

constexpr Type TYPES[] = {
    {{"char", "int8"}, 1, value_of<std::int8_t>},    {{"uchar", "uint8"}, 1, value_of<std::uint8_t>},
    {{"short", "int16"}, 2, value_of<std::int16_t>}, {{"ushort", "uint16"}, 2, value_of<std::uint16_t>},
    {{"int", "int32"}, 4, value_of<std::int32_t>},   {{"uint", "uint32"}, 4, value_of<std::uint32_t>},
    {{"float", "float32"}, 4, value_of<float>},      {{"double", "float64"}, 8, value_of<double>}};

struct Header {
  std::string format;
  std::size_t n = 0;
  std::vector<std::pair<std::string, const Type*>> properties;  // of the vertices
};

[[noreturn]] void fail(const fs::path& file, const std::string& what) { throw UsageError(file.string() + ": " + what); }

// Leaves the stream at the first vertex.
Header read_header(std::istream& in, const fs::path& file) {
  Header header;
  std::string line, element;
  bool is_done = false;
  std::getline(in, line);
  if (line.substr(0, 3) != "ply") fail(file, "is no PLY file: its first line is not `ply`");
  while (!is_done && std::getline(in, line)) {
    std::istringstream words(line);
    std::string word, type, name;
    words >> word;
    if (word == "format") words >> header.format;
    if (word == "element") {
      std::size_t n = 0;
      words >> element >> n;
      if (element == "vertex") header.n = n;
      if (element != "vertex" && header.properties.empty())
        fail(file, "its vertices must come first, before the element `" + element + "`");
    }
    if (word == "property" && element == "vertex") {
      words >> type >> name;
      const auto* found = std::find_if(std::begin(TYPES), std::end(TYPES),
                                       [&](const Type& t) { return type == t.names[0] || type == t.names[1]; });
      if (found == std::end(TYPES))
        fail(file, "the vertices' property `" + name + "` is of the type `" + type + "`, no number");
      header.properties.emplace_back(name, found);
    }
    is_done = word == "end_header";
  }
  if (!is_done) fail(file, "its header has no `end_header`: the file is cut off");
  if (header.n == 0 || header.properties.empty()) fail(file, "holds no vertices");
  return header;
}

}  // namespace

std::vector<std::string> ply_properties(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string start(3, ' ');
  if (!in.read(start.data(), 3) || start != "ply") return {};
  in.seekg(0);
  std::vector<std::string> names;
  for (const auto& [name, type] : read_header(in, file).properties) names.push_back(name);
  return names;
}

PlyTable read_ply_table(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(file, "cannot be read; does it exist?");
  const Header header = read_header(in, file);
  const bool is_text = header.format == "ascii", is_big = header.format == "binary_big_endian";
  if (!is_text && !is_big && header.format != "binary_little_endian")
    fail(file, "has the unknown format `" + header.format + "`");
  std::size_t row_size = 0;
  std::vector<std::vector<float>> columns(header.properties.size());
  for (const auto& [name, type] : header.properties) row_size += type->size;
  // a header may lie about the number
  const std::uintmax_t rest = fs::file_size(file) - std::uintmax_t(in.tellg());
  const std::string cut_off = "is cut off: it says " + counted(header.n, "vertex", "vertices") + " and holds fewer";
  if (header.n > rest / (is_text ? 2 * columns.size() : row_size)) fail(file, cut_off);
  for (auto& column : columns) column.reserve(header.n);
  std::vector<unsigned char> row(row_size);
  constexpr bool THIS_IS_BIG = std::endian::native == std::endian::big;
  for (std::size_t i = 0; i < header.n; ++i) {
    if (is_text) {
      for (auto& column : columns) {
        std::string word;
        if (!(in >> word)) fail(file, cut_off);
        column.push_back(std::strtof(word.c_str(), nullptr));  // also nan and inf, which the caller checks
      }
      continue;
    }
    if (!in.read(reinterpret_cast<char*>(row.data()), std::streamsize(row_size))) fail(file, cut_off);
    std::size_t at = 0;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Type& type = *header.properties[k].second;
      std::array<unsigned char, 8> bytes{};
      std::copy_n(row.begin() + std::ptrdiff_t(at), type.size, bytes.begin());
      if (is_big != THIS_IS_BIG) std::reverse(bytes.begin(), bytes.begin() + std::ptrdiff_t(type.size));
      columns[k].push_back(type.value(bytes.data()));
      at += type.size;
    }
  }
  PlyTable table;
  table.n = header.n;
  for (std::size_t k = 0; k < columns.size(); ++k) table.column[header.properties[k].first] = std::move(columns[k]);
  return table;
}

}  // namespace pvg
