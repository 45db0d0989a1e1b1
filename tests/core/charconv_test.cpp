// Tests conversions between numbers and text: <charconv>, or the function that replaces it, must write the same text as
// the C library, and must read the same number back. The test also runs under Node.js (cmake/bits.cmake), where the
// replacement is used.
#include "core/charconv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace chronormal::charconv_test {
namespace {

// Returns numbers of all magnitudes, including the smallest and the largest.
std::vector<double> numbers() {
  std::vector<double> result = {0.0,
                                -0.0,
                                1.0,
                                -1.0,
                                0.5,
                                100.0,
                                99995.0,
                                1e-5,
                                1.5e-310,
                                3e38,
                                1e22,
                                1e23,
                                std::numeric_limits<double>::max(),
                                std::numeric_limits<double>::denorm_min()};
  std::mt19937_64 random(25);
  while (result.size() < 2000) {
    const double mantissa = static_cast<double>(random() >> 11) * 0x1p-53;
    result.push_back(std::ldexp(mantissa - 0.5, static_cast<int>(random() % 200) - 100));
  }
  return result;
}

template <class... Format>
std::string written(double value, Format... format) {
  char text[512];
  const auto [end, error] = to_chars(text, text + sizeof text, value, format...);
  EXPECT_EQ(error, std::errc());
  return {text, end};
}

std::string printed(const char* format, int precision, double value) {
  char text[512];
  (void)std::snprintf(text, sizeof text, format, precision, value);
  return text;
}

TEST(Charconv, digits_of_each_format_are_those_of_the_c_library) {
  for (const double value : numbers()) {
    for (const int precision : {0, 1, 4, 9, 17}) {
      EXPECT_EQ(written(value, std::chars_format::fixed, precision), printed("%.*f", precision, value));
      EXPECT_EQ(written(value, std::chars_format::scientific, precision), printed("%.*e", precision, value));
      EXPECT_EQ(written(value, std::chars_format::general, precision), printed("%.*g", precision, value));
    }
  }
}

TEST(Charconv, the_shortest_text_reads_back_as_the_same_number) {
  for (const double value : numbers()) {
    const std::string text = written(value);
    double read = 1;
    const auto [end, error] = from_chars(text.data(), text.data() + text.size(), read);
    EXPECT_EQ(end, text.data() + text.size()) << text;
    EXPECT_EQ(std::memcmp(&read, &value, sizeof value), 0) << text;
  }
}

}  // namespace
}  // namespace chronormal::charconv_test
