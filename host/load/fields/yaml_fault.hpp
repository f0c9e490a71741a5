// What a file that is no YAML has that it should not, in the words of who writes such files.
#pragma once
#include <string>

namespace pvg {

// reason: yaml-cpp's words, such as "illegal map value". They stand at the end, for who knows YAML's grammar. line: of
// the file, where it was found.
std::string yaml_fault(const std::string& reason, const std::string& line = "");

}  // namespace pvg
