// Tests properties of NormalCurves that accuracy_test.cpp and theorems_test.cpp do not test: runs of elements of equal
// degree, layouts of memory, degenerate elements, and extreme values.

#include "chronormal/normals/normal_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/support/fixtures.h"
#include "tests/support/hard_normals.h"

namespace chronormal::normal_curves_test {
namespace {

const ControlNormals kStill{{0, 0, 2}, {0, 0, 2}, {0, 0, 2}};
const ControlNormals kLinear{{0, 0, 2}, {0, 0.5, 1.5}, {0, 1, 1}};
const ControlNormals kQuadratic{{0, 0, 1}, {0.5, 0, 1}, {1, 0, 0.2}};

std::vector<ControlNormals> repeated(std::initializer_list<std::pair<ControlNormals, int>> parts) {
  std::vector<ControlNormals> all;
  for (const auto& [normals, count] : parts) all.insert(all.end(), static_cast<std::size_t>(count), normals);
  return all;
}

std::vector<Vec3f> unit_normals(const NormalCurves& curves, double t, std::size_t* zeros = nullptr) {
  std::vector<float> packed(3 * curves.size());
  const auto view = VectorView<float>::packed(packed.data(), curves.size());
  const std::size_t count = curves.unit_normals(t, view);
  if (zeros != nullptr) *zeros = count;
  std::vector<Vec3f> result;
  for (std::size_t i = 0; i < view.count; ++i) result.push_back(view[i]);
  return result;
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(NormalCurves, elements_of_low_degree_cost_less_memory) {
  const std::size_t still = NormalCurves(repeated({{kStill, 1000}})).bytes();
  const std::size_t linear = NormalCurves(repeated({{kLinear, 1000}})).bytes();
  const std::size_t quadratic = NormalCurves(repeated({{kQuadratic, 1000}})).bytes();
  EXPECT_LT(still, 17 * 1000u);
  EXPECT_LT(linear, 25 * 1000u);
  EXPECT_GE(quadratic, 36 * 1000u);
  EXPECT_LT(quadratic, 37 * 1000u);
}

TEST(NormalCurves, counts_degrees_as_they_are) {
  const NormalCurves curves(repeated({{kStill, 20}, {kLinear, 3}, {kQuadratic, 30}, {kStill, 1}}));
  EXPECT_EQ(curves.degree_counts(), (std::array<std::size_t, 3>{21, 3, 30}));
  EXPECT_EQ(curves.flagged_count(), 0u);
}

TEST(NormalCurves, every_mixture_of_degrees_gives_what_each_element_gives_alone) {
  // The runs of elements of equal degree are short or long, and at the ends or in the middle. Some short runs are
  // therefore stored with a higher degree.
  const auto mixed = repeated({{kStill, 2},
                               {kQuadratic, 9},
                               {kLinear, 1},
                               {kStill, 12},
                               {kLinear, 10},
                               {kQuadratic, 1},
                               {kStill, 3},
                               {kLinear, 3},
                               {kQuadratic, 8},
                               {kStill, 1}});
  const NormalCurves curves(mixed);
  for (const double t : {0.0, 0.3, 0.5, 1.0}) {
    const auto normals = unit_normals(curves, t);
    for (std::size_t i = 0; i < mixed.size(); ++i)
      expect_near(to_double(normals[i]), unit_normal_at(mixed[i], t).vector, 2e-7);
  }
}

TEST(NormalCurves, planes_and_packed_results_are_the_same_bits) {
  const auto mixed = repeated({{kStill, 20}, {kQuadratic, 33}, {kLinear, 17}, {ControlNormals{}, 2}});
  const NormalCurves curves(mixed);
  std::vector<float> planes(3 * mixed.size());
  const auto view = VectorView<float>::planes(planes.data(), planes.data() + mixed.size(),
                                              planes.data() + 2 * mixed.size(), mixed.size());
  (void)curves.unit_normals(0.37, view);
  const auto packed = unit_normals(curves, 0.37);
  for (std::size_t i = 0; i < mixed.size(); ++i) EXPECT_EQ(view[i], packed[i]);
}

TEST(NormalCurves, normals_have_twice_the_area_as_length) {
  const auto mixed = repeated({{kStill, 9}, {kLinear, 9}, {kQuadratic, 9}});
  const NormalCurves curves(mixed);
  std::vector<float> packed(3 * mixed.size());
  const auto view = VectorView<float>::packed(packed.data(), mixed.size());
  curves.normals(0.25, view);
  for (std::size_t i = 0; i < mixed.size(); ++i) expect_near(to_double(view[i]), normal_at(mixed[i], 0.25), 5e-7);
}

TEST(NormalCurves, no_elements_are_no_trouble) {
  const NormalCurves curves{std::span<const ControlNormals>{}};
  EXPECT_EQ(curves.size(), 0u);
  EXPECT_EQ(curves.unit_normals(0.5, VectorView<float>{}), 0u);
}

TEST(NormalCurves, an_element_that_is_always_zero_gives_zero_and_is_counted) {
  const NormalCurves curves(repeated({{kQuadratic, 3}, {ControlNormals{}, 2}, {kStill, 3}}));
  std::size_t zeros = 0;
  const auto normals = unit_normals(curves, 0.5, &zeros);
  EXPECT_EQ(zeros, 2u);
  EXPECT_EQ(normals[3], Vec3f{});
  EXPECT_EQ(normals[4], Vec3f{});
  expect_near(to_double(normals[5]), {0, 0, 1}, 1e-7);
}

TEST(UnitNormal, start_without_area_takes_the_limit_from_after) {
  const UnitNormal grows = unit_normal_at({{0, 0, 0}, {0, 3, 0}, {1, 0, 0}}, 0);
  EXPECT_EQ(grows.direction, Direction::kLimit);
  EXPECT_EQ(grows.vector, (Vec3d{0, 1, 0}));
  const UnitNormal grows_late = unit_normal_at({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}}, 0);
  EXPECT_EQ(grows_late.direction, Direction::kLimit);
  EXPECT_EQ(grows_late.vector, (Vec3d{1, 0, 0}));
}

TEST(UnitNormal, end_without_area_takes_the_limit_from_before) {
  const UnitNormal shrinks = unit_normal_at({{1, 0, 0}, {0, 3, 0}, {0, 0, 0}}, 1);
  EXPECT_EQ(shrinks.direction, Direction::kLimit);
  EXPECT_EQ(shrinks.vector, (Vec3d{0, 1, 0}));
  const UnitNormal gone_early = unit_normal_at({{2, 0, 0}, {0, 0, 0}, {0, 0, 0}}, 1);
  EXPECT_EQ(gone_early.vector, (Vec3d{1, 0, 0}));
}

TEST(UnitNormal, a_double_zero_inside_keeps_its_direction) {
  const ControlNormals touching{{0, 0, 1}, {0, 0, -1}, {0, 0, 1}};  // the length of n(t) is (1 - 2t)^2
  const UnitNormal u = unit_normal_at(touching, 0.5);
  EXPECT_EQ(u.direction, Direction::kLimit);
  EXPECT_EQ(u.vector, (Vec3d{0, 0, 1}));
}

TEST(UnitNormal, a_simple_zero_inside_gives_the_side_before_and_says_so) {
  const ControlNormals crossing{{0, 0, 1}, {0, 0, 0}, {0, 0, -1}};  // the length of n(t) is |1 - 2t|
  const UnitNormal u = unit_normal_at(crossing, 0.5);
  EXPECT_EQ(u.direction, Direction::kDiscontinuous);
  EXPECT_EQ(u.vector, (Vec3d{0, 0, 1}));
  EXPECT_EQ(unit_normal_at(crossing, 0.51).vector, (Vec3d{0, 0, -1}));
}

TEST(UnitNormal, nothing_at_all_is_none) {
  const UnitNormal u = unit_normal_at({}, 0.5);
  EXPECT_EQ(u.direction, Direction::kNone);
  EXPECT_EQ(u.vector, Vec3d{});
}

TEST(ControlNormalsOfFaces, collinear_corners_give_exact_zero) {
  // The products of the coordinates in this test are not exact in double. The rounding errors of these products must
  // not be returned as the direction of a normal.
  const Topology topology = Topology::triangles(3, {0, 1, 2}).value();
  std::vector<float> p(9);
  int tested = 0;
  for (int i = 1; i < 2000; ++i) {
    const float x = 0.1f * static_cast<float>(i), y = 1e-7f * static_cast<float>(i * i),
                z = 3e5f / static_cast<float>(i);
    p = {0, 1e10f, 0, x, 1e10f + y, z, 2 * x, 1e10f + 2 * y, 2 * z};
    // Skips points that are not collinear after rounding to float32. The differences in this condition are exact.
    if (p[3] - p[0] != p[6] - p[3] || p[4] - p[1] != p[7] - p[4] || p[5] - p[2] != p[8] - p[5]) continue;
    ++tested;
    const auto view = VectorView<const float>::packed(p.data(), 3);
    const Segment segment{&topology, view, view, 0, 1, 0};
    ControlNormals normals;
    face_control_normals(segment, {0, 1}, {&normals, 1});
    EXPECT_EQ(normals, ControlNormals{}) << i;
  }
  EXPECT_GT(tested, 100);
}

TEST(ControlNormalsOfFaces, corners_that_are_not_quite_collinear_give_what_there_is) {
  // c = 2 b, so b x c is zero. Since a is very close to the origin, n = a x (b - c) = b x a is far below the rounding
  // errors of the products that n is a sum of.
  const Topology topology = Topology::triangles(3, {0, 1, 2}).value();
  const float p[] = {1e-20f, 0, 0, 0.3f, 0.7f, 0.1f, 2 * 0.3f, 2 * 0.7f, 2 * 0.1f};
  const auto view = VectorView<const float>::packed(p, 3);
  ControlNormals normals;
  face_control_normals({&topology, view, view, 0, 1, 0}, {0, 1}, {&normals, 1});
  const Vec3d expected = cross(to_double(Vec3f{p[3], p[4], p[5]}), to_double(Vec3f{p[0], p[1], p[2]}));
  for (const Vec3d& n : {normals.n0, normals.m, normals.n1})
    EXPECT_LE(max_abs(n - expected), 1e-15 * max_abs(expected));
}

TEST(NormalCurves, lengths_at_the_limits_of_float_are_finite) {
  const float big = 3e38f;
  const Topology topology = Topology::triangles(3, {0, 1, 2}).value();
  for (const float size : {1e-38f, 1e-30f, 1e-19f, 1.0f, 1e19f, big}) {
    const float p[] = {-size, 0, 0, size, 0, 0, 0, size, 0}, q[] = {-size, 0, size, size, 0, 0, 0, size, -size};
    const Segment segment{&topology, VectorView<const float>::packed(p, 3), VectorView<const float>::packed(q, 3), 0, 1,
                          0};
    ControlNormals exact;
    face_control_normals(segment, {0, 1}, {&exact, 1});
    const NormalCurves curves({&exact, 1});
    for (const double t : {0.0, 0.25, 1.0}) {
      const auto u = unit_normals(curves, t);
      expect_near(to_double(u[0]), unit_normal_at(exact, t).vector, 3e-7);
      std::vector<float> n(3);
      curves.normals(t, VectorView<float>::packed(n.data(), 1));
      for (const float component : n) EXPECT_TRUE(std::isfinite(component)) << size;
    }
  }
}

TEST(NormalCurves, control_normals_of_any_finite_size_keep_their_direction) {
  for (const double size : {1e-310, 1e-300, 1e-290, 1e-200, 1e200, 1e290}) {
    const ControlNormals c{size * kQuadratic.n0, size * kQuadratic.m, size * kQuadratic.n1};
    const auto u = unit_normals(NormalCurves(std::span(&c, 1)), 0.6);
    expect_near(to_double(u[0]), unit_normal_at(kQuadratic, 0.6).vector, 2e-7);
  }
}

TEST(NormalCurves, elements_of_very_different_size_all_keep_their_direction) {
  std::vector<ControlNormals> normals;
  for (int e = -60; e <= 60; e += 4) {
    const double s = std::ldexp(1, e);
    normals.push_back({s * kQuadratic.n0, s * kQuadratic.m, s * kQuadratic.n1});
  }
  const auto u = unit_normals(NormalCurves(normals), 0.6);
  for (const Vec3f& v : u) expect_near(to_double(v), unit_normal_at(kQuadratic, 0.6).vector, 2e-7);
}

TEST(NormalCurves, lengths_are_right_at_every_size_and_among_neighbours_of_any) {
  fixtures::Random random(61);
  for (const int spread : {0, 20, 60, 120}) {
    std::vector<ControlNormals> normals;
    for (int i = 0; i < 1000; ++i) {
      const double s = std::ldexp(1, static_cast<int>(random.below(static_cast<std::size_t>(spread) + 1)) - spread / 2);
      normals.push_back(test::scaled_by(s, test::hard_element(random, false)));
    }
    const NormalCurves curves(normals);
    std::vector<float> packed(3 * normals.size());
    const auto view = VectorView<float>::packed(packed.data(), normals.size());
    for (const double t : {0.0, 0.25, 0.6, 1.0}) {
      curves.normals(t, view);
      for (std::size_t i = 0; i < normals.size(); ++i)
        expect_near(to_double(view[i]), normal_at(normals[i], t), 1e-6 * test::largest_of(normals[i]));
    }
  }
}

TEST(NormalCurves, flagged_elements_anywhere_leave_their_neighbours_alone) {
  const ControlNormals flagged{{0, 0, 1}, {1e-7, 0, 0}, {0, 0, -1}};
  for (const double tolerance : {1e-6, 1e-3, 5e-3}) {
    for (std::size_t size = 1; size <= 50; size += 7) {
      for (std::size_t at = 0; at < size; ++at) {
        std::vector<ControlNormals> normals(size, kQuadratic);
        const NormalCurves without(normals, {tolerance});
        normals[at] = flagged;
        const NormalCurves curves(normals, {tolerance});
        ASSERT_EQ(curves.flagged_count(), 1u);
        const auto expected = unit_normals(without, 0.5), u = unit_normals(curves, 0.5);
        for (std::size_t i = 0; i < size; ++i) {
          if (i == at) continue;
          ASSERT_EQ(u[i], expected[i]) << i;
        }
        expect_near(to_double(u[at]), {1, 0, 0}, 1e-6);
      }
    }
  }
}

TEST(NormalCurves, moved_from_are_as_good_as_new) {
  NormalCurves from(repeated({{kQuadratic, 40}, {ControlNormals{}, 2}}));
  const auto before = unit_normals(from, 0.4);
  NormalCurves to = std::move(from);
  EXPECT_EQ(unit_normals(to, 0.4), before);
  EXPECT_EQ(from.size(), 0u);  // NOLINT(bugprone-use-after-move): what this test is about
  EXPECT_EQ(from.unit_normals(0.4, VectorView<float>{}), 0u);
  from = NormalCurves(repeated({{kLinear, 3}}));
  EXPECT_EQ(unit_normals(from, 0.4).size(), 3u);
}

}  // namespace
}  // namespace chronormal::normal_curves_test
