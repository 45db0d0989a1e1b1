// Tests MotionStream: which keyframes it holds in memory, how many times it reads each keyframe, and how it reports
// errors of the reader.
#include "chronormal/motion/motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace chronormal::motion_stream_test {
namespace {

// Makes the outline of a motion with one triangle, without positions. In the source, all coordinates of a keyframe are
// the number of the keyframe.
Motion outline_of(std::size_t keyframes) {
  Motion outline;
  outline.topology = Topology::triangles(3, {0, 1, 2}).value();
  for (std::size_t k = 0; k < keyframes; ++k) outline.keyframes.push_back({{}, static_cast<double>(k), "file"});
  outline.connect_as_sequence();
  return outline;
}

struct Source {
  std::atomic<std::size_t> reads = 0;
  std::atomic<std::size_t> at_once = 0;
  std::atomic<bool> overlaps = false;

  MotionStream stream(std::size_t keyframes, std::size_t kept) {
    return MotionStream(
        outline_of(keyframes),
        [this](const Motion&, std::size_t k, std::span<float> positions) -> Status {
          if (++at_once > 1) overlaps = true;
          ++reads;
          std::fill(positions.begin(), positions.end(), static_cast<float>(k));
          --at_once;
          if (k == 13) return invalid_input("frame 13", "unlucky");
          return Success{};
        },
        kept);
  }
};

std::size_t held(const MotionStream& stream) {
  const auto& keyframes = stream.motion().keyframes;
  return static_cast<std::size_t>(std::count_if(keyframes.begin(), keyframes.end(),
                                                [](const auto& keyframe) { return !keyframe.positions.empty(); }));
}

TEST(MotionStream, holds_no_more_than_was_asked_for) {
  Source source;
  MotionStream stream = source.stream(12, 0);
  EXPECT_EQ(held(stream), 0U);
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t s = 0; s < 11; ++s) {
      ASSERT_TRUE(stream.hold_segment(s).ok());
      EXPECT_EQ(held(stream), 2U);
      EXPECT_EQ(stream.motion().segment(s).from[0].x, static_cast<float>(s));
      EXPECT_EQ(stream.motion().segment(s).to[2].z, static_cast<float>(s + 1));
    }
  }
  EXPECT_EQ(source.reads, 24U);  // each of the two passes reads every keyframe once
  EXPECT_FALSE(source.overlaps);
}

TEST(MotionStream, any_order_of_keyframes_gives_the_right_ones) {
  Source source;
  MotionStream stream = source.stream(12, 0);
  for (const std::size_t first : {7U, 8U, 9U, 2U, 9U, 10U, 3U, 4U, 5U, 5U, 0U}) {
    ASSERT_TRUE(stream.hold(first, first + 1).ok());
    for (const std::size_t k : {first, first + 1}) {
      ASSERT_EQ(stream.motion().keyframes[k].positions.size(), 9U) << k;
      EXPECT_EQ(stream.motion().keyframes[k].positions[4], static_cast<float>(k));
    }
    EXPECT_EQ(held(stream), 2U);
  }
}

TEST(MotionStream, a_watcher_is_told_of_what_is_there_and_of_all_that_is_read) {
  for (const std::size_t kept : {std::size_t{0}, MotionStream::kUsuallyKept}) {
    Source source;
    MotionStream stream = source.stream(12, kept);
    ASSERT_TRUE(stream.hold(2, 3).ok());
    ASSERT_TRUE(stream.hold(3, 4).ok());  // also reads keyframe 5 in advance
    std::mutex mutex;
    std::vector<int> told(12);
    const auto count = [&](std::size_t k, std::span<const float> positions) -> Status {
      const std::lock_guard lock(mutex);
      EXPECT_EQ(positions[8], static_cast<float>(k));
      ++told[k];
      if (k == 7) return invalid_input("frame 7", "odd");
      return Success{};
    };
    ASSERT_TRUE(stream.watch(count).ok());
    EXPECT_EQ(told, kept == 0 ? (std::vector{0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0})
                              : (std::vector{0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0}));
    ASSERT_TRUE(stream.hold(5, 6).ok());
    EXPECT_EQ(stream.hold(6, 7).error().text(), "frame 7: odd");
    ASSERT_TRUE(stream.watch({}).ok());
    const std::vector<int> before = told;
    EXPECT_EQ(before[5] + before[6] + before[7], 3);
    ASSERT_TRUE(stream.hold(6, 7).ok());
    EXPECT_EQ(told, before);
    Motion whole = outline_of(9);
    for (std::size_t k = 0; k < 9; ++k) whole.keyframes[k].positions.assign(9, static_cast<float>(k));
    EXPECT_EQ(MotionStream(whole).watch(count).error().place, "frame 7");
    whole.keyframes.resize(7);
    EXPECT_TRUE(MotionStream(whole).watch(count).ok());
    EXPECT_EQ(told[0], 2);
  }
}

TEST(MotionStream, a_small_motion_is_read_once_and_stays) {
  Source source;
  MotionStream stream = source.stream(12, 12 * 9 * sizeof(float));
  for (int pass = 0; pass < 3; ++pass)
    for (std::size_t s = 0; s < 11; ++s) ASSERT_TRUE(stream.hold_segment(s).ok());
  EXPECT_EQ(source.reads, 12U);
  EXPECT_EQ(held(stream), 12U);
}

TEST(MotionStream, one_keyframe_alone_reads_nothing_else) {
  Source source;
  MotionStream stream = source.stream(12, 0);
  ASSERT_TRUE(stream.hold_segment(6).ok());
  EXPECT_EQ(source.reads, 2U);
}

TEST(MotionStream, an_error_comes_with_the_keyframe_that_has_it_and_the_others_stay_readable) {
  Source source;
  MotionStream stream = source.stream(20, 0);
  for (std::size_t s = 8; s < 12; ++s) ASSERT_TRUE(stream.hold_segment(s).ok());  // also reads keyframe 13 in advance
  const Status status = stream.hold_segment(12);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().text(), "frame 13: unlucky");
  EXPECT_FALSE(stream.hold_segment(13).ok());
  ASSERT_TRUE(stream.hold_segment(14).ok());
  EXPECT_EQ(stream.motion().segment(14).to[0].y, 15);
  EXPECT_EQ(held(stream), 2U);
  EXPECT_FALSE(stream.hold_all().ok());
}

TEST(MotionStream, a_motion_in_memory_is_never_copied_nor_given_back) {
  Motion motion = outline_of(3);
  for (auto& keyframe : motion.keyframes) keyframe.positions.assign(9, 1);
  MotionStream stream(motion);
  ASSERT_TRUE(stream.hold_segment(1).ok());
  EXPECT_EQ(&stream.motion(), &motion);
  EXPECT_EQ(held(stream), 3U);
}

}  // namespace
}  // namespace chronormal::motion_stream_test
