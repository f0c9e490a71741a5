// The one parser of numbers and names that people write.
#include "host/base/numbers.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace pvg {
namespace {

constexpr std::uint64_t ALL = std::numeric_limits<std::uint64_t>::max();

TEST(Numbers, WholeNumbersAreDecimalAndInRange) {
  EXPECT_EQ(parse_whole("0", 0, 5), 0u);
  EXPECT_EQ(parse_whole("18446744073709551615", 0, ALL), ALL);
  for (const char* text : {"", " 1", "1 ", "-1", "+1", "0x1", "1.5", "1e3", "nan", "inf", "18446744073709551616", "6"})
    EXPECT_THROW(parse_whole(text, 0, text == std::string("6") ? 5 : ALL), std::invalid_argument) << text;
}

TEST(Numbers, RealNumbersAreFiniteAndInRange) {
  EXPECT_EQ(parse_real("1.5e-3", 0, 1), 1.5e-3);
  for (const char* text : {"", "nan", "inf", "-inf", "1e999", "0x1p3", "1,5", "1 m", "2", "-0.1"})
    EXPECT_THROW(parse_real(text, 0, 1), std::invalid_argument) << text;
}

TEST(Numbers, ASentenceNamesTheRangeAndWhatWasGiven) {
  try {
    parse_whole("nan", 1, 5);
    FAIL() << "nothing was thrown";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "must be a whole number from 1 to 5, but is `nan`");
  }
  try {
    parse_whole("18446744073709551616", 0, ALL);
    FAIL() << "nothing was thrown";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "must be a whole number from 0 to 18446744073709551615, but is `18446744073709551616`");
  }
}

TEST(Numbers, AnIdentifierCannotLeaveAFolder) {
  for (const char* text : {"a", "front_2", "Left-Arm", "0", "-"}) EXPECT_TRUE(is_identifier(text)) << text;
  EXPECT_TRUE(is_identifier(std::string(64, 'n')));
  for (const char* text : {"", ".", "..", "a/b", "../a", "a b", "a.b", "ü", "a\n", "*"})
    EXPECT_FALSE(is_identifier(text)) << text;
  EXPECT_FALSE(is_identifier(std::string(65, 'n')));
}

TEST(Numbers, TheNearestWordForgivesASlip) {
  const std::vector<std::string> words = {"generate", "validate", "view", "devices"};
  EXPECT_EQ(nearest_word("generat", words), "generate");
  EXPECT_EQ(nearest_word("Generate", words), "generate");
  EXPECT_EQ(nearest_word("veiw", words), "view");
  EXPECT_EQ(nearest_word("device", words), "devices");
  EXPECT_EQ(nearest_word("spaghetti-monster", words), "");
}

}  // namespace
}  // namespace pvg
