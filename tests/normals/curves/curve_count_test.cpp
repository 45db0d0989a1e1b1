// Compares the predicted sizes of curves with the sizes of curves that are really made.

#include "normals/curves/curve_count.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/normals/normal_curves.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"

namespace chronormal::curve_count_test {
namespace {

// Counts the bytes and the flagged elements of the curves of a segment, in ranges of `together` faces, and compares the
// counts with NormalCurves. Also compares the control normals that the count returns with those of
// face_control_normals().
void expect_same(const Segment& segment, std::size_t together, const char* name) {
  const std::size_t faces = segment.topology->face_count();
  const NormalCurves curves = NormalCurves::of_faces(segment);
  CurveCount count;
  for (std::size_t first = 0; first < faces; first += together) {
    const IndexRange range{first, std::min(together, faces - first)};
    std::vector<EdgedTile> exact((range.count + kTile - 1) / kTile);
    count.add(count_curves(segment, range, exact));
    for (std::size_t i = 0; i < range.count; ++i) {
      ControlNormals expected;
      face_control_normals(segment, {first + i, 1}, {&expected, 1});
      const ControlNormals found = element_of(exact[i / kTile].normals, i % kTile);
      ASSERT_EQ(std::memcmp(&found, &expected, sizeof expected), 0) << name << ", face " << first + i;
    }
  }
  ASSERT_EQ(count.flagged, curves.flagged_count()) << name;
  ASSERT_EQ(count.bytes(faces), curves.bytes()) << name << ", " << together << " together";
}

TEST(CurveCount, has_the_bytes_and_flagged_elements_of_curves_that_are_made) {
  const std::vector<std::pair<const char*, Motion>> motions = {{"smooth", fixtures::smooth_morph(40)},
                                                               {"eversion", make_builtin_morph("eversion").value()},
                                                               {"large", fixtures::large_soup(3001)},
                                                               {"needles", fixtures::needle_soup(1500)},
                                                               {"tiny", fixtures::tiny_soup(700)},
                                                               {"collapsing", fixtures::collapsing_soup(1e-9, 1200)},
                                                               {"thinnest", fixtures::thinnest_soup(true, 600)},
                                                               {"graded", fixtures::graded_soup(1025)},
                                                               {"huge", fixtures::huge_soup(512)}};
  for (const auto& [name, motion] : motions) {
    for (const std::size_t together : {kCountedTogether, 4 * kCountedTogether})
      expect_same(motion.segment(0), together, name);
  }
}

TEST(CurveCount, fills_the_last_block_with_what_the_last_faces_take) {
  // The first 900 faces rest, and the other faces move.
  Motion motion = fixtures::soup({.face_count = 1030, .seed = 11, .motion = 0.02});
  for (std::size_t i = 0; i < 9 * 900; ++i) motion.keyframes[1].positions[i] = motion.keyframes[0].positions[i];
  ASSERT_NE(motion.topology.face_count() % kTile, 0U);
  for (const std::size_t together : {kCountedTogether, 4 * kCountedTogether})
    expect_same(motion.segment(0), together, "still first");
  const NormalCurves curves = NormalCurves::of_faces(motion.segment(0));
  ASSERT_EQ(curves.flagged_count(), 0U);
  EXPECT_EQ(curves.bytes(), 56U * 16 * 16 + (1030U - 56 * 16) * 36 + 2 * 32)
      << "56 blocks of 16 bytes a face, and 36 for others";
}

TEST(CurveCount, is_right_of_the_hardest_elements_and_of_polygons) {
  fixtures::Random random(20261127);
  for (int round = 0; round < 30; ++round) {
    for (const test::HardMotions& family : test::hard_motions()) {
      const Motion motion = family.make(random);
      expect_same(motion.segment(0), kCountedTogether, family.name);
    }
  }
}

}  // namespace
}  // namespace chronormal::curve_count_test
