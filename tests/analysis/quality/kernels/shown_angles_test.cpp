// Checks the angles that an audit computes in SIMD lanes. On every instruction set, the angles must have the same bits
// as the functions of core/vec3.h.
#include "analysis/quality/kernels/shown_angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/portable_math.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "simd/targets.h"
#include "tests/support/hard_motions.h"

namespace chronormal::shown_angles_test {
namespace {

TEST(TrianglesInMotion, have_the_bits_of_vector_areas_of_interpolated_positions_on_every_instruction_set) {
  fixtures::Random random(6);
  std::size_t judged = 0;
  for (const test::HardMotions& hard : test::hard_motions()) {
    const Motion motion = hard.make(random);
    if (!motion.topology.all_triangles()) continue;
    const Segment segment = motion.segment(0);
    const auto corners = motion.topology.corners();
    TrianglesInMotion triangles;
    triangles.gather(segment.to, segment.from, corners.first(3));  // fills the tiles with data of another segment
    triangles.gather(segment.from, segment.to, corners);
    std::vector<TrianglesInMotion::Normal> normals;
    for (const double t : {0.0, 0.35, 1.0}) {
      for (const std::int64_t target : supported_targets()) {
        const ScopedTarget scoped(target);
        triangles.normals(t, normals);
        ASSERT_EQ(normals.size(), motion.topology.face_count());
        for (std::size_t f = 0; f < normals.size(); ++f) {
          const auto at = [&](std::size_t c) {
            const std::uint32_t v = corners[3 * f + c];
            return lerp(to_double(segment.from[v]), to_double(segment.to[v]), t);
          };
          const Vec3d n = twice_vector_area(3, at);
          EXPECT_EQ((Vec3d{normals[f].x, normals[f].y, normals[f].z}), n) << hard.name << ", " << target_name(target);
          EXPECT_EQ(normals[f].size, max_abs(n));
          ++judged;
        }
      }
    }
  }
  EXPECT_GT(judged, 1000U);
}

TEST(SumsAround, have_the_bits_of_sums_from_left_to_right_on_every_instruction_set) {
  fixtures::Random random(9);
  const auto number = [&random] { return std::pow(10.0, random.uniform(-9, 9)) * random.uniform(-1, 1); };
  std::vector<TrianglesInMotion::Normal> normals(100);
  for (auto& n : normals) n = {number(), number(), number(), number()};
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<std::uint32_t> faces, ends;
    for (std::size_t e = 0; e < count; ++e) {
      const std::size_t around = random.below(9);  // sometimes 0
      for (std::size_t i = 0; i < around; ++i) faces.push_back(static_cast<std::uint32_t>(random.below(100)));
      ends.push_back(static_cast<std::uint32_t>(faces.size()));
    }
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      PlanesOf4 sums;
      sums_around(normals, faces, ends, sums);
      ASSERT_EQ(sums.x.size(), count);
      for (std::size_t e = 0, i = 0; e < count; ++e) {
        double x = 0, y = 0, z = 0, size = 0;
        for (; i < ends[e]; ++i) {
          x += normals[faces[i]].x, y += normals[faces[i]].y, z += normals[faces[i]].z;
          size += normals[faces[i]].size;
        }
        ASSERT_EQ((Vec3d{sums.x[e], sums.y[e], sums.z[e]}), (Vec3d{x, y, z})) << target_name(target) << " " << e;
        ASSERT_EQ(sums.w[e], size);
      }
    }
  }
}

void put(PlanesOf4& planes, std::size_t i, const Vec3d& v, double w) {
  planes.x[i] = v.x, planes.y[i] = v.y, planes.z[i] = v.z, planes.w[i] = w;
}

