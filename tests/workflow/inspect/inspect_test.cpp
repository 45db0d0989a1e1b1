#include "chronormal/workflow/inspect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "chronormal/core/parallel.h"
#include "chronormal/io/input.h"
#include "chronormal/normals/normal_curves.h"
#include "tests/support/fixtures.h"

namespace chronormal::inspect_test {
namespace {

constexpr double kDegree = 1 / kDegreesPerRadian;

using Positions = std::vector<float>;

// Makes a motion of a triangle and a fourth vertex that no face uses. Each list of positions is a keyframe.
Motion triangle_motion(const std::vector<Positions>& keyframes) {
  Motion motion;
  motion.topology = fixtures::make_triangles(3, {0, 1, 2});
  for (const Positions& positions : keyframes)
    motion.keyframes.push_back({positions, static_cast<double>(motion.keyframes.size()), ""});
  if (keyframes.size() > 1) motion.connect_as_sequence();
  return motion;
}

const Positions kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};
const Positions kMirrored = {0, 0, 0, 1, 0, 0, 0, -1, 0};
const Positions kLine = {0, 0, 0, 1, 0, 0, 2, 0, 0};
const Positions kOtherLine = {0, 0, 0, 0, 1, 0, 0, 3, 0};
const Positions kStanding = {0, 0, 0, 1, 0, 0, 0, 0, 1};

TEST(Inspect, numbers_of_a_small_motion_by_hand) {
  Motion motion = triangle_motion({kTriangle, kStanding, kStanding});
  motion.keyframes[2].time = 5;
  const Inspection found = inspect(motion);
  EXPECT_EQ(found.vertices, 3U);
  EXPECT_EQ(found.faces, 1U);
  EXPECT_EQ(found.keyframes, 3U);
  EXPECT_EQ(found.first_time, 0);
  EXPECT_EQ(found.last_time, 5);
  EXPECT_EQ(found.high, (Vec3d{1, 1, 1}));
  EXPECT_NEAR(found.diagonal, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(found.motion.value, std::sqrt(2.0), 1e-12);
  EXPECT_EQ(found.motion.element, 2U);
  EXPECT_NEAR(found.turn.value, 90 * kDegree, 1e-12);
  ASSERT_EQ(found.segments.size(), 2U);
  EXPECT_EQ(found.segments[0].moved_vertices, 1U);
  EXPECT_EQ(found.segments[1].moved_vertices, 0U);
  EXPECT_EQ(found.segments[1].turn.value, 0);
  EXPECT_EQ(found.turned_far.pairs, 0U);
  EXPECT_EQ(found.no_area.pairs + found.slivers.pairs + found.collapses.pairs + found.without_normals.pairs, 0U);
  EXPECT_EQ(found.keyframe_bytes, 3U * 36U);
}

TEST(Inspect, face_without_area_is_found_at_its_keyframe_and_once_for_all_segments_there) {
  const Inspection found = inspect(triangle_motion({kTriangle, kLine, kTriangle, kLine}));
  EXPECT_EQ(found.no_area.pairs, 2U);
  EXPECT_EQ(found.no_area.faces, 1U);
  EXPECT_EQ(found.no_area.first_at, 1U);
  EXPECT_EQ(found.without_normals.pairs, 0U);
  EXPECT_EQ(found.collapses.pairs, 0U);
}

TEST(Inspect, face_that_turns_over_is_found_with_its_segment_and_instant) {
  Motion motion = triangle_motion({kTriangle, kTriangle, kMirrored, kTriangle});
  motion.keyframes[3].positions[7] = 3;
  const Inspection found = inspect(motion);
  EXPECT_EQ(found.collapses.pairs, 2U);
  EXPECT_EQ(found.vanishing.pairs, 2U);
  EXPECT_EQ(found.collapses.faces, 1U);
  EXPECT_EQ(found.turned_over.pairs, 2U);
  EXPECT_EQ(found.turned_over.first_at, 1U);
  EXPECT_NEAR(found.turned_over.first_t, 0.5, 1e-12);
  EXPECT_EQ(found.segments[2].turned_over, 1U);
  EXPECT_EQ(found.turned_far.pairs, 2U);
  EXPECT_NEAR(found.turn.value, 180 * kDegree, 1e-12);
  EXPECT_EQ(found.no_area.pairs, 0U);
}

TEST(Inspect, face_that_shrinks_and_comes_back_collapses_but_does_not_turn_over) {
  const Inspection found = inspect(fixtures::point_reflected_soup(50));
  EXPECT_EQ(found.collapses.faces, 50U);
  EXPECT_LE(found.vanishing.faces, 50U) << "float32 has rounded some of them beside it";
  EXPECT_EQ(found.turned_over.faces, 0U);
  EXPECT_EQ(found.turned_far.faces, 0U);
}

TEST(Inspect, face_on_a_line_throughout_has_no_normal_and_one_between_two_lines_has) {
  const Inspection still = inspect(triangle_motion({kLine, kLine}));
  EXPECT_EQ(still.without_normals.pairs, 1U);
  EXPECT_EQ(still.no_area.pairs, 2U);
  EXPECT_EQ(inspect(triangle_motion({kLine, kOtherLine})).without_normals.pairs, 0U);
}

TEST(Inspect, sliver_may_be_as_long_as_the_mesh) {
  // A triangle of height h over a base of length 2 has |n| = 2 h, and the bound for slivers is 4 sqrt(3) 2^-24 times 2.
  // The length |n| is below the bound for h = 2^-22, and above it for h = 2^-21.
  const Positions sliver = {-1, 0, 0, 1, 0, 0, 0, 0x1p-22F, 0}, narrow = {-1, 0, 0, 1, 0, 0, 0, 0x1p-21F, 0};
  EXPECT_EQ(inspect(triangle_motion({sliver, kTriangle})).slivers.pairs, 1U);
  EXPECT_EQ(inspect(triangle_motion({narrow, kTriangle})).slivers.pairs, 0U);
}

TEST(Inspect, sliver_is_what_rounding_can_turn) {
  // At coordinates of about 1000, neighbouring floats differ by 6e-5, which is about the height of the first triangle
  // (2^-14).
  Positions sliver = {1000, 0, 0, 1001, 0, 0, 1002, 0, 0}, narrow = sliver;
  sliver[7] = 0x1p-14F;
  narrow[7] = 0x1p-9F;
  const Inspection found = inspect(triangle_motion({sliver, narrow}));
  EXPECT_EQ(found.slivers.pairs, 1U);
  EXPECT_EQ(found.slivers.first_at, 0U);
  EXPECT_EQ(found.no_area.pairs, 0U);
}

// Tells by the definition in inspect.h whether a triangle is a sliver in a keyframe. Computes in long double.
bool is_sliver(const Motion& motion, std::size_t keyframe, std::size_t face) {
  const float* const p = motion.keyframes[keyframe].positions.data() + 9 * face;
  long double e[3], f[3], coordinate = 0, edge = 0, size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    e[k] = static_cast<long double>(p[3 + k]) - p[k];
    f[k] = static_cast<long double>(p[6 + k]) - p[k];
    edge = std::max({edge, std::fabs(e[k]), std::fabs(f[k])});
  }
  for (std::size_t i = 0; i < 9; ++i) coordinate = std::max(coordinate, std::fabs(static_cast<long double>(p[i])));
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    size = std::max(size, std::fabs(e[i] * f[j] - e[j] * f[i]));
  }
  return size > 0 && size <= 4 * std::sqrt(3.0L) * 0x1p-24L * coordinate * edge;
}

