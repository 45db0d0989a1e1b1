// Checks that PC2 files are read back as they were written, and that invalid files are refused with the place of the
// fault.
#include "io/cache/pc2.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <string>

#include "tests/support/cache_bytes.h"
#include "tests/support/random_motion.h"
#include "tests/support/written.h"

namespace chronormal::pc2_test {
namespace {

std::string error_of(const std::string& bytes) {
  const Result<PositionCache> result = read_pc2(bytes, "walk.pc2");
  EXPECT_FALSE(result.ok());
  return result ? "" : result.error().text();
}

std::string patched(std::size_t at, const std::string& raw) {
  return test::small_pc2(40, 2).replace(at, raw.size(), raw);
}

TEST(ReadPc2, reads_positions_and_frames_as_seconds) {
  const Result<PositionCache> cache = read_pc2(test::small_pc2(40, 2), "walk.pc2", {24, 0, ""});
  ASSERT_TRUE(cache.ok()) << cache.error().text();
  EXPECT_EQ(cache.value().vertex_count, 3U);
  ASSERT_EQ(cache.value().samples.size(), 2U);
  EXPECT_EQ(cache.value().samples[0].time, 40.0 / 24);
  EXPECT_EQ(cache.value().samples[1].time, 42.0 / 24);
  EXPECT_EQ(cache.value().samples[0].positions, test::kTurning[0]);
  EXPECT_EQ(cache.value().samples[1].positions, test::kTurning[1]);
}

TEST(ReadPc2, errors_say_where_and_what) {
  using std::string_literals::operator""s;
  EXPECT_EQ(error_of("POINTCACHE3"),
            "walk.pc2, byte 0: this is not a PC2 file, since it does not begin with POINTCACHE2; name a .pc2 file");
  EXPECT_EQ(error_of(patched(12, "\2")),
            "walk.pc2, byte 12: version 2 of PC2 cannot be read; export the file as version 1");
  EXPECT_EQ(error_of(patched(20, "\0\0\xC0\x7F"s)),
            "walk.pc2, byte 20: the start frame is NaN or infinite; export the file again");
  for (const std::string& step : {"\0\0\0\0"s, "\0\0\x80\xBF"s, "\0\0\x80\x7F"s})
    EXPECT_EQ(
        error_of(patched(24, step)),
        "walk.pc2, byte 24: the number of frames between two samples must be greater than 0; export the file again");
  EXPECT_EQ(error_of(patched(16, "\0"s)),
            "walk.pc2, byte 32: the number of vertices is 0 and the number of samples is 2, but both must be at least "
            "1; export the file again");
  EXPECT_EQ(error_of(patched(28, "\xFF\xFF\xFF\xFF")),
            "walk.pc2, byte 32: the number of vertices is 3 and the number of samples is -1, but both must be at least "
            "1; export the file again");
  EXPECT_EQ(
      error_of(patched(28, "\xFF\xFF\xFF\x7F")),
      "walk.pc2, byte 32: the file is too short for the 2,147,483,647 samples of 3 vertices in its header; copy or "
      "export it again");
  EXPECT_EQ(
      error_of(test::small_pc2(0, 1) + "x"),
      "walk.pc2, byte 32: the file is too long for the 2 samples of 3 vertices in its header; copy or export it again");
  EXPECT_EQ(error_of(patched(32 + 4 * 13, "\0\0\x80\xFF"s)),
            "walk.pc2, byte 84, sample 1, vertex 1: the coordinate is NaN or infinite; export the file again");
}

TEST(WritePc2, writes_the_bytes_that_were_made_by_hand) {
  EXPECT_EQ(test::written(test::turning_motion(40, 42), ".pc2").value(), test::small_pc2(40, 2));
  EXPECT_EQ(pc2_header(test::turning_motion(2, 2.5), 24).value(), test::small_pc2(48, 12).substr(0, 32));
}

RC_GTEST_PROP(WritePc2, what_was_written_reads_back_bit_for_bit, ()) {
  const Motion motion = test::random_motion(true);
  const Result<std::string> bytes = test::written(motion, ".pc2");
  RC_ASSERT(bytes.ok());
  const Result<PositionCache> back = read_pc2(bytes.value(), "back.pc2");
  RC_ASSERT(back.ok());
  RC_ASSERT(back.value().samples.size() == motion.keyframes.size());
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    RC_ASSERT(back.value().samples[k].time == motion.keyframes[k].time);
    RC_ASSERT(test::same_bits(back.value().samples[k].positions, motion.keyframes[k].positions));
  }
}

TEST(WritePc2, refuses_what_the_format_can_not_hold) {
  Motion motion = test::turning_motion(0, 1);
  motion.keyframes.push_back({test::kTurning[0], 2.5, "c"});
  motion.connect_as_sequence();
  Result<std::string> bytes = test::written(motion, ".pc2");
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().code, ErrorCode::kUsage);
  EXPECT_NE(bytes.error().message.find("keyframe 1 is earlier or later than that"), std::string::npos)
      << bytes.error().message;
  motion.connect_as_targets();
  bytes = test::written(motion, ".pc2");
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace chronormal::pc2_test
