#include "host/robot/xml_text.hpp"

#include <algorithm>
#include <utility>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr int DEEPEST = 1000;
constexpr std::size_t LONGEST_CHARACTER = 4;  // [byte] of UTF-8

}  // namespace

// Counts `<name` up, `</` and `/>` down. Text in quotes or comments may count, too: it would take a thousand unclosed
// elements there.
void check_xml_depth(const std::string& text, const std::string& name) {
  int depth = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    const char c = text[i], next = text[i + 1];
    if ((c == '<' && next == '/') || (c == '/' && next == '>'))
      depth = std::max(0, depth - 1);
    else if (c == '<' && next != '!' && next != '?' && ++depth > DEEPEST)
      throw UsageError(name + ": more than a thousand elements lie in each other; this is no sound XML file.");
  }
}

std::string xml_with_end(std::string text) { return std::move(text) + std::string(LONGEST_CHARACTER, '\0'); }

}  // namespace pvg