TEST(Inspect, slivers_are_those_of_their_own_keyframe_and_the_box_is_that_of_all) {
  // The needles are about as wide as the bound for slivers. The distance of a needle from the origin depends on the
  // keyframe and the face.
  constexpr std::size_t kFaces = 10000;
  Motion motion = fixtures::soup({.face_count = kFaces, .seed = 77, .motion = 1e-3, .needle = 4e-7});
  motion.keyframes.push_back(motion.keyframes[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    motion.keyframes[k].time = static_cast<double>(k);
    std::vector<float>& positions = motion.keyframes[k].positions;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const bool is_far = (i / 9) % 5 == k;
      positions[i] = (k == 1 ? 0x1p-3F : 1) * positions[i] + (is_far ? 4.0F : 0);
    }
  }
  motion.keyframes[1].positions[9 * 7000 + 2] = -40;
  motion.keyframes[2].positions[9 * 9999 + 7] = 50;
  motion.segments.clear();
  motion.connect_as_sequence();
  std::size_t expected = 0;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t f = 0; f < kFaces; ++f) expected += is_sliver(motion, k, f) ? 1U : 0U;
  ASSERT_GT(expected, 1000U);
  ASSERT_LT(expected, 3 * kFaces - 1000U);
  const Inspection found = inspect(motion);
  EXPECT_EQ(found.slivers.pairs, expected);
  EXPECT_EQ(found.low.z, -40);
  EXPECT_EQ(found.high.y, 50);
  double low = 0, high = 0;
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    for (std::size_t i = 0; i < keyframe.positions.size(); i += 3) {
      low = std::min(low, double{keyframe.positions[i]});
      high = std::max(high, double{keyframe.positions[i]});
    }
  }
  EXPECT_EQ(found.low.x, low);
  EXPECT_EQ(found.high.x, high);
}

