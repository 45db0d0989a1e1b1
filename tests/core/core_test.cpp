// Tests Result, Vec3, views of vectors, and the parallel loop.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"

namespace chronormal::core_test {
namespace {

TEST(Result, carries_a_value_or_an_error) {
  const Result<int> good = 7;
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(good.value(), 7);
  const Result<int> bad = invalid_input("a.obj, line 3", "the index is 0");
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().text(), "a.obj, line 3: the index is 0");
  EXPECT_EQ(static_cast<int>(bad.error().code), 3);
  EXPECT_EQ((Error{ErrorCode::kUsage, "", "no place"}.text()), "no place");
}

Vec3d some_vector() {
  const auto component = [] { return std::ldexp(*rc::gen::inRange(-1000, 1001), *rc::gen::inRange(-40, 40)); };
  return {component(), component(), component()};
}

RC_GTEST_PROP(Vec3, cross_is_perpendicular_and_antisymmetric, ()) {
  const Vec3d a = some_vector(), b = some_vector();
  const Vec3d c = cross(a, b);
  const double size = length(a) * length(b);
  RC_ASSERT(std::fabs(dot(c, a)) <= 1e-14 * size * length(a));
  RC_ASSERT(std::fabs(dot(c, b)) <= 1e-14 * size * length(b));
  RC_ASSERT(c == -cross(b, a));
}

TEST(Vec3, unit_survives_lengths_whose_squares_do_not) {
  for (const double size : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
    const Vec3d u = unit({3 * size, 0, 4 * size});
    EXPECT_NEAR(u.x, 0.6, 1e-15);
    EXPECT_NEAR(u.z, 0.8, 1e-15);
    EXPECT_NEAR(length({3 * size, 0, 4 * size}) / size, 5, 1e-14);
  }
  EXPECT_EQ(unit(Vec3d{}), Vec3d{});
}

TEST(Vec3, largest_components_are_those_of_fmax_where_some_are_no_numbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const double values[] = {0, -0.0, 1, -2, 3e300, -infinity, nan};
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (const double x : values) {
    for (const double y : values) {
      EXPECT_TRUE(same(maximum_number(x, y), std::fmax(x, y))) << x << " " << y;
      for (const double z : values) {
        const double expected = std::fmax(std::fabs(x), std::fmax(std::fabs(y), std::fabs(z)));
        EXPECT_TRUE(same(max_abs({x, y, z}), expected)) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(Vec3, tiny_angles_are_not_lost) {
  EXPECT_NEAR(angle_between({1, 0, 0}, {1, 1e-12, 0}), 1e-12, 1e-20);
  EXPECT_NEAR(angle_between({1, 0, 0}, {-1, 1e-12, 0}), 3.14159265358979, 1e-11);
  EXPECT_EQ(angle_between({1, 0, 0}, {0, 0, 0}), 0);
}

TEST(Vec3, a_zero_vector_has_no_angle_to_any_direction) {
  for (const Vec3d& v : {Vec3d{-1, -1, -1}, Vec3d{1, 2, 3}, Vec3d{-1, 2, -3}, Vec3d{}}) {
    EXPECT_EQ(angle_between({}, v), 0);
    EXPECT_EQ(angle_between(v, {}), 0);
  }
}

RC_GTEST_PROP(Vec3, any_perpendicular_is_a_perpendicular_unit_vector, ()) {
  const Vec3d v = some_vector();
  RC_PRE(!(v == Vec3d{}));
  const Vec3d u = unit(v), p = any_perpendicular(u);
  RC_ASSERT(std::fabs(dot(u, p)) < 1e-15);
  RC_ASSERT(std::fabs(length(p) - 1) < 1e-15);
}

TEST(Views, planes_and_packed_name_the_same_vectors) {
  float planes[] = {1, 2, 10, 20, 100, 200}, packed[] = {1, 10, 100, 2, 20, 200};
  const auto a = VectorView<float>::planes(planes, planes + 2, planes + 4, 2);
  const auto b = VectorView<float>::packed(packed, 2);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(a[i], b[i]);
  b.part({1, 1}).set(0, {7, 8, 9});
  EXPECT_EQ(packed[3], 7);
  EXPECT_EQ(packed[5], 9);
  const VectorView<const float> read_only = b;
  EXPECT_EQ(read_only[1], (Vec3f{7, 8, 9}));
}

TEST(Views, a_whole_vector_is_a_packed_view_of_a_third_as_many) {
  std::vector<float> values = {1, 2, 3, 4, 5, 6};
  const auto view = VectorView<float>::packed(values);
  ASSERT_EQ(view.count, 2U);
  view.set(1, {7, 8, 9});
  EXPECT_EQ(values[3], 7);
  EXPECT_EQ(VectorView<const float>::packed(values)[1], (Vec3f{7, 8, 9}));
  EXPECT_EQ(VectorView<float>::packed(std::span<float>()).count, 0U);
}

TEST(Views, an_empty_packed_view_may_have_no_memory) {
  const auto view = VectorView<float>::packed(nullptr, 0);
  EXPECT_EQ(view.count, 0u);
}

TEST(Parallel, every_index_runs_once) {
  std::vector<std::atomic<int>> runs(1000);
  parallel_for(runs.size(), [&](std::size_t i) { ++runs[i]; });
  for (const auto& count : runs) EXPECT_EQ(count, 1);
  EXPECT_GE(thread_count(), 1u);
}

TEST(Parallel, an_exception_comes_out) {
  EXPECT_THROW(parallel_for(100,
                            [](std::size_t i) {
                              if (i == 42) throw std::runtime_error("42");
                            }),
               std::runtime_error);
}

}  // namespace
}  // namespace chronormal::core_test