TEST(ShownAngles, have_the_bits_of_one_angle_after_the_other_on_every_instruction_set) {
  fixtures::Random random(7);
  constexpr std::size_t kCount = 1003;
  constexpr double kRounding = 1e-13;
  const auto vector = [&] {
    const fixtures::Point p = random.in_cube(std::pow(10.0, random.uniform(-20, 20)));
    return Vec3d{p[0], p[1], p[2]};
  };
  PlanesOf4 from, to, right;
  for (PlanesOf4* const planes : {&from, &to, &right}) planes->resize(kCount);
  std::vector<Vec3d> starts(kCount), ends(kCount), sums(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    starts[i] = i % 10 == 0 ? Vec3d{} : unit(vector());
    ends[i] = i % 20 < 2 ? -starts[i] : unit(starts[i] + random.uniform(0, 1) * unit(vector()));
    sums[i] = i % 15 == 0 ? Vec3d{} : vector();
    const double size = max_abs(sums[i]);
    // The fourth values of `from` and `right` are chosen so that some elements have no certain normal, some normals are
    // hardly more than rounding error, and some elements have no face that is drawn.
    put(from, i, starts[i], i % 4 == 0 ? 2 * size : 0.3 * size);
    put(to, i, ends[i], 0);
    put(right, i, sums[i], i % 6 == 0 ? 1e14 * size : i % 8 == 0 ? 4 * size : size);
  }
  std::size_t not_lit = 0, not_judged = 0;
  for (const double t : {0.0, 0.5, 0.7}) {
    std::vector<double> expected(kCount), degrees(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      const Vec3d shown = to_double(to_float(unit(lerp(starts[i], ends[i], t))));
      const Vec3d normal = without_rounding(sums[i], kRounding * right.w[i]);
      const bool is_drawn = right.w[i] > from.w[i], has_normal = length(normal) > from.w[i];
      expected[i] = is_drawn && shown == Vec3d{} ? kNotLit
                    : !is_drawn || !has_normal   ? kNotJudged
                                                 : angle_between(shown, unit(normal)) * kDegreesPerRadian;
      not_lit += expected[i] == kNotLit ? 1U : 0U;
      not_judged += expected[i] == kNotJudged ? 1U : 0U;
    }
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      shown_angles({from, to, right, kRounding}, t, degrees);
      EXPECT_EQ(degrees, expected) << target_name(target) << " at " << t;
    }
  }
  EXPECT_GT(not_lit, 50U);
  EXPECT_GT(not_judged, 500U);
}

TEST(AnglesOfPairs, have_the_bits_of_one_angle_after_the_other_on_every_instruction_set) {
  fixtures::Random random(8);
  const auto vector = [&] {
    const fixtures::Point p = random.in_cube(std::pow(10.0, random.uniform(-20, 20)));
    return Vec3d{p[0], p[1], p[2]};
  };
  for (const std::size_t count : {0U, 1U, 3U, 7U, 8U, 501U}) {
    std::vector<Vec3d> a(count), b(count);
    std::vector<double> expected(count), degrees(count);
    for (std::size_t i = 0; i < count; ++i) {
      a[i] = i % 10 == 3 ? Vec3d{} : vector();
      b[i] = i % 10 == 4 ? Vec3d{} : i % 10 == 5 ? a[i] : i % 10 == 6 ? -a[i] : vector();
      if (i % 3 == 0) b[i] = a[i] + 1e-7 * random.uniform(0, 1) * b[i];
      expected[i] = angle_between(a[i], b[i]) * kDegreesPerRadian;
    }
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      angles_of_pairs(a, b, degrees);
      EXPECT_EQ(degrees, expected) << target_name(target) << ", " << count;
    }
  }
}

TEST(UpperAngles, have_the_bits_of_one_arc_tangent_after_the_other_on_every_instruction_set) {
  fixtures::Random random(9);
  std::vector<double> y = {0, 0, 1, 1, 0, 2, 1e300}, x = {0.0, -0.0, 0.0, -0.0, -3, 2, -1e-300};
  for (int i = 0; i < 500; ++i) {
    y.push_back(std::pow(10.0, random.uniform(-9, 9)));
    x.push_back(random.uniform(-1, 1) * std::pow(10.0, random.uniform(-9, 9)));
  }
  std::vector<double> expected, angles(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) expected.push_back(portable::atan2(y[i], x[i]));
  for (const std::int64_t target : supported_targets()) {
    const ScopedTarget scoped(target);
    upper_angles(y, x, angles);
    EXPECT_EQ(angles, expected) << target_name(target);
    constexpr double kInfinity = std::numeric_limits<double>::infinity(),
                     kNan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> odd_y = {kInfinity, kNan, 1, kNan, 0}, odd_x = {kInfinity, 1, kNan, kNan, kNan};
    std::vector<double> odd(odd_y.size());
    upper_angles(odd_y, odd_x, odd);
    for (const double angle : odd) EXPECT_TRUE(std::isnan(angle)) << target_name(target);
  }
}

}  // namespace
}  // namespace chronormal::shown_angles_test