TEST(Inspect, largest_motion_is_that_of_the_first_vertex_that_goes_so_far) {
  Motion motion = fixtures::moderate_soup(9000);
  std::vector<float>&from = motion.keyframes[0].positions, &to = motion.keyframes[1].positions;
  // Each vertex moves slightly farther than the vertex before it, except that the last two move equally far.
  for (std::size_t v = 0; v < from.size() / 3; ++v) to[3 * v] = from[3 * v] + 1 + static_cast<float>(v) * 0x1p-13F;
  std::copy_n(from.end() - 3, 3, from.end() - 6);
  std::copy_n(to.end() - 3, 3, to.end() - 6);
  long double largest = 0;
  std::size_t first = 0;
  for (std::size_t v = 0; v < from.size() / 3; ++v) {
    long double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const long double step = static_cast<long double>(to[3 * v + k]) - from[3 * v + k];
      square += step * step;
    }
    if (square > largest) {
      largest = square;
      first = v;
    }
  }
  const Inspection found = inspect(motion);
  EXPECT_EQ(found.motion.element, first);
  EXPECT_NEAR(found.motion.value, static_cast<double>(std::sqrt(largest)), 1e-14);
  EXPECT_EQ(found.segments[0].moved_vertices, from.size() / 3);
}

TEST(Inspect, mesh_without_motion_and_keyframe_without_segment_are_inspected_too) {
  const Inspection mesh = inspect(triangle_motion({kLine}));
  EXPECT_EQ(mesh.no_area.pairs, 1U);
  EXPECT_TRUE(mesh.segments.empty());
  EXPECT_EQ(mesh.normal_bytes, 0U);
  Motion motion = triangle_motion({kTriangle, kStanding, kLine});
  motion.segments = {{0, 1}};
  EXPECT_EQ(inspect(motion).no_area.first_at, 2U);
}

TEST(Inspect, vertices_that_part_later_are_doubled_at_the_start_only) {
  Motion motion;
  motion.topology = fixtures::make_triangles(7, {0, 1, 2, 3, 4, 5});
  // Vertex 3 remains at the position of vertex 0, vertex 4 separates from vertex 1, and no face uses vertex 6.
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 0, 9, 9, 9}, 0, ""},
                      {{0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0, 0, -1, 0, 9, 9, 9}, 1, ""}};
  motion.connect_as_sequence();
  const Inspection found = inspect(motion);
  EXPECT_EQ(found.doubled, (Found{1, 3}));
  EXPECT_EQ(found.doubled_at_start, (Found{2, 3}));
  EXPECT_EQ(found.surface.unreferenced, (Found{1, 6}));
  EXPECT_EQ(found.surface.pieces, 1U);
  EXPECT_EQ(found.surface.edges, 6U);

  // If the two triangles are separate bodies, coinciding vertices do not share a point.
  motion.body_of_vertex = {0, 0, 0, 1, 1, 1, 1};
  const Inspection apart = inspect(motion);
  EXPECT_EQ(apart.doubled.count, 0U);
  EXPECT_EQ(apart.doubled_at_start.count, 0U);
  EXPECT_EQ(apart.surface.pieces, 2U);
}

TEST(Inspect, flagged_and_bytes_are_those_of_normal_curves) {
  for (const Motion& motion :
       {fixtures::large_soup(3000), fixtures::smooth_morph(16), make_builtin_morph("eversion").value()}) {
    const Inspection found = inspect(motion);
    std::size_t flagged = 0, bytes = 0;
    for (std::size_t s = 0; s < motion.segments.size(); ++s) {
      const NormalCurves curves = NormalCurves::of_faces(motion.segment(s));
      flagged += curves.flagged_count();
      bytes += curves.bytes();
    }
    EXPECT_EQ(found.flagged, flagged);
    EXPECT_EQ(found.normal_bytes, bytes);
  }
}

TEST(Inspect, knows_a_star_from_a_sequence_by_its_segments) {
  Motion motion = triangle_motion({kTriangle, kMirrored, kStanding, kMirrored});
  motion.connect_as_targets();
  const Inspection found = inspect(motion);
  EXPECT_EQ(found.turned_over.pairs, 2U);
  EXPECT_EQ(found.turned_over.faces, 1U);
  EXPECT_EQ(found.segments[1].collapses, 0U);
  EXPECT_EQ(found.segments[2].collapses, 1U);
}

