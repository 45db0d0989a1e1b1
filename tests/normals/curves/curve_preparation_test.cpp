// Curves that are prepared in slices are those that are prepared in one go, to the last bit.

#include "chronormal/normals/curve_preparation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "tests/support/elements.h"
#include "tests/support/fixtures.h"

namespace chronormal::curve_preparation_test {
namespace {

std::vector<float> evaluate(const NormalCurves& curves, double t) {
  std::vector<float> result(3 * curves.size());
  (void)curves.unit_normals(t, VectorView<float>::packed(result));
  return result;
}

void expect_same(const NormalCurves& curves, const NormalCurves& expected) {
  ASSERT_EQ(curves.size(), expected.size());
  EXPECT_EQ(curves.bytes(), expected.bytes());
  EXPECT_EQ(curves.flagged_count(), expected.flagged_count());
  EXPECT_EQ(curves.degree_counts(), expected.degree_counts());
  for (const double t : {0.0, 0.3, 1.0}) EXPECT_EQ(evaluate(curves, t), evaluate(expected, t));
}

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

// Motions in order, in no order with more than a megabyte of positions, with flagged elements, and with no elements at
// all.
std::vector<Motion> motions() {
  const Motion smooth = fixtures::smooth_morph(160), large = fixtures::smooth_morph(220);
  return {smooth, test::with_faces_in_order(large, test::shuffled_order(large.topology.face_count(), 7)),
          fixtures::collapsing_soup(1e-3, 3000), fixtures::make_motion(fixtures::make_triangles(0, {}), {}, {})};
}

TEST(CurvePreparation, slices_of_any_size_have_the_bits_of_one_go) {
  for (const Motion& motion : motions()) {
    const Segment segment = motion.segment(0);
    const NormalGroups groups = vertices_of(motion);
    for (const double tolerance : {kExactTolerance, kCompactTolerance}) {
      const CurveOptions options{tolerance};
      const NormalCurves faces = NormalCurves::of_faces(segment, options);
      const NormalCurves vertices = NormalCurves::of_groups(segment, groups, options);
      for (const double share : {1e-9, 0.07, 0.4, 1.0, 9.0}) {
        CurvePreparation of_faces(segment, options), of_vertices(segment, groups, options);
        while (!of_faces.prepare(share)) {
        }
        while (!of_vertices.prepare(share)) {
        }
        expect_same(of_faces.take(), faces);
        expect_same(of_vertices.take(), vertices);
      }
      // take() does the work that was not asked for before.
      CurvePreparation begun(segment, groups, options);
      (void)begun.prepare(0.3);
      expect_same(begun.take(), vertices);
    }
  }
}

TEST(CurvePreparation, a_share_is_no_more_than_was_asked_for) {
  const Motion motion = fixtures::smooth_morph(160);  // 100 chunks
  for (const auto& [share, calls] : {std::pair{0.25, 4}, std::pair{0.1, 10}, std::pair{0.34, 3}}) {
    CurvePreparation preparation(motion.segment(0));
    int needed = 1;
    while (!preparation.prepare(share)) ++needed;
    EXPECT_EQ(needed, calls) << share;
  }
  CurvePreparation preparation(motion.segment(0));
  for (const double nothing : {0.0, -1.0, std::nan("")}) {
    for (int i = 0; i < 500; ++i) ASSERT_FALSE(preparation.prepare(nothing));
  }
  EXPECT_TRUE(preparation.prepare(1));
}

TEST(CurvePreparation, memory_of_curves_before_is_used_again) {
  const std::vector<Motion> all = motions();
  NormalCurves reused;
  for (int turn = 0; turn < 2; ++turn) {
    for (const Motion& motion : all) {
      const NormalGroups groups = vertices_of(motion);
      CurvePreparation preparation(motion.segment(0), groups, {}, &reused);
      EXPECT_EQ(reused.size(), 0U);
      while (!preparation.prepare(0.3)) {
      }
      reused = preparation.take();
      expect_same(reused, NormalCurves::of_groups(motion.segment(0), groups));
    }
  }
}

TEST(CurvePreparation, many_threads_place_parts_as_one_does) {
  const Motion motion = fixtures::smooth_morph(300);  // sixteen parts of faces
  const NormalCurves expected = NormalCurves::of_faces(motion.segment(0), {kCompactTolerance});
  for (const std::size_t threads : {1U, 2U, 3U, 8U, 64U}) {
    const ThreadLimit limit(threads);
    NormalCurves curves;
    for (int turn = 0; turn < 3; ++turn) {
      curves = NormalCurves::of_faces(motion.segment(0), {kCompactTolerance}, Threads::kAll, &curves);
      expect_same(curves, expected);
    }
  }
}

}  // namespace
}  // namespace chronormal::curve_preparation_test
