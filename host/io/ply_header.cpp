#include "host/io/ply_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "host/base/error.hpp"

namespace pvg {
namespace {

using Words = std::vector<std::string>;

bool is_type(const std::string& word) {
  constexpr std::array TYPES = {"char", "uchar", "short", "ushort", "int",   "uint",   "float",   "double",
                                "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
  return std::find(TYPES.begin(), TYPES.end(), word) != TYPES.end();
}

bool is_count(const std::string& word, std::uintmax_t most) {
  std::uintmax_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  return error == std::errc() && end == word.data() + word.size() && count <= most;
}

// `format`, `element` and `property` as they must be; has_element: one was announced above
bool is_sound(const Words& words, std::uintmax_t file_size, bool has_element) {
  const std::string& key = words[0];
  const std::size_t n = words.size();
  if (key == "comment" || key == "obj_info") return true;
  if (key == "format")
    return n == 3 && words[2] == "1.0" &&
           (words[1] == "ascii" || words[1] == "binary_little_endian" || words[1] == "binary_big_endian");
  if (key == "element") return n == 3 && is_count(words[2], file_size);
  if (key != "property" || !has_element) return false;
  if (n == 5) return words[1] == "list" && is_type(words[2]) && is_type(words[3]);
  return n == 3 && is_type(words[1]);
}

}  // namespace

void check_ply_header(const std::filesystem::path& file) {
  const std::uintmax_t size = std::filesystem::file_size(file);
  std::ifstream in(file, std::ios::binary);
  std::string line;
  bool has_format = false, has_element = false;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream split(line);
    Words words;
    for (std::string word; split >> word;) words.push_back(word);
    if (words == Words{"end_header"} && has_format) return;
    const bool is_first = number == 1;
    if (words.empty() || (is_first ? words != Words{"ply"} : !is_sound(words, size, has_element)))
      throw UsageError(file.string() + ":" + std::to_string(number) +
                       ": this line does not belong into the header of a PLY file; export the mesh again.");
    has_format |= words[0] == "format";
    has_element |= words[0] == "element";
  }
  throw UsageError(file.string() + ": the header of this PLY file does not end; export the mesh again.");
}

}  // namespace pvg
