// How far paths bend, keyframe by keyframe, and which keyframes a path follows from.
#include "normals/curves/path_stream.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace chronormal::path_stream_test {
namespace {

// A triangle, of which one vertex goes up to a height at each time.
Motion climbing(const std::vector<std::pair<double, float>>& heights) {
  Motion motion;
  const std::vector<std::uint32_t> corners = {0, 1, 2};
  motion.topology = Topology::triangles(3, corners).value();
  for (const auto& [time, height] : heights) motion.keyframes.push_back({{0, 0, 0, 1, 0, 0, 0, 1, height}, time, ""});
  motion.connect_as_sequence();
  return motion;
}

TEST(BendAt, is_the_share_of_the_keyframe_that_ends_a_segment) {
  const Motion motion = climbing({{0, 0.0F}, {1, 1.0F}, {2, 4.0F}, {4, 4.0F}, {5, 4.0F}});
  // The vertex is at 1 where the straight line to 4 has 2; at 4 where that from 1 to 4 has 2; and it rests at last.
  EXPECT_EQ(bend_at(motion, 0).way, 0);
  EXPECT_EQ(bend_at(motion, 1).bent, 2.0 * 1);
  EXPECT_EQ(bend_at(motion, 1).way, 4);
  EXPECT_EQ(bend_at(motion, 2).bent, 2.0 * 2);
  EXPECT_EQ(bend_at(motion, 2).way, 3);
  EXPECT_EQ(bend_at(motion, 3).bent, 0);
  EXPECT_EQ(bend_at(motion, 3).way, 0);
  EXPECT_EQ(bend_at(motion, 4).way, 0);
  EXPECT_EQ(bend_of(motion), 6.0 / 7);
  EXPECT_EQ(bend_of(climbing({{0, 0.0F}, {1, 1.0F}, {2, 0.0F}})), 1);
  EXPECT_EQ(bend_of(climbing({{0, 0.0F}, {1, 1.0F}})), 0);
}

TEST(HoldPaths, holds_what_paths_follow_from_and_nothing_else) {
  const Motion whole = climbing({{0, 0.0F}, {1, 1.0F}, {2, 4.0F}, {3, 4.0F}, {4, 4.0F}, {5, 2.0F}, {6, 1.0F}});
  const auto held = [&](std::size_t first, std::size_t last, PathKind path) {
    Motion outline = whole;
    for (Motion::Keyframe& keyframe : outline.keyframes) keyframe.positions = {};
    MotionStream stream(
        std::move(outline),
        [&](const Motion&, std::size_t k, std::span<float> positions) -> Status {
          std::copy(whole.keyframes[k].positions.begin(), whole.keyframes[k].positions.end(), positions.begin());
          return Success{};
        },
        0);
    EXPECT_TRUE(hold_paths(stream, first, last, path).ok());
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < whole.keyframes.size(); ++k)
      if (!stream.motion().keyframes[k].positions.empty()) found.push_back(k);
    return found;
  };
  using Keys = std::vector<std::size_t>;
  EXPECT_EQ(held(2, 2, PathKind::kLinear), (Keys{2, 3}));
  EXPECT_EQ(held(0, 0, PathKind::kCatmullRom), (Keys{0, 1, 2, 3}));
  EXPECT_EQ(held(2, 2, PathKind::kCatmullRom), (Keys{1, 2, 3, 4}));
  EXPECT_EQ(held(5, 5, PathKind::kCatmullRom), (Keys{3, 4, 5, 6}));
  EXPECT_EQ(held(2, 3, PathKind::kHermite), (Keys{1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace chronormal::path_stream_test
