// Tests whether results keep their guarantees after the caller has changed the mode of the floating-point unit
// (rounding, subnormal numbers). control_normals.h states the guarantee for each mode.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <limits>
#include <vector>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/recompute/recompute.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"

namespace chronormal::floating_point_modes_test {
namespace {

// Returns the normals of all faces and all vertices at one t, both from curves and recomputed from positions.
std::vector<float> everything(const Segment& segment, double t) {
  const Topology& topology = *segment.topology;
  const NormalGroups groups = NormalGroups::of_vertices(topology, separate_points(topology.vertex_count()));
  const std::size_t faces = topology.face_count(), vertices = groups.size();
  std::vector<float> all(6 * (faces + vertices));
  float* at = all.data();
  const auto next = [&at](std::size_t count) {
    const auto view = VectorView<float>::packed(at, count);
    at += 3 * count;
    return view;
  };
  NormalCurves::of_faces(segment).unit_normals(t, next(faces));
  NormalCurves::of_groups(segment, groups).unit_normals(t, next(vertices));
  NormalRecompute(segment).unit_normals(t, next(faces));
  NormalRecompute(segment, groups).unit_normals(t, next(vertices));
  return all;
}

#if defined(__SSE__)
constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;

class ScopedControl {
 public:
  explicit ScopedControl(unsigned bits) : before_(_mm_getcsr()) { _mm_setcsr(before_ | bits); }
  ScopedControl(const ScopedControl&) = delete;
  ScopedControl& operator=(const ScopedControl&) = delete;
  ~ScopedControl() { _mm_setcsr(before_); }

 private:
  unsigned before_;
};

// The coordinates of the meshes in this test are normal floating-point numbers, but so small that their squares may
// underflow.
TEST(FlushToZero, changes_no_bit_where_coordinates_are_normal) {
  fixtures::Random random(61);
  std::vector<Motion> motions = {fixtures::smooth_morph(8), fixtures::tiny_soup(50),
                                 fixtures::collapsing_soup(1e-5, 50),
                                 fixtures::soup({.face_count = 50, .seed = 62, .size = 1e-20}),
                                 fixtures::soup({.face_count = 50, .seed = 63, .size = 1e-37})};
  for (const auto& family : test::hard_motions()) {
    for (int i = 0; i < 10; ++i) motions.push_back(family.make(random));
  }
  std::size_t judged = 0;
  for (const Motion& motion : motions) {
    bool has_subnormal = false;
    for (const auto& keyframe : motion.keyframes) {
      for (const float x : keyframe.positions)
        has_subnormal |= x != 0 && std::fabs(x) < std::numeric_limits<float>::min();
    }
    if (has_subnormal) continue;
    ++judged;
    for (const double t : {0.0, 0.3, 0.5, 1e-300}) {
      const std::vector<float> expected = everything(motion.segment(0), t);
      const ScopedControl scoped(kFlushToZero | kDenormalsAreZero);
      ASSERT_EQ(everything(motion.segment(0), t), expected) << "motion " << judged << ", t = " << t;
    }
  }
  EXPECT_GT(judged, 100u);
}
#endif

class ScopedRounding {
 public:
  explicit ScopedRounding(int mode) : before_(std::fegetround()) { std::fesetround(mode); }
  ScopedRounding(const ScopedRounding&) = delete;
  ScopedRounding& operator=(const ScopedRounding&) = delete;
  ~ScopedRounding() { std::fesetround(before_); }

 private:
  int before_;
};

TEST(RoundingMode, other_than_to_nearest_costs_no_more_than_a_factor_of_two) {
  constexpr double kPromised = 2e-6;
  fixtures::Random random(64);
  double largest = 0;
  for (const auto& family : test::hard_motions()) {
    for (int i = 0; i < 12; ++i) {
      const Motion motion = family.make(random);
      const Segment segment = motion.segment(0);
      const test::IntegerNormals oracle(segment);
      for (const double t : {0.0, 0.3, random.uniform(0, 1)}) {
        const auto normals = oracle.at(test::IntegerTime::of(t));
        const std::size_t faces = normals.size();
        for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
          std::vector<float> curves(3 * faces), anew(3 * faces);
          const auto curve_view = VectorView<float>::packed(curves.data(), faces),
                     anew_view = VectorView<float>::packed(anew.data(), faces);
          {
            const ScopedRounding scoped(mode);
            NormalCurves::of_faces(segment).unit_normals(t, curve_view);
            NormalRecompute(segment).unit_normals(t, anew_view);
          }
          for (std::size_t f = 0; f < faces; ++f) {
            if (test::is_zero(normals[f])) continue;
            const auto direction = test::direction_of(normals[f]);
            const double angle =
                std::max(test::angle_between(curve_view[f], direction), test::angle_between(anew_view[f], direction));
            ASSERT_LE(angle, kPromised) << family.name << ", t = " << t;
            largest = std::max(largest, angle);
          }
        }
      }
    }
  }
  std::cout << "  largest error " << largest << " rad\n";
}

}  // namespace
}  // namespace chronormal::floating_point_modes_test
