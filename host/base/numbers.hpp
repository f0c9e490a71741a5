// Numbers and names in texts that people write: the one parser of the command line.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pvg {

// The whole of `text` must be a decimal number, finite and from low to high. Throws std::invalid_argument with the end
// of a sentence: "must be a whole number from 1 to 5, but is `nan`".
std::uint64_t parse_whole(const std::string& text, std::uint64_t low, std::uint64_t high);
double parse_real(const std::string& text, double low, double high);

// Names that may become names of files: 1 to 64 of A-Z, a-z, 0-9, _ and -.
bool is_identifier(const std::string& text);
inline constexpr const char* IDENTIFIER_RULE = "must be a name of 1 to 64 letters, digits, _ or -, for it names files";

// The word that differs from `given` in the fewest letters (put in, left out, replaced, swapped); empty: none is near.
std::string nearest_word(const std::string& given, const std::vector<std::string>& words);

}  // namespace pvg
