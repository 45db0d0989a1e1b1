#include "io/cache/position_cache.h"

#include <gtest/gtest.h>

#include <limits>
#include <string_view>
#include <utility>

#include "chronormal/motion/motion.h"
#include "tests/support/cache_bytes.h"

namespace chronormal::position_cache_test {
namespace {

PositionCache cache_at(std::vector<double> times) {
  PositionCache cache;
  cache.vertex_count = 3;
  for (const double time : times) cache.samples.push_back({time, test::kTurning[0]});
  return cache;
}

std::string error_of(std::size_t vertices, PositionCache cache) {
  const Result<Motion> motion =
      motion_from_cache(Topology::triangles(vertices, {0, 1, 2}).value(), std::move(cache), "body.obj", "walk.pc2");
  EXPECT_FALSE(motion.ok());
  return motion ? "" : motion.error().text();
}

TEST(MotionFromCache, is_a_sequence_of_all_samples) {
  const Result<Motion> motion =
      motion_from_cache(Topology::triangles(3, {0, 1, 2}).value(), cache_at({-1, 0, 5}), "body.obj", "walk.pc2");
  ASSERT_TRUE(motion.ok()) << motion.error().text();
  EXPECT_TRUE(validate(motion.value()).ok());
  EXPECT_EQ(motion.value().segments.size(), 2U);
  EXPECT_EQ(motion.value().keyframes[2].time, 5);
  EXPECT_EQ(motion.value().keyframes[2].name, "walk.pc2");
  EXPECT_TRUE(check_is_sequence(motion.value()).ok());
}

TEST(MotionFromCache, errors_name_counts_and_samples) {
  EXPECT_EQ(
      error_of(4, cache_at({0, 1})),
      "walk.pc2: the cache has 3 vertices, but the mesh body.obj has 4; give the mesh that the cache was made for");
  EXPECT_EQ(error_of(3, cache_at({0})),
            "walk.pc2: a motion needs at least two samples, but the cache has 1; export more frames");
  EXPECT_EQ(error_of(3, cache_at({0, 1, 1})),
            "walk.pc2, sample 2: the time of this sample, 1 s, is not later than 1 s, the time of sample 1; give each "
            "sample a later time than the one before");
  EXPECT_EQ(error_of(3, cache_at({0, -0.5})),
            "walk.pc2, sample 1: the time of this sample, -0.5 s, is not later than 0 s, the time of sample 0; give "
            "each sample a later time than the one before");
}

TEST(MotionFromCache, refuses_what_is_not_finite_with_the_sample) {
  PositionCache cache = cache_at({0, 1});
  cache.samples[1].positions[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(
      error_of(3, std::move(cache)),
      "walk.pc2, frame 1 (walk.pc2), vertex 1: the position is NaN or infinite; positions must be finite numbers");
}

TEST(MotionFromCache, looks_at_positions_only_where_there_are_some) {
  PositionCache cache = cache_at({0, 1});
  cache.samples[1].positions.clear();
  EXPECT_TRUE(
      motion_from_cache(Topology::triangles(3, {0, 1, 2}).value(), std::move(cache), "body.obj", "walk.pc2").ok());
}

TEST(EachKeyframe, refuses_a_keyframe_of_another_number_of_vertices) {
  Motion motion = test::turning_motion(0, 1);
  std::size_t count = 0;
  const auto count_one = [&count](std::string_view bytes) -> Status {
    EXPECT_EQ(bytes.size(), 3 * 3 * sizeof(float));
    ++count;
    return Success{};
  };
  MotionStream whole(motion);
  EXPECT_TRUE(each_keyframe(whole, std::endian::little, count_one).ok());
  EXPECT_EQ(count, 2U);
  motion.keyframes[1].positions.resize(6);
  MotionStream broken(motion);
  const Status status = each_keyframe(broken, std::endian::little, count_one);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kUsage);
  EXPECT_EQ(status.error().text(), "a keyframe must have three coordinates for each vertex of the mesh");
}

}  // namespace
}  // namespace chronormal::position_cache_test
