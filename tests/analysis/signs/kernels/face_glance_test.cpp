// Tests the glance, a cheap check that recognises faces that are far from a collapse. Compares the claims of the glance
// with long double and with the search for collapses, on every instruction set.

#include "analysis/signs/kernels/face_glance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "analysis/signs/near_collapse.h"
#include "chronormal/analysis/signs.h"
#include "normals/control/kernels/face_tiles.h"
#include "simd/targets.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"

namespace chronormal::face_glance_test {
namespace {

constexpr double kAngle = 0.4;  // the largest angle between the end normals of a usual face, in radians

std::vector<EdgedTile> tiles_of(const Segment& segment) {
  const std::size_t faces = segment.topology->face_count();
  std::vector<ControlTile> rounded((faces + kTile - 1) / kTile);
  std::vector<EdgedTile> tiles(rounded.size());
  face_control_tiles(segment, {0, faces}, rounded, tiles);
  return tiles;
}

long double longest_edge(const Segment& segment, std::size_t f) {
  long double longest = 0;
  const auto face = segment.topology->face(f);
  for (const auto* points : {&segment.from, &segment.to}) {
    const Vec3f a = (*points)[face[0]];
    for (const std::uint32_t vertex : face) {
      const Vec3f p = (*points)[vertex];
      for (const long double edge : {(long double)(p.x) - a.x, (long double)(p.y) - a.y, (long double)(p.z) - a.z})
        longest = std::max(longest, std::fabs(edge));
    }
  }
  return longest;
}

long double angle_of(const Vec3d& a, const Vec3d& b) {
  const long double x = (long double)(a.y) * b.z - (long double)(a.z) * b.y,
                    y = (long double)(a.z) * b.x - (long double)(a.x) * b.z,
                    z = (long double)(a.x) * b.y - (long double)(a.y) * b.x;
  const long double along = (long double)(a.x) * b.x + (long double)(a.y) * b.y + (long double)(a.z) * b.z;
  return std::atan2(std::sqrt(x * x + y * y + z * z), along);
}

// Checks all that the glance claims about usual faces, which are the faces that the glance does not report as unusual.
// Returns the number of usual faces.
std::size_t check_usual(const Segment& segment, const GlanceLimits& limits, const char* name) {
  std::size_t usual = 0;
  const std::vector<EdgedTile> tiles = tiles_of(segment);
  for (std::size_t f = 0; f < segment.topology->face_count(); ++f) {
    if ((unusual_faces(tiles[f / kTile], limits) >> f % kTile & 1) != 0) continue;
    ++usual;
    const ControlNormals c = element_of(tiles[f / kTile].normals, f % kTile);
    const long double longest = longest_edge(segment, f);
    EXPECT_GT(max_abs(c.n0), limits.length_from * longest) << name << ", face " << f;
    EXPECT_GT(max_abs(c.n1), limits.length_to * longest) << name << ", face " << f;
    EXPECT_LT(angle_of(c.n0, c.n1), kAngle + 1e-9L) << name << ", face " << f;
    EXPECT_EQ(find_near_collapses(c).count, 0U) << name << ", face " << f;
    const Collapses exact = find_collapses(segment, f, c);
    EXPECT_TRUE(exact.instants().empty() && !exact.always) << name << ", face " << f;
  }
  return usual;
}

GlanceLimits limits_of(double length_from, double length_to) {
  return {length_from, length_to, std::cos(kAngle) * std::cos(kAngle)};
}

TEST(FaceGlance, what_is_not_unusual_is_long_and_turns_little_and_never_vanishes) {
  fixtures::Random random(20261126);
  std::size_t usual = 0;
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    for (int round = 0; round < 10; ++round) {
      for (const test::HardMotions& family : test::hard_motions()) {
        const Motion motion = family.make(random);
        usual += check_usual(motion.segment(0), limits_of(1e-6, -1), family.name);
      }
    }
    const Motion motion = fixtures::moderate_soup(3001);
    for (const auto& [from, to] : {std::pair{-1.0, -1.0}, {0.3, -1.0}, {-1.0, 0.3}, {0.3, 0.3}})
      usual += check_usual(motion.segment(0), limits_of(from, to), "moderate");
  }
  EXPECT_GT(usual, 1000U);
}

TEST(FaceGlance, few_faces_of_a_smooth_motion_are_unusual) {
  const Motion motion = fixtures::smooth_morph(40);
  const std::size_t faces = motion.topology.face_count();
  const GlanceLimits limits{1e-6, 1e-6, 0};
  const std::vector<EdgedTile> tiles = tiles_of(motion.segment(0));
  std::size_t unusual = 0;
  for (std::size_t f = 0; f < faces; ++f) unusual += unusual_faces(tiles[f / kTile], limits) >> f % kTile & 1;
  EXPECT_LT(100 * unusual, 5 * faces);
}

TEST(FaceGlance, polygons_of_more_than_three_corners_are_unusual_where_their_length_counts) {
  const std::vector<fixtures::Point> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const Motion motion = fixtures::make_motion(Topology::polygons(4, {0, 4}, {0, 1, 2, 3}).value(), square, square);
  const std::vector<EdgedTile> tiles = tiles_of(motion.segment(0));
  EXPECT_EQ(unusual_faces(tiles[0], limits_of(-1, -1)) & 1, 0U);
  EXPECT_EQ(unusual_faces(tiles[0], limits_of(1e-6, -1)) & 1, 1U);
}

}  // namespace
}  // namespace chronormal::face_glance_test
