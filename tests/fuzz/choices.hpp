// Bytes as choices: what a fuzzer by structure builds its input from. When they are used up all that follows is 0,
// which stands for what is right, so a short input spoils little.
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace pvg {

class Choices {
 public:
  Choices(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}
  std::uint8_t byte() { return at_ < bytes_.size() ? bytes_[at_++] : std::uint8_t(0); }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : byte() % n; }
  bool spoils() { return byte() % 16 == 15; }  // one in sixteen
  // numbers that counts, indices and sizes break on
  std::int64_t whole() {
    static const std::vector<std::int64_t> NUMBERS = {0,
                                                      1,
                                                      -1,
                                                      2,
                                                      7,
                                                      99,
                                                      1000000,
                                                      4000000000,
                                                      1000000000000,
                                                      std::numeric_limits<std::int64_t>::max(),
                                                      std::numeric_limits<std::int64_t>::min()};
    return NUMBERS[below(NUMBERS.size())];
  }
  double real() {
    static const std::vector<double> NUMBERS = {0,
                                                1,
                                                -1,
                                                0.5,
                                                1e9,
                                                -1e9,
                                                1e38,
                                                1e300,
                                                1e-300,
                                                std::numeric_limits<double>::quiet_NaN(),
                                                std::numeric_limits<double>::infinity(),
                                                -std::numeric_limits<double>::infinity()};
    return NUMBERS[below(NUMBERS.size())];
  }
  std::string text() {
    static const std::vector<std::string> TEXTS = {"",
                                                   "a",
                                                   "../../x",
                                                   "a/b",
                                                   ".",
                                                   "..",
                                                   "joint/hinge/position",
                                                   std::string(300, 'n'),
                                                   "\xff\xfe",
                                                   "nan",
                                                   "-1",
                                                   "1e999",
                                                   "{",
                                                   "[",
                                                   "null",
                                                   "true",
                                                   "front",
                                                   "hinge",
                                                   "cube"};
    return TEXTS[below(TEXTS.size())];
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

}  // namespace pvg
