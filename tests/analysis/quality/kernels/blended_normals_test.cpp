// Checks the kernels that add up blended normals in many poses, and that measure the errors of these normals. On every
// instruction set, the kernels must give the same bits as plain loops. The openness is a measure of the angle between
// two normals, and the largest openness must agree with angles in long double.
#include "analysis/quality/kernels/blended_normals.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <vector>

#include "core/portable_math.h"
#include "simd/targets.h"
#include "tests/support/hard_motions.h"

namespace chronormal::blended_normals_test {
namespace {

Vec3f any_vector(fixtures::Random& random) {
  const fixtures::Point p = random.in_cube(std::pow(10.0, random.uniform(-3, 3)));
  return to_float({p[0], p[1], p[2]});
}

TEST(AddWeighted, has_the_bits_of_one_sum_after_the_other_on_every_instruction_set) {
  fixtures::Random random(11);
  for (const std::size_t stride : {16U, 48U, 64U, 208U}) {
    std::vector<std::vector<float>> weights(7);
    std::vector<WeightedVector> terms;
    for (std::vector<float>& row : weights) {
      const std::size_t first = random.below(stride), end = first + random.below(stride - first) + 1;
      row.assign(stride, 0.0F);
      for (std::size_t p = first; p < end; ++p) row[p] = static_cast<float>(random.uniform(-2, 2));
      terms.push_back({row.data(), first, end, any_vector(random)});
    }
    const Vec3f base = any_vector(random);
    std::vector<float> expected(3 * stride);
    for (std::size_t p = 0; p < stride; ++p) {
      Vec3f sum = base;
      for (const WeightedVector& term : terms) sum = sum + term.weights[p] * term.vector;
      expected[p] = sum.x, expected[stride + p] = sum.y, expected[2 * stride + p] = sum.z;
    }
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      std::vector<float> sums(3 * stride);
      add_weighted(base, terms, sums.data(), stride);
      EXPECT_EQ(sums, expected) << target_name(target) << ", " << stride;
    }
  }
}

// Returns the vector of pose p. `planes` has the x of all `count` poses, then all y, then all z.
Vec3f at(const std::vector<float>& planes, std::size_t count, std::size_t p) {
  return {planes[p], planes[count + p], planes[2 * count + p]};
}

TEST(CompareNormals, has_the_bits_of_one_comparison_after_the_other_on_every_instruction_set) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  fixtures::Random random(12);
  for (const std::size_t count : {1U, 3U, 16U, 37U, 501U}) {
    std::vector<float> rendered(3 * count), right(3 * count), degrees(count), errors(3 * count);
    for (std::size_t p = 0; p < count; ++p) {
      const Vec3f u = p % 9 == 8 ? Vec3f{} : to_float(unit(to_double(any_vector(random))));
      Vec3f n = p % 11 == 10 ? Vec3f{} : p % 13 == 12 ? -u : p % 5 == 4 ? 3.0F * u : any_vector(random);
      if (p % 17 == 16) n.y = p % 2 == 0 ? kInfinity : std::numeric_limits<float>::quiet_NaN();
      rendered[p] = n.x, rendered[count + p] = n.y, rendered[2 * count + p] = n.z;
      right[p] = u.x, right[count + p] = u.y, right[2 * count + p] = u.z;
    }
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      const float largest = compare_normals({rendered.data(), &rendered[count], &rendered[2 * count]},
                                            {right.data(), &right[count], &right[2 * count]}, degrees,
                                            {errors.data(), &errors[count], &errors[2 * count]});
      float most = 0;
      for (std::size_t p = 0; p < count; ++p) {
        const Vec3f n = at(rendered, count, p), u = at(right, count, p), error = at(errors, count, p);
        if (u == Vec3f{}) {
          EXPECT_EQ(degrees[p], -1);
          EXPECT_TRUE(std::isnan(error.x) && std::isnan(error.y) && std::isnan(error.z));
          continue;
        }
        const float size = std::sqrt(dot(n, n));
        const bool is_lit = size > 0 && size < kInfinity;
        const Vec3f aside = cross(n, u);
        const double angle = portable::atan2(double{std::sqrt(dot(aside, aside))}, double{dot(n, u)});
        EXPECT_EQ(degrees[p], is_lit ? static_cast<float>(kDegreesPerRadian) * static_cast<float>(angle) : 180.0F)
            << target_name(target) << " " << p;
        const Vec3f expected = is_lit ? (1 / size) * n - u : Vec3f{} - 2.0F * u;
        EXPECT_EQ(error, expected) << target_name(target) << " " << p;
        most = std::fmax(most, dot(expected, expected));
      }
      EXPECT_EQ(largest, std::sqrt(most)) << target_name(target) << ", " << count;
    }
  }
}

// Returns the openness of the angle between two vectors, from the lengths of the sum and the difference of their
// directions.
double openness_of(const Vec3f& a, const Vec3f& b) {
  using Real = long double;
  const std::array<Real, 3> u = {a.x, a.y, a.z}, v = {b.x, b.y, b.z};
  const Real of_u = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]),
             of_v = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  if (of_u == 0 || of_v == 0) return 0;
  Real sum = 0, difference = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += std::pow(u[c] / of_u + v[c] / of_v, Real(2));
    difference += std::pow(u[c] / of_u - v[c] / of_v, Real(2));
  }
  const Real sine = std::sin(2 * std::atan2(std::sqrt(difference), std::sqrt(sum)));
  return static_cast<double>(difference <= sum ? sine * sine : 2 - sine * sine);
}

TEST(LargestOpenness, is_that_of_the_widest_angle_on_every_instruction_set) {
  constexpr std::uint64_t kSeed = 13;
  std::cout << "  from seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  for (int i = 0; i < 120; ++i) {
    const std::size_t count = kPosePadding * (1 + random.below(4));
    const double widest = random.uniform(0, 180);
    std::vector<float> a(3 * count), b(3 * count);
    double expected = 0;
    for (std::size_t p = 0; p < count; ++p) {
      const Vec3d u = unit(to_double(any_vector(random))), across = unit(cross(u, to_double(any_vector(random))));
      const double angle = random.uniform(0, widest) / kDegreesPerRadian;
      const double of_u = random.below(20) == 0 ? 0 : std::pow(10.0, random.uniform(-3, 3));
      const Vec3f from = to_float(of_u * u),
                  to = to_float(random.uniform(0.1, 10) * (std::cos(angle) * u + std::sin(angle) * across));
      a[p] = from.x, a[count + p] = from.y, a[2 * count + p] = from.z;
      b[p] = to.x, b[count + p] = to.y, b[2 * count + p] = to.z;
      expected = std::fmax(expected, openness_of(from, to));
    }
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      const float largest =
          largest_openness({a.data(), &a[count], &a[2 * count]}, {b.data(), &b[count], &b[2 * count]}, count);
      EXPECT_NEAR(largest, expected, 2e-6) << target_name(target) << ", " << i;
    }
  }
}

}  // namespace
}  // namespace chronormal::blended_normals_test
