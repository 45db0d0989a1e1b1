// Tests Quality, which collects angular errors, and reference_normals(), which computes exact normals.

#include "chronormal/analysis/quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"

namespace chronormal::quality_test {
namespace {

TEST(Quality, sums_angles_and_remembers_the_worst_place) {
  const std::vector<Vec3d> exact = {{0, 0, 5}, {0, 0, 1e-30}, {1e30, 0, 0}};
  float normals[] = {0, 0, 1, 0, 1, 0, 0.70710678f, 0.70710678f, 0};
  Quality quality;
  quality.add(exact, VectorView<float>::packed(normals, 3), {2, 10, 0.25});
  EXPECT_NEAR(quality.sum, 0.75 * 3.14159265358979, 1e-7);
  EXPECT_NEAR(quality.mean(), 0.25 * 3.14159265358979, 1e-7);
  EXPECT_NEAR(quality.rms(), 3.14159265358979 * std::sqrt((0.25 + 0.0625) / 3), 1e-7);
  EXPECT_NEAR(quality.max, 3.14159265358979 / 2, 1e-7);
  EXPECT_EQ(quality.max_at.segment, 2u);
  EXPECT_EQ(quality.max_at.element, 11u);
  EXPECT_EQ(quality.max_at.t, 0.25);
  EXPECT_EQ(quality.count, 3u);
}

TEST(Quality, tiny_angles_count) {
  const std::vector<Vec3d> exact = {{1, 0, 0}};
  float normals[] = {1, 1e-7f, 0};
  Quality quality;
  quality.add(exact, VectorView<float>::packed(normals, 1), {});
  EXPECT_NEAR(quality.sum, 1e-7, 1e-14);
}

TEST(Quality, pairs_without_a_direction_are_counted_not_summed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3d> exact = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  float normals[] = {1, 0, 0, 0, 0, 0, 0, 1, 0, nan, 0, 0};
  Quality quality;
  quality.add(exact, VectorView<float>::packed(normals, 4), {});
  EXPECT_EQ(quality.degenerate, 1u);
  EXPECT_EQ(quality.missing, 2u);
  EXPECT_EQ(quality.count, 1u);
  EXPECT_NEAR(quality.mean(), 3.14159265358979 / 2, 1e-7);
}

TEST(Quality, a_normal_without_bounds_is_missing) {
  const float infinite = std::numeric_limits<float>::infinity();
  const std::vector<Vec3d> exact = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  float normals[] = {infinite, 0, 0, 0, -infinite, 0, infinite, infinite, -infinite, 0, 1, 0};
  Quality quality;
  quality.add(exact, VectorView<float>::packed(normals, 4), {});
  EXPECT_EQ(quality.missing, 3u);
  EXPECT_EQ(quality.count, 1u);
  EXPECT_EQ(quality.sum, 0);
  EXPECT_EQ(quality.max, 0);
}

TEST(Quality, what_parts_left_out_adds_up) {
  const std::vector<Vec3d> exact = {{0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  float normals[] = {0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  Quality sum, part;
  part.add(exact, VectorView<float>::packed(normals, 4), {});
  sum.add(part);
  sum.add(part);
  EXPECT_EQ(sum.degenerate, 2u);
  EXPECT_EQ(sum.missing, 6u);
  EXPECT_EQ(sum.count, 0u);
}

TEST(Quality, parts_add_up) {
  const std::vector<Vec3d> exact = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  float normals[] = {0, 0, 1, 0, 0.1f, 1, 0, 0.3f, 1, 0, 0.3f, 1};
  const auto view = VectorView<float>::packed(normals, 4);
  Quality whole, first, second;
  whole.add(exact, view, {0, 0, 0});
  first.add(std::span(exact).first(2), view.part({0, 2}), {0, 0, 0});
  second.add(std::span(exact).last(2), view.part({2, 2}), {0, 2, 0});
  first.add(second);
  EXPECT_NEAR(first.sum, whole.sum, 1e-15);
  EXPECT_EQ(first.max, whole.max);
  EXPECT_EQ(first.max_at.element, 2u);  // the first of several elements with the same error
  EXPECT_EQ(whole.max_at.element, 2u);
  EXPECT_EQ(first.count, 4u);
}

TEST(Quality, nothing_measured_is_zero_not_nan) {
  EXPECT_EQ(Quality{}.mean(), 0);
  EXPECT_EQ(Quality{}.rms(), 0);
}

Vec3d reference(const std::vector<float>& from, const std::vector<float>& to, double t) {
  const Topology topology = Topology::polygons(from.size() / 3, {0, static_cast<std::uint32_t>(from.size() / 3)},
                                               from.size() == 9 ? std::vector<std::uint32_t>{0, 1, 2}
                                                                : std::vector<std::uint32_t>{0, 1, 2, 3})
                                .value();
  const Segment segment{&topology,
                        VectorView<const float>::packed(from.data(), from.size() / 3),
                        VectorView<const float>::packed(to.data(), to.size() / 3),
                        0,
                        1,
                        0};
  Vec3d n;
  reference_normals(segment, {0, 1}, t, {&n, 1});
  return n;
}

TEST(ReferenceNormals, are_cross_products_of_interpolated_vertices) {
  const std::vector<float> from = {0, 0, 0, 1, 0, 0, 0, 1, 0}, to = {0, 0, 2, 1, 0, 2, 0, 1, 4};
  const Vec3d n = reference(from, to, 0.5);  // at t = 1/2, the corners are (0,0,1), (1,0,1) and (0,1,2)
  EXPECT_EQ(n, (Vec3d{0, -1, 1}));
}

TEST(ReferenceNormals, of_a_polygon_are_its_vector_area) {
  const std::vector<float> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  EXPECT_EQ(reference(square, square, 0.3), (Vec3d{0, 0, 2}));
}

TEST(ReferenceNormals, a_collapse_is_exact_zero_wherever_it_lies) {
  // Two edges of the face have length zero at the same t, which is not a binary fraction. The rounding error at this t
  // must not be returned as the direction of a normal.
  for (const auto& [start, end] :
       {std::pair{7.0f, -13.0f}, {1.0f, -9.0f}, {3.0f, -7.0f}, {9.0f, -11.0f}, {17.0f, -3.0f}}) {
    const std::vector<float> from = {0, 0, 0, start, start, 0, 0, start, start};
    const std::vector<float> to = {0, 0, 0, end, end, 0, 0, end, end};
    const double t = static_cast<double>(start) / static_cast<double>(start - end);
    EXPECT_EQ(reference(from, to, t), Vec3d{}) << t;
    EXPECT_FALSE(reference(from, to, t + 1e-4) == Vec3d{}) << t;
  }
}

TEST(ReferenceNormals, far_from_the_origin_they_lose_nothing) {
  std::vector<float> from = {0, 0, 0, 1, 0, 0, 0, 1, 0}, to = {0, 0, 0, 0, 1, 0, 0, 0, 1};
  const Vec3d near = reference(from, to, 0.3);
  for (auto* points : {&from, &to})
    for (float& value : *points) value += 4096;
  const Vec3d far = reference(from, to, 0.3);
  EXPECT_LT(length(near - far), 1e-12);
}

// Compares the normals of faces, and sums of the normals of several faces, with exact results in integers of any size.
TEST(ReferenceNormals, of_hard_motions_point_where_whole_numbers_say) {
  constexpr std::uint64_t kSeed = 4950;
  fixtures::Random random(kSeed);
  std::size_t judged = 0, doubtful = 0;
  for (const test::HardMotions& family : test::hard_motions()) {
    for (int i = 0; i < 12; ++i) {
      const Motion motion = family.make(random);
      const Segment segment = motion.segment(0);
      const std::size_t faces = motion.topology.face_count();
      const NormalGroups vertices =
          NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
      const test::IntegerNormals oracle(segment);
      std::vector<Vec3d> found(faces);
      for (const double t : {0.0, 1.0, 0.5, random.uniform(0, 1)}) {
        const auto exact = oracle.at(test::IntegerTime::of(t));
        const auto judge = [&](const Vec3d& n, const test::IntegerVector& truth) {
          ++judged;
          if (n == Vec3d{}) {
            // If t is inside the segment, the library may return zero although the exact normal is not zero, since t is
            // rounded.
            doubtful += test::is_zero(truth) ? 0U : 1U;
            EXPECT_TRUE(test::is_zero(truth) || (0 < t && t < 1)) << family.name << " from seed " << kSeed;
          } else {
            const Vec3d u = unit(n);
            EXPECT_FALSE(test::is_zero(truth)) << family.name << " from seed " << kSeed;
            EXPECT_LE(test::angle_between(to_float(u), test::direction_of(truth)), 1e-5) << family.name << " at " << t;
          }
        };
        reference_normals(segment, {0, faces}, t, found);
        for (std::size_t f = 0; f < faces; ++f) judge(found[f], exact[f]);
        for (std::size_t v = 0; v < vertices.size(); ++v)
          judge(reference_normal(segment, vertices.faces(v), t), test::sum_of(exact, vertices.faces(v)));
      }
    }
  }
  EXPECT_GT(judged, 10000U);
  EXPECT_LT(doubtful, judged / 20);
}

}  // namespace
}  // namespace chronormal::quality_test
