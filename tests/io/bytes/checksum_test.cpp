// Checks that checksums have their published values, and change if the data change.
#include "io/bytes/checksum.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace chronormal::checksum_test {
namespace {

TEST(Checksum, is_the_crc_32_of_zip_files) {
  EXPECT_EQ(checksum_of("123456789"), 0xCBF43926U);
  EXPECT_EQ(checksum_of("6789", checksum_of("12345")), 0xCBF43926U);
  EXPECT_EQ(checked_line("123456789"), "cbf43926 123456789\n");
  EXPECT_EQ(text_of_checked("cbf43926 123456789"), "123456789");
  EXPECT_EQ(text_of_checked("cbf43926 12345678"), std::nullopt);
  EXPECT_EQ(text_of_checked("cbf43926"), std::nullopt);
}

TEST(Checksum, numbers_count_as_little_endian_bytes_and_lists_with_their_length) {
  NumberChecksum number, list, other;
  number.add(std::uint64_t{0x0807060504030201});
  EXPECT_EQ(number.value(), checksum_of("\1\2\3\4\5\6\7\10"));
  const std::vector<float> one = {1, 2, 3};
  list.add(std::span(one).first(1));
  list.add(std::span(one).subspan(1));
  other.add(std::span(one).first(2));
  other.add(std::span(one).subspan(2));
  EXPECT_NE(list.value(), other.value());
}

TEST(Checksum, an_object_with_its_checksum_is_one_and_no_byte_of_it_can_be_another) {
  const std::string text = with_checksum(R"({"a":1})");
  EXPECT_TRUE(text.starts_with(R"({"a":1,"checksum":")")) << text;
  EXPECT_TRUE(has_its_checksum(text));
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = text;
      changed[i] = static_cast<char>(changed[i] ^ (1 << bit));
      EXPECT_FALSE(has_its_checksum(changed)) << changed;
    }
    EXPECT_FALSE(has_its_checksum(text.substr(0, i)));
    EXPECT_FALSE(has_its_checksum(text.substr(i + 1)));
  }
  EXPECT_FALSE(has_its_checksum(text + "\n"));
}

}  // namespace
}  // namespace chronormal::checksum_test
