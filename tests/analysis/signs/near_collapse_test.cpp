#include "analysis/signs/near_collapse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/fixtures.h"

namespace chronormal::near_collapse_test {
namespace {

std::vector<ControlNormals> normals_of(const Motion& motion) {
  std::vector<ControlNormals> normals(motion.topology.face_count());
  face_control_normals(motion.segment(0), {0, normals.size()}, normals);
  return normals;
}

// Returns the control normals of the curve beside + (0, 0, a0 + a1 t + a2 t^2).
ControlNormals along_z(double a0, double a1, double a2, const Vec3d& beside = {}) {
  const auto at = [&](double z) { return beside + Vec3d{0, 0, z}; };
  return {at(a0), at(a0 + a1 / 2), at(a0 + a1 + a2)};
}

ControlNormals with_roots(double first, double second) { return along_z(first * second, -(first + second), 1); }

TEST(NearCollapse, vertex_that_crosses_the_opposite_edge_turns_the_face_over_then) {
  // Vertices a and b rest. Vertex c moves in the plane from y = when to y = when - 1, so the face collapses at t =
  // when.
  for (const float when : {0.001F, 0.1F, 0.25F, 0.5F, 0.75F, 0.999F}) {
    const double start = when, end = static_cast<double>(when) - 1;
    const Motion motion = fixtures::make_motion(fixtures::make_soup(1), {{0, 0, 2}, {1, 0, 2}, {0.25, start, 2}},
                                                {{0, 0, 2}, {1, 0, 2}, {0.5, end, 2}});
    const NearCollapses found = find_near_collapses(normals_of(motion)[0]);
    ASSERT_EQ(found.count, 1U) << when;
    EXPECT_NEAR(found.at[0].t, start, 1e-6) << when;
    EXPECT_TRUE(found.at[0].turns_over) << when;
    EXPECT_FALSE(found.everywhere);
  }
}

TEST(NearCollapse, face_that_shrinks_to_a_point_and_comes_back_does_not_turn_over) {
  for (const ControlNormals& normals : normals_of(fixtures::point_reflected_soup(200))) {
    const NearCollapses found = find_near_collapses(normals);
    ASSERT_EQ(found.count, 1U);
    EXPECT_NEAR(found.at[0].t, 0.5, 1e-5);
    EXPECT_FALSE(found.at[0].turns_over);
  }
}

TEST(NearCollapse, mirror_image_turns_over_half_way) {
  for (const ControlNormals& normals : normals_of(fixtures::inside_out_soup(200))) {
    const NearCollapses found = find_near_collapses(normals);
    ASSERT_EQ(found.count, 1U);
    EXPECT_NEAR(found.at[0].t, 0.5, 1e-9);
    EXPECT_TRUE(found.at[0].turns_over);
  }
}

// If a face moves in the plane z = 0, only the z component of n(t) is not zero. The expected roots come from the
// quadratic formula in long double.
TEST(NearCollapse, in_a_plane_collapses_are_the_roots_of_the_signed_area) {
  Motion motion = fixtures::large_soup(2000, 21);
  for (Motion::Keyframe& keyframe : motion.keyframes) {
    for (std::size_t i = 2; i < keyframe.positions.size(); i += 3) keyframe.positions[i] = 0;
  }
  const std::vector<ControlNormals> normals = normals_of(motion);
  std::size_t once = 0, twice = 0, judged = 0;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const float *p = motion.keyframes[0].positions.data() + 9 * f, *q = motion.keyframes[1].positions.data() + 9 * f;
    const auto cross_at = [](const float* e, const float* g, int a, int b) {
      const auto edge = [](const float* points, int to, int k) {
        return static_cast<long double>(points[3 * to + k]) - static_cast<long double>(points[k]);
      };
      return edge(e, a, 0) * edge(g, b, 1) - edge(e, a, 1) * edge(g, b, 0);
    };
    const long double start = cross_at(p, p, 1, 2), end = cross_at(q, q, 1, 2);
    const long double mixed = cross_at(p, q, 1, 2) + cross_at(q, p, 1, 2);
    const long double a = start + end - mixed, b = mixed - 2 * start, c = start;
    std::vector<double> roots;
    if (const long double d = b * b - 4 * a * c; d > 0) {
      for (const int sign : {-1, 1}) {
        const auto t = static_cast<double>((-b + static_cast<long double>(sign) * std::sqrt(d)) / (2 * a));
        if (t > 0 && t < 1) roots.push_back(t);
      }
    }
    if (roots.size() == 2 && roots[0] > roots[1]) std::swap(roots[0], roots[1]);
    bool is_close_call = std::fabs(static_cast<double>(b * b - 4 * a * c)) < 1e-5;
    for (const double t : roots) is_close_call |= t < 1e-3 || t > 1 - 1e-3;
    if (is_close_call) continue;
    ++judged;
    const NearCollapses found = find_near_collapses(normals[f]);
    ASSERT_EQ(found.count, roots.size()) << f;
    for (std::size_t i = 0; i < roots.size(); ++i) {
      EXPECT_NEAR(found.at[i].t, roots[i], 1e-9) << f;
      EXPECT_TRUE(found.at[i].turns_over) << f;
    }
    once += roots.size() == 1 ? 1U : 0U;
    twice += roots.size() == 2 ? 1U : 0U;
  }
  EXPECT_GT(judged, 1900U);
  EXPECT_GT(once, 500U);
  EXPECT_GT(twice, 50U);
}

TEST(NearCollapse, two_zeros_are_two_and_very_near_ones_are_one_that_comes_back) {
  const NearCollapses two = find_near_collapses(with_roots(0.25, 0.75));
  ASSERT_EQ(two.count, 2U);
  EXPECT_NEAR(two.at[0].t, 0.25, 1e-12);
  EXPECT_NEAR(two.at[1].t, 0.75, 1e-12);
  EXPECT_TRUE(two.at[0].turns_over && two.at[1].turns_over);
  const NearCollapses near = find_near_collapses(with_roots(0.5, 0.5001));
  ASSERT_EQ(near.count, 1U);
  EXPECT_NEAR(near.at[0].t, 0.5, 2e-4);
  EXPECT_FALSE(near.at[0].turns_over);
  EXPECT_EQ(find_near_collapses(with_roots(0.5, 0.51)).count, 2U);
}

TEST(NearCollapse, a_miss_counts_below_the_share_only) {
  // n(t) = (d, 0, 2 t - 1), where d is the distance by which n(t) misses zero. The length of the largest control normal
  // is about 1.
  EXPECT_EQ(find_near_collapses(along_z(-1, 2, 0, {2 * kCollapseShare, 0, 0})).count, 0U);
  EXPECT_EQ(find_near_collapses(along_z(-1, 1.5, 0, {2 * kCollapseShare, 0, 0})).count, 0U);
  EXPECT_EQ(find_near_collapses(along_z(-1, 1.5, 0, {kCollapseShare / 2, 0, 0})).count, 1U);
  const NearCollapses found = find_near_collapses(along_z(-1, 2, 0, {kCollapseShare / 2, 0, 0}));
  ASSERT_EQ(found.count, 1U);
  EXPECT_TRUE(found.at[0].turns_over);
  EXPECT_NEAR(found.at[0].t, 0.5, 1e-9);
}

TEST(NearCollapse, faces_without_area_at_the_ends_alone_do_not_collapse_inside) {
  using fixtures::Shape;
  for (const auto& [start, end] :
       {std::pair{Shape::kLine, Shape::kTriangle}, {Shape::kTriangle, Shape::kLine}, {Shape::kLine, Shape::kLine}}) {
    for (const ControlNormals& normals : normals_of(fixtures::degenerate_soup(start, end))) {
      const NearCollapses found = find_near_collapses(normals);
      // The search may find one collapse or none. At the time of a found collapse, the normal must be nearly zero.
      for (std::size_t i = 0; i < found.count; ++i)
        EXPECT_LT(length(normal_at(normals, found.at[i].t)), 1e-5 * (length(normals.m) + length(normals.n1)));
      EXPECT_LE(found.count, 1U);
    }
  }
  EXPECT_EQ(find_near_collapses({{0, 0, 0}, {0, 0, 1}, {0, 0, 1}}).count, 0U);
  EXPECT_EQ(find_near_collapses({{0, 0, 1}, {0, 0, 0}, {0, 0, 0}}).count, 0U);
  EXPECT_EQ(find_near_collapses({{0, 0, 0}, {0, 0, 1}, {0, 0, 0}}).count, 0U);
}

TEST(NearCollapse, zero_throughout_is_everywhere_and_no_instant) {
  EXPECT_TRUE(find_near_collapses({}).everywhere);
  EXPECT_EQ(find_near_collapses({}).count, 0U);
}

TEST(NearCollapse, random_faces_in_space_do_not_collapse) {
  for (const ControlNormals& normals : normals_of(fixtures::large_soup(20000)))
    EXPECT_EQ(find_near_collapses(normals).count, 0U);
}

// Draws control normals within 90 degrees of one axis, so that n(t) cannot be zero but may become very short.
TEST(NearCollapse, a_glance_proves_that_almost_every_normal_stays_long_and_is_never_wrong) {
  fixtures::Random random(20261125);
  std::size_t proven = 0, near = 0;
  for (int i = 0; i < 200000; ++i) {
    const double scale = std::pow(10, random.uniform(-30, 30)), least = std::pow(10, random.uniform(-8, -5));
    const auto vector = [&](double z) {
      const auto [x, y, unused] = random.in_cube(1);
      return scale * Vec3d{x, y, z};
    };
    // In half of the cases, the end normals are nearly opposite.
    ControlNormals c{vector(least), vector(least), vector(least)};
    if (i % 2 == 0) c.n1 = {-c.n0.x, -c.n0.y, c.n0.z};
    if (i % 4 == 0) c.m = {(i % 8 == 0 ? 1e-3 : 0) * c.m.x, 0, c.n0.z};
    const NearCollapses found = find_near_collapses(c);
    near += found.count > 0 ? 1U : 0U;
    if (!is_far_from_collapse(c)) continue;
    ++proven;
    ASSERT_EQ(found.count, 0U) << i;
    ASSERT_FALSE(found.everywhere);
    for (double t = 0; t <= 1; t += 1.0 / 64)
      ASSERT_GT(length(normal_at(c, t)), 1e-6 * scale * std::fabs(c.n0.x / scale));
  }
  EXPECT_GT(proven, 10000U);
  EXPECT_GT(near, 1000U);
  EXPECT_FALSE(is_far_from_collapse({}));
  EXPECT_TRUE(is_far_from_collapse({{1, 2, 3}, {1, 2, 4}, {1, 2, 5}}));
}

TEST(NearCollapse, is_the_same_in_any_unit_and_mirrored_when_time_runs_back) {
  for (const Motion& motion : {fixtures::collapsing_soup(1e-8, 500), fixtures::inside_out_soup(100)}) {
    std::size_t all = 0;
    for (const ControlNormals& c : normals_of(motion)) {
      const NearCollapses found = find_near_collapses(c);
      const NearCollapses back = find_near_collapses({c.n1, c.m, c.n0});
      const NearCollapses scaled = find_near_collapses({0x1p-200 * c.n0, 0x1p-200 * c.m, 0x1p-200 * c.n1});
      ASSERT_EQ(back.count, found.count);
      ASSERT_EQ(scaled.count, found.count);
      all += found.count;
      for (std::size_t i = 0; i < found.count; ++i) {
        EXPECT_NEAR(back.at[found.count - 1 - i].t, 1 - found.at[i].t, 1e-6);
        EXPECT_EQ(back.at[found.count - 1 - i].turns_over, found.at[i].turns_over);
        EXPECT_EQ(scaled.at[i].t, found.at[i].t);
      }
    }
    EXPECT_GT(all, 50U);
  }
}

}  // namespace
}  // namespace chronormal::near_collapse_test
