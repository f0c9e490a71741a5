#include "host/base/numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace pvg {
namespace {

constexpr std::size_t LONGEST_IDENTIFIER = 64;

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string range_of(const std::string& low, const std::string& high, bool is_bounded) {
  return is_bounded ? "from " + low + " to " + high : "of at least " + low;
}

// Damerau's distance, of texts of a few letters
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

}  // namespace

std::uint64_t parse_whole(const std::string& text, std::uint64_t low, std::uint64_t high) {
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || text.empty() || value < low || value > high)
    throw std::invalid_argument("must be a whole number " +
                                range_of(std::to_string(low), std::to_string(high),
                                         high < UINT64_MAX || error == std::errc::result_out_of_range) +
                                ", but is `" + text + "`");
  return value;
}

double parse_real(const std::string& text, double low, double high) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || text.empty() || !std::isfinite(value) || value < low || value > high)
    throw std::invalid_argument("must be a number " + range_of(shown(low), shown(high), std::isfinite(high)) +
                                ", but is `" + text + "`");
  return value;
}

bool is_identifier(const std::string& text) {
  const auto may_stand = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !text.empty() && text.size() <= LONGEST_IDENTIFIER && std::all_of(text.begin(), text.end(), may_stand);
}

std::string nearest_word(const std::string& given, const std::vector<std::string>& words) {
  std::string small = given.substr(0, LONGEST_IDENTIFIER), nearest;
  std::transform(small.begin(), small.end(), small.begin(), lower);
  std::size_t least = 1 + std::max<std::size_t>(2, small.size() / 3);
  for (const std::string& word : words) {
    const std::size_t d = distance(small, word);
    if (d < least) least = d, nearest = word;
  }
  return nearest;
}

}  // namespace pvg
