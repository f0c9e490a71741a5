#include "host/formats/xml_depth.hpp"

#include <algorithm>

#include "host/base/error.hpp"

namespace pvg {
namespace {

constexpr int DEEPEST = 1000;

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

}  // namespace pvg
