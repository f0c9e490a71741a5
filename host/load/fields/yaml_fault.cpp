#include "host/load/fields/yaml_fault.hpp"

#include <yaml-cpp/exceptions.h>

#include <algorithm>
#include <iterator>

namespace pvg {
namespace {

struct Fault {
  const char* reason;  // how yaml-cpp's words begin
  const char* sentence;
};

constexpr const char* INDENTATION =
    "a line is indented otherwise than its neighbours, or lacks its colon or its dash; keys of one mapping begin in "
    "the "
    "same column";
constexpr const char* OPEN_BRACE = "a brace { is not closed, or a comma is missing before this line";
constexpr const char* OPEN_BRACKET = "a bracket [ is not closed, or a comma is missing before this line";
constexpr const char* LONE_SIGN =
    "a value begins with a sign that YAML reserves (* & ! % @ `); put the value in quotes";
constexpr const char* MARKED_TWICE = "a value has two anchors, tags or aliases; keep one of them";

namespace words = YAML::ErrorMsg;
const Fault FAULTS[] = {
    {words::MAP_VALUE,
     "a colon stands where none may; one key per line, all keys of a mapping in the same column, and quotes around "
     "text "
     "that holds a colon and a blank"},
    {words::MAP_KEY, "a key stands where none may; each begins its own line, in the column of its neighbours"},
    {words::BLOCK_ENTRY, "a dash stands where none may; each entry of a list begins its own line, in one column"},
    {words::END_OF_MAP_FLOW, OPEN_BRACE},
    {words::END_OF_SEQ_FLOW, OPEN_BRACKET},
    {words::END_OF_MAP, INDENTATION},
    {words::END_OF_SEQ, INDENTATION},
    {words::FLOW_END, "a bracket ] or brace } closes nothing that is open"},
    {words::EOF_IN_SCALAR, "a quote is opened and not closed before the end of the file"},
    {words::DOC_IN_SCALAR, "a quote is opened and not closed before a line of --- or ..."},
    {words::CHAR_IN_SCALAR, LONE_SIGN},
    {words::TAB_IN_INDENTATION, "a line is indented by a tab; YAML takes blanks alone"},
    {words::INVALID_ESCAPE,
     "a backslash in double quotes stands before a letter that it does not go with; use single "
     "quotes, or two backslashes"},
    {words::INVALID_HEX, "\\x, \\u or \\U in double quotes is not followed by its hexadecimal digits"},
    {words::INVALID_UNICODE, "\\u or \\U in double quotes names no letter"},
    {words::UNKNOWN_TOKEN, LONE_SIGN},
    {words::ALIAS_NOT_FOUND, LONE_SIGN},
    {words::ANCHOR_NOT_FOUND, LONE_SIGN},
    {words::CHAR_IN_ALIAS, LONE_SIGN},
    {words::CHAR_IN_ANCHOR, LONE_SIGN},
    {words::CHAR_IN_TAG_HANDLE, LONE_SIGN},
    {words::TAG_WITH_NO_SUFFIX, LONE_SIGN},
    {words::END_OF_VERBATIM_TAG, LONE_SIGN},
    {words::UNKNOWN_ANCHOR,
     "an alias (*name) stands before its anchor (&name), or has none; put text that begins with "
     "* in quotes"},
    {words::ZERO_INDENT_IN_BLOCK, "text behind | or > must be indented by a blank at least"},
    {words::CHAR_IN_BLOCK, "nothing may follow | or > in its line; the text begins in the next"},
    {words::MULTIPLE_TAGS, MARKED_TWICE},
    {words::MULTIPLE_ANCHORS, MARKED_TWICE},
    {words::MULTIPLE_ALIASES, MARKED_TWICE},
    {words::ALIAS_CONTENT, MARKED_TWICE},
};

}  // namespace

std::string yaml_fault(const std::string& reason, const std::string& line) {
  if (reason == words::BAD_FILE) return "it is nested too deeply";  // as yaml-cpp says of that
  const std::string indentation = line.substr(0, line.find_first_not_of(" \t"));
  // yaml-cpp blames what stands behind the tab
  const std::string begin = indentation.find('\t') == std::string::npos ? reason : words::TAB_IN_INDENTATION;
  const auto fault =
      std::find_if(std::begin(FAULTS), std::end(FAULTS), [&](const Fault& f) { return begin.starts_with(f.reason); });
  return fault == std::end(FAULTS) ? reason : std::string(fault->sentence) + " (in YAML's words: " + reason + ")";
}

}  // namespace pvg
