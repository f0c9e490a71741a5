// XML whose elements lie too deep in each other. The readers of XML call themselves for each level and run out of
// stack.
#pragma once
#include <string>

namespace pvg {

// UsageError, which names `name`, where more than a thousand elements lie in each other.
void check_xml_depth(const std::string& text, const std::string& name);

}  // namespace pvg
