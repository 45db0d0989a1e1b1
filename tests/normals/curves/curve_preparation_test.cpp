// Checks that curves that are prepared in slices have the same bits as curves that are prepared at once.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "normals/curves/curve_builder.h"
#include "normals/curves/curve_count.h"
#include "normals/curves/curve_evaluation.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"

namespace chronormal::curve_preparation_test {
namespace {

std::vector<float> evaluate(const CurveData& curves, double t) {
  std::vector<float> result(3 * curves.size);
  const auto weights = CurveWeights::at(t, !curves.keeps_lengths);
  if (curves.size > 0)
    (void)evaluate_range(curves, {0, curves.size}, t, weights, PackedOutput(VectorView<float>::packed(result), {}));
  return result;
}

void expect_same(const CurveData& curves, const CurveData& expected) {
  ASSERT_EQ(curves.size, expected.size);
  EXPECT_EQ(CurveCount::of(curves).bytes(curves.size), CurveCount::of(expected).bytes(curves.size));
  EXPECT_EQ(curves.flagged.size(), expected.flagged.size());
  EXPECT_EQ(curves.degree_counts, expected.degree_counts);
  for (const double t : {0.0, 0.3, 1.0}) EXPECT_EQ(evaluate(curves, t), evaluate(expected, t));
}

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

// Makes four motions. In the first, the faces are in the order of the grid. In the second, they are in random order,
// with more than a megabyte of positions. The third has flagged elements, and the fourth has no elements.
std::vector<Motion> motions() {
  const Motion smooth = fixtures::smooth_morph(160), large = fixtures::smooth_morph(220);
  return {smooth, test::with_faces_in_order(large, test::shuffled_order(large.topology.face_count(), 7)),
          fixtures::collapsing_soup(1e-3, 3000), fixtures::make_motion(fixtures::make_triangles(0, {}), {}, {})};
}

TEST(CurveSlices, slices_of_any_size_have_the_bits_of_one_go) {
  for (const Motion& motion : motions()) {
    const Segment segment = motion.segment(0);
    const NormalGroups groups = vertices_of(motion);
    for (const double tolerance : {kExactTolerance, kCompactTolerance}) {
      const CurveOptions options{tolerance};
      const CurveData faces = build_curves(segment, options, Threads::kOne, nullptr);
      const CurveData vertices = build_curves(segment, groups, options, Threads::kOne, nullptr);
      for (const double share : {1e-9, 0.07, 0.4, 1.0, 9.0}) {
        CurveSlices of_faces(segment, nullptr, options, nullptr), of_vertices(segment, &groups, options, nullptr);
        while (!of_faces.advance(share)) {
        }
        while (!of_vertices.advance(share)) {
        }
        expect_same(of_faces.finish(), faces);
        expect_same(of_vertices.finish(), vertices);
      }
      // finish() must do all work that advance() has left.
      CurveSlices begun(segment, &groups, options, nullptr);
      (void)begun.advance(0.3);
      expect_same(begun.finish(), vertices);
    }
  }
}

TEST(CurveSlices, a_share_is_no_more_than_was_asked_for) {
  const Motion motion = fixtures::smooth_morph(160);  // prepared in 100 chunks
  for (const auto& [share, calls] : {std::pair{0.25, 4}, std::pair{0.1, 10}, std::pair{0.34, 3}}) {
    CurveSlices slices(motion.segment(0), nullptr, {}, nullptr);
    int needed = 1;
    while (!slices.advance(share)) ++needed;
    EXPECT_EQ(needed, calls) << share;
  }
  CurveSlices slices(motion.segment(0), nullptr, {}, nullptr);
  for (const double nothing : {0.0, -1.0, std::nan("")}) {
    for (int i = 0; i < 500; ++i) ASSERT_FALSE(slices.advance(nothing));
  }
  EXPECT_TRUE(slices.advance(1));
}

TEST(CurveSlices, memory_of_curves_before_is_used_again) {
  const std::vector<Motion> all = motions();
  CurveData reused;
  for (int turn = 0; turn < 2; ++turn) {
    for (const Motion& motion : all) {
      const NormalGroups groups = vertices_of(motion);
      CurveSlices slices(motion.segment(0), &groups, {}, &reused);
      while (!slices.advance(0.3)) {
      }
      reused = slices.finish();
      expect_same(reused, build_curves(motion.segment(0), groups, {}, Threads::kOne, nullptr));
    }
  }
}

TEST(CurveSlices, many_threads_place_parts_as_one_does) {
  const Motion motion = fixtures::smooth_morph(300);  // prepared in sixteen blocks of faces
  const CurveOptions options{kCompactTolerance};
  const CurveData expected = build_curves(motion.segment(0), options, Threads::kOne, nullptr);
  for (const std::size_t threads : {1U, 2U, 3U, 8U, 64U}) {
    const ThreadLimit limit(threads);
    CurveData curves;
    for (int turn = 0; turn < 3; ++turn) {
      curves = build_curves(motion.segment(0), options, Threads::kAll, &curves);
      expect_same(curves, expected);
    }
  }
}

}  // namespace
}  // namespace chronormal::curve_preparation_test
