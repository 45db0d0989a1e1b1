#include "chronormal/motion/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/blend_oracle.h"
#include "tests/support/fixtures.h"

namespace chronormal::blend_set_test {
namespace {

// Makes a set with one triangle, and one vertex that no face uses.
BlendSet small_set() {
  BlendSet set;
  set.topology = fixtures::make_triangles(4, {0, 1, 2});
  set.base = {0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5};
  set.targets = {{"lift", {2}, {0, 1, 0}}, {"shift", {0, 2}, {1, 0, 0, 1, 0, 0}}};
  return set;
}

std::string error_of(const Status& status) { return status ? "none" : status.error().text(); }

TEST(BlendSet, positions_are_the_base_and_the_weighted_deltas_without_rounding_to_float) {
  const BlendSet set = small_set();
  std::vector<double> positions(12);
  blend_positions(set, std::vector{0.1, -2.0}, positions);
  EXPECT_EQ(positions, (std::vector<double>{-2, 0, 0, 1, 0, 0, -2, 1.1, 0, 5, 5, 5}));
  blend_positions(set, std::vector{0.0, 0.0}, positions);
  EXPECT_EQ(positions, (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5}));
}

TEST(BlendSet, infinite_weights_of_other_targets_do_not_reach_a_vertex) {
  std::vector<double> positions(12);
  blend_positions(small_set(), std::vector{std::numeric_limits<double>::infinity(), 0.0}, positions);
  for (std::size_t v : {0U, 1U, 3U}) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(positions[3 * v + k]));
  }
}

TEST(BlendTarget, dense_deltas_keep_what_is_not_zero) {
  const BlendTarget target = BlendTarget::from_dense(std::vector<float>{0, 0, 0, 0, -1, 0, -0.0F, 0, 0, 0, 0, 2}, "a");
  EXPECT_EQ(target.name, "a");
  EXPECT_EQ(target.vertices, (std::vector<std::uint32_t>{1, 3}));
  EXPECT_EQ(target.deltas, (std::vector<float>{0, -1, 0, 0, 0, 2}));
  EXPECT_TRUE(BlendTarget::from_dense({}).vertices.empty());
}

TEST(BlendSet, a_star_of_segments_gives_a_target_for_each) {
  Motion star;
  star.topology = small_set().topology;
  star.keyframes = {{small_set().base, 0, "base"}, {small_set().base, 1, "lift"}, {small_set().base, 1, "still"}};
  star.keyframes[1].positions[7] = 2;
  star.connect_as_targets();
  const Result<BlendSet> set = blend_set_of(star);
  ASSERT_TRUE(set.ok());
  EXPECT_TRUE(validate(set.value()).ok());
  EXPECT_EQ(set.value().base, small_set().base);
  ASSERT_EQ(set.value().targets.size(), 2U);
  EXPECT_EQ(set.value().targets[0].name, "lift");
  EXPECT_EQ(set.value().targets[0].vertices, (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(set.value().targets[0].deltas, (std::vector<float>{0, 1, 0}));
  EXPECT_TRUE(set.value().targets[1].vertices.empty());
  star.segments = {{0, 1}, {1, 2}};
  EXPECT_EQ(blend_set_of(star).error().code, ErrorCode::kUsage);
  star.segments = {{0, 1}};
  star.keyframes[0].positions[0] = 3e38F;
  star.keyframes[1].positions[0] = -3e38F;
  EXPECT_EQ(blend_set_of(star).error().text(),
            "target 0: a delta of the target is too large for float32; scale the mesh down");
}

TEST(BlendSet, valid_sets_pass_whatever_is_empty) {
  EXPECT_TRUE(validate(small_set()).ok());
  EXPECT_TRUE(validate(BlendSet{}).ok());
  BlendSet set = small_set();
  set.targets = {{"", {}, {}}};
  EXPECT_TRUE(validate(set).ok());
  EXPECT_TRUE(validate(test::random_blend_set(1)).ok());
}

TEST(BlendSet, everything_that_is_relied_on_is_checked_and_named) {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  BlendSet set = small_set();
  set.base.pop_back();
  EXPECT_EQ(error_of(validate(set)), "base: the base has 11 coordinates for 4 vertices, but must have 3 for each");
  for (const float bad : {nan, infinity, -infinity}) {
    set = small_set();
    set.base[7] = bad;
    EXPECT_EQ(error_of(validate(set)),
              "base, vertex 2: the position is NaN or infinite; positions must be finite numbers");
    set = small_set();
    set.targets[1].deltas[5] = bad;
    EXPECT_EQ(error_of(validate(set)),
              "target 1, entry 1: the delta is NaN or infinite; deltas must be finite numbers");
  }
  set = small_set();
  set.targets[1].deltas.pop_back();
  EXPECT_EQ(error_of(validate(set)), "target 1: the target has 5 coordinates for 2 vertices, but must have 3 for each");
  set = small_set();
  set.targets[0].vertices = {4};
  EXPECT_EQ(
      error_of(validate(set)),
      "target 0, entry 0: the target moves vertex 4, but the mesh has only 4 vertices; give the mesh of the target");
  for (const std::vector<std::uint32_t>& vertices : {std::vector<std::uint32_t>{2, 0}, {2, 2}}) {
    set = small_set();
    set.targets[1].vertices = vertices;
    EXPECT_EQ(error_of(validate(set)),
              "target 1, entry 1: the vertices of a target must be in ascending order, each once");
    EXPECT_EQ(error_of(validate(set.targets[1], set.topology, 7)),
              "target 7, entry 1: the vertices of a target must be in ascending order, each once");
  }
}

}  // namespace
}  // namespace chronormal::blend_set_test
