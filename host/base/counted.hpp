// A number with its noun, in the singular where there is one: "1 episode", "2 episodes", "0 vertices".
#pragma once
#include <cstdint>
#include <string>

namespace pvg {

// many: the plural where it is not the noun with an s
inline std::string counted(std::uint64_t n, const std::string& one, const std::string& many = "") {
  return std::to_string(n) + " " + (n == 1 ? one : many.empty() ? one + "s" : many);
}

}  // namespace pvg
