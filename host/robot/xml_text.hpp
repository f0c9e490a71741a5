// What the text of an XML file must be before TinyXML reads it.
#pragma once
#include <string>

namespace pvg {

// UsageError, which names `name`, where more than a thousand elements lie in each other: TinyXML calls itself for each
// level and runs out of stack.
void check_xml_depth(const std::string& text, const std::string& name);

// The text with zeros behind it. TinyXML takes a character to be as long as its first byte says, up to four bytes, and
// where a file ends within one it reads past the end.
std::string xml_with_end(std::string text);

}  // namespace pvg
