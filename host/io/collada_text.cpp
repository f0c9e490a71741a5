#include "host/io/collada_text.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "host/base/error.hpp"
#include "host/io/xml_depth.hpp"

namespace pvg {
namespace {

using std::string_view;

bool is_numbers(string_view content) {
  return content.find_first_not_of("0123456789+-. \t\r\neE") == string_view::npos;
}

// every count="..." and stride="..." of a tag is a number up to `most`
bool has_sound_counts(string_view tag, std::size_t most) {
  for (const string_view name : {"count", "stride", "offset"})
    for (std::size_t at = tag.find(name); at != string_view::npos; at = tag.find(name, at + 1)) {
      const std::size_t begin = tag.find_first_of("\"'", at);
      if (begin == string_view::npos) return false;
      const string_view text = tag.substr(begin + 1);
      std::size_t value = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      const bool is_closed = end != text.data() + text.size() && *end == tag[begin];
      if (error != std::errc() || !is_closed || value > most) return false;
    }
  return true;
}

}  // namespace

void check_collada_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  check_xml_depth(text, file.string());
  for (std::size_t begin = text.find('<'); begin != std::string::npos; begin = text.find('<', begin + 1)) {
    const std::size_t end = std::min(text.find('>', begin), text.size());
    const string_view tag = string_view(text).substr(begin + 1, end - begin - 1);
    const string_view name = tag.substr(0, tag.find_first_of(" \t\r\n/"));
    if (name != "p" && name != "vcount" && name != "float_array" && name != "accessor" && name != "input" &&
        name != "triangles" && name != "polylist" && name != "polygons")
      continue;
    const string_view content = string_view(text).substr(std::min(end + 1, text.size()));
    const bool holds_numbers = name == "p" || name == "vcount" || name == "float_array";
    if (!has_sound_counts(tag, text.size()) || (holds_numbers && !is_numbers(content.substr(0, content.find('<')))))
      throw UsageError(file.string() + ": <" + std::string(name) +
                       "> holds what is no number, or counts more than the file can hold; export the mesh again.");
  }
}

}  // namespace pvg
