// Tests the functions that write numbers as text, for reports and for JSON.

#include "core/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

namespace chronormal::text_test {
namespace {

TEST(Text, counts_have_groups_of_three_and_the_right_word) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(counted(1, "face", "faces"), "1 face");
  EXPECT_EQ(counted(0, "face", "faces"), "0 faces");
  EXPECT_EQ(counted(2000, "vertex", "vertices"), "2,000 vertices");
  EXPECT_EQ(counted(std::uint64_t{1} << 40, "byte", "bytes"), "1,099,511,627,776 bytes");
  EXPECT_EQ(with_degrees("1"), "1 degree");
  EXPECT_EQ(with_degrees("0.1"), "0.1 degrees");
  EXPECT_EQ(with_degrees("1.00"), "1.00 degrees");
}

TEST(Text, numbers_have_the_digits_that_are_asked_for) {
  EXPECT_EQ(with_decimals(0.5, 4), "0.5000");
  EXPECT_EQ(with_decimals(-2.00005, 2), "-2.00");
  EXPECT_EQ(with_decimals(1e300, 0).size(), 301u);
  EXPECT_EQ(with_digits(1.25, 4), "1.25");
  EXPECT_EQ(with_digits(0.000012345, 3), "1.23e-05");
  EXPECT_EQ(with_decimals(std::numeric_limits<double>::infinity(), 2), "-");
  EXPECT_EQ(with_digits(std::numeric_limits<double>::quiet_NaN(), 2), "-");
}

TEST(Text, numbers_in_messages_have_no_long_fractions_but_differ_where_they_are_not_the_same) {
  EXPECT_EQ(rounded_text(0.1 + 0.2), "0.3");
  EXPECT_EQ(rounded_text(1.0 / 3), "0.333333");
  EXPECT_EQ(rounded_text(-24), "-24");
  EXPECT_EQ(rounded_text(1234567), "1234567");
  EXPECT_EQ(rounded_text(0.1 + 0.2, {0.3}), "0.30000000000000004");
  EXPECT_EQ(rounded_text(0.3, {0.1 + 0.2}), "0.3");
  EXPECT_EQ(rounded_text(std::numeric_limits<double>::infinity()), "inf");
  std::mt19937 random(50);
  SCOPED_TRACE("seed 50");
  for (int round = 0; round < 10000; ++round) {
    // The numbers are integers of up to five digits, divided by a power of ten, as people write numbers. The test then
    // changes the last bits, as the rounding errors of a computation do.
    const std::string written = std::to_string(random() % 100000) + "e-" + std::to_string(random() % 5);
    const double meant = std::stod(written);
    double found = meant;
    for (std::size_t steps = random() % 4; steps > 0; --steps) found = std::nextafter(found, 1e9);
    EXPECT_EQ(std::stod(rounded_text(found)), meant) << written;
    EXPECT_LE(rounded_text(found).size(), 8U) << written;
    const double other = std::nextafter(found, -1e9);
    EXPECT_NE(rounded_text(found, {other}), rounded_text(other, {found})) << written;
  }
}

TEST(Text, long_names_are_cut_between_characters) {
  EXPECT_EQ(printable("abcdef", 6), "abcdef");
  EXPECT_EQ(printable("abcdefg", 6), "abc...");
  EXPECT_EQ(printable("\xc3\xa4\xc3\xb6\xc3\xbc\xc3\x9f", 4), "\xc3\xa4\xc3\xb6\xc3\xbc\xc3\x9f");
  EXPECT_EQ(printable("\xc3\xa4\xc3\xb6\xc3\xbc\xc3\x9f!", 4), "\xc3\xa4...");
  EXPECT_EQ(printable("a\x1b\xff", 20), "a\\x1b\\xff");
  EXPECT_EQ(escaped_for_json("\"\xe2\x80\xae\x7f\""), "\"\\u202e\\u007f\"");
}

}  // namespace
}  // namespace chronormal::text_test