TEST(Inspect, many_segments_count_each_face_once_and_each_pair) {
  Motion motion = fixtures::inside_out_soup(100);
  const auto first = motion.keyframes[0], second = motion.keyframes[1];
  for (int k = 2; k < 40; ++k) {
    motion.keyframes.push_back(k % 2 == 0 ? first : second);
    motion.keyframes.back().time = k;
  }
  motion.segments.clear();
  motion.connect_as_sequence();
  const Inspection found = inspect(motion);
  EXPECT_EQ(found.turned_over.pairs, 39U * 100U);
  EXPECT_EQ(found.turned_over.faces, 100U);
  EXPECT_EQ(found.turned_over.first_at, 0U);
  EXPECT_EQ(found.turned_over.first_face, 0U);
}

TEST(Inspect, a_large_mesh_has_the_trouble_of_its_faces_wherever_they_are) {
  constexpr std::size_t kFaces = 15000;
  Motion motion;
  std::vector<std::uint32_t> corners(3 * kFaces);
  std::iota(corners.begin(), corners.end(), 0U);
  motion.topology = fixtures::make_triangles(3 * kFaces, corners);
  for (const std::size_t k : {0U, 1U, 2U}) {
    Positions positions;
    for (std::size_t f = 0; f < kFaces; ++f) {
      const bool is_mirrored = k == 1 && (f == 9000 || f == 12000), is_line = k == 2 && (f == 4097 || f == 13000);
      const Positions& one = is_mirrored ? kMirrored : is_line ? kLine : kTriangle;
      positions.insert(positions.end(), one.begin(), one.end());
    }
    if (k == 2) positions[3 * (3 * 14000 + 2) + 2] = 10;
    motion.keyframes.push_back({positions, static_cast<double>(k), ""});
  }
  motion.connect_as_sequence();
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const ThreadLimit limit(threads);
    const Inspection found = inspect(motion);
    EXPECT_EQ(found.turned_over.pairs, 4U);
    EXPECT_EQ(found.turned_over.faces, 2U);
    EXPECT_EQ(found.turned_over.first_at, 0U);
    EXPECT_EQ(found.turned_over.first_face, 9000U);
    EXPECT_NEAR(found.turned_over.first_t, 0.5, 1e-12);
    EXPECT_EQ(found.turn.element, 9000U);
    EXPECT_EQ(found.turn.segment, 0U);
    EXPECT_EQ(found.no_area.pairs, 2U);
    EXPECT_EQ(found.no_area.first_at, 2U);
    EXPECT_EQ(found.no_area.first_face, 4097U);
    EXPECT_EQ(found.motion.value, 10);
    EXPECT_EQ(found.motion.segment, 1U);
    EXPECT_EQ(found.motion.element, 3U * 14000 + 2);
    ASSERT_EQ(found.segments.size(), 2U);
    EXPECT_EQ(found.segments[0].moved_vertices, 2U);
    EXPECT_EQ(found.segments[1].moved_vertices, 5U);
    EXPECT_EQ(found.segments[1].turned_over, 2U);
  }
}

TEST(Inspect, same_shape_in_another_unit_has_the_same_trouble) {
  Motion motion = fixtures::large_soup(2000);
  const Inspection found = inspect(motion);
  for (Motion::Keyframe& keyframe : motion.keyframes) {
    for (float& c : keyframe.positions) c *= 0x1p40F;
  }
  const Inspection scaled = inspect(motion);
  EXPECT_GT(found.turned_far.pairs, 500U);
  EXPECT_EQ(scaled.turned_far.pairs, found.turned_far.pairs);
  EXPECT_EQ(scaled.slivers.pairs, found.slivers.pairs);
  EXPECT_EQ(scaled.flagged, found.flagged);
  EXPECT_EQ(scaled.diagonal, found.diagonal * 0x1p40);
  EXPECT_EQ(scaled.turn.value, found.turn.value);
}

TEST(Inspect, progress_reaches_its_end) {
  std::size_t last = 0, total = 0;
  (void)inspect(triangle_motion({kTriangle, kLine, kTriangle, kLine, kTriangle}),
                [&](std::size_t done, std::size_t all) {
                  EXPECT_GT(done, last);
                  last = done;
                  total = all;
                });
  EXPECT_EQ(last, 4U);
  EXPECT_EQ(total, 4U);
}

}  // namespace
}  // namespace chronormal::inspect_test
