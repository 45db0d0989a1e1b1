// Checks that MDD files are read back as they were written, and that invalid files are refused with the place of the
// fault.
#include "io/cache/mdd.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>

#include "tests/support/cache_bytes.h"
#include "tests/support/random_motion.h"
#include "tests/support/written.h"

namespace chronormal::mdd_test {
namespace {

using std::string_literals::operator""s;

std::string error_of(const std::string& bytes) {
  const Result<PositionCache> result = read_mdd(bytes, "walk.mdd");
  EXPECT_FALSE(result.ok());
  return result ? "" : result.error().text();
}

TEST(ReadMdd, reads_positions_and_seconds) {
  const Result<PositionCache> cache = read_mdd(test::small_mdd(-1, 0.5F), "walk.mdd", {24, 0, ""});
  ASSERT_TRUE(cache.ok()) << cache.error().text();
  EXPECT_EQ(cache.value().vertex_count, 3U);
  ASSERT_EQ(cache.value().samples.size(), 2U);
  EXPECT_EQ(cache.value().samples[0].time, -1);
  EXPECT_EQ(cache.value().samples[1].time, 0.5);
  EXPECT_EQ(cache.value().samples[0].positions, test::kTurning[0]);
  EXPECT_EQ(cache.value().samples[1].positions, test::kTurning[1]);
}

TEST(ReadMdd, errors_say_where_and_what) {
  const auto patched = [](std::size_t at, const std::string& raw) {
    return test::small_mdd(0, 1).replace(at, raw.size(), raw);
  };
  EXPECT_EQ(error_of("abc"),
            "walk.mdd, byte 3: the file is cut off inside its header of 8 bytes; copy or export it again");
  EXPECT_EQ(error_of(patched(4, "\x80\0\0\0"s)),
            "walk.mdd, byte 8: the number of vertices is -2147483648 and the number of samples is 2, but both must be "
            "at least 1; export the file again");
  EXPECT_EQ(
      error_of(patched(4, "\x7F\xFF\xFF\xFF")),
      "walk.mdd, byte 8: the file is too short for the 2 samples of 2,147,483,647 vertices in its header; copy or "
      "export it again");
  EXPECT_EQ(
      error_of(test::small_mdd(0, 1) + "xxxx"),
      "walk.mdd, byte 8: the file is too long for the 2 samples of 3 vertices in its header; copy or export it again");
  // To find the positions, the reader needs only the start of a file, up to the last time.
  const auto layout = [](std::size_t count) {
    const std::string bytes = test::small_mdd(0, 1);
    return find_mdd_layout(std::string_view(bytes).substr(0, count), bytes.size(), "walk.mdd", {});
  };
  EXPECT_TRUE(layout(16).ok());
  EXPECT_EQ(layout(15).error().text(),
            "walk.mdd, byte 15: the file is cut off inside the times of its samples; copy or export it again");
  EXPECT_EQ(error_of(patched(12, "\x7F\x80\0\0"s)),
            "walk.mdd, byte 12, sample 1: the time is NaN or infinite; times must be finite numbers");
  EXPECT_EQ(error_of(patched(20, "\xFF\xC0\0\0"s)),
            "walk.mdd, byte 20, sample 0, vertex 0: the coordinate is NaN or infinite; export the file again");
}

TEST(WriteMdd, writes_the_bytes_that_were_made_by_hand) {
  EXPECT_EQ(test::written(test::turning_motion(-1, 0.5), ".mdd").value(), test::small_mdd(-1, 0.5F));
}

RC_GTEST_PROP(WriteMdd, what_was_written_reads_back_bit_for_bit, ()) {
  const Motion motion = test::random_motion(false);
  const Result<std::string> bytes = test::written(motion, ".mdd");
  RC_ASSERT(bytes.ok());
  const Result<PositionCache> back = read_mdd(bytes.value(), "back.mdd");
  RC_ASSERT(back.ok());
  RC_ASSERT(back.value().samples.size() == motion.keyframes.size());
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    RC_ASSERT(back.value().samples[k].time == motion.keyframes[k].time);
    RC_ASSERT(test::same_bits(back.value().samples[k].positions, motion.keyframes[k].positions));
  }
}

TEST(WriteMdd, refuses_times_that_float32_can_not_tell_apart) {
  const Result<std::string> bytes = mdd_header(test::turning_motion(1, 1 + 1e-9));
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace chronormal::mdd_test
