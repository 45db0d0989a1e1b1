// Comparisons on curved paths: every scheme has the figures that are computed here from positions, and the exact curve
// has none but rounding.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "chronormal/normals/path_curves.h"
#include "chronormal/workflow/compare.h"
#include "tests/support/curved_motion.h"

namespace chronormal::curved_compare_test {
namespace {

const std::vector<double> kTimes = {0, 0.2, 0.5, 0.7, 1};

Comparison compared(const Motion& motion, PathKind path, ElementKind kind) {
  CompareOptions options;
  options.schemes = {"linear", "polynomial"};
  options.samples = 5;
  options.elements.kind = kind;
  options.path = path;
  Result<Comparison> result = compare(motion, options);
  EXPECT_TRUE(result.ok()) << result.error().text();
  return result.ok() ? std::move(result).value() : Comparison();
}

// The mean errors, in radians, of nlerp and of normals that are exact on straight paths.
struct Means {
  double linear = 0, straight = 0;
};
Means means_by_hand(const Motion& motion, bool given, bool of_vertices) {
  double linear = 0, straight = 0;
  std::size_t count = 0;
  for (std::size_t s = 0; s + 1 < motion.keyframes.size(); ++s) {
    const auto start = test::normals_of(motion, test::on_curve(motion, s, 0), of_vertices),
               end = test::normals_of(motion, test::on_curve(motion, s, 1), of_vertices);
    for (int i = 0; i < 5; ++i) {
      const long double t = i / 4.0L;
      const auto right = test::normals_of(motion, test::on_curve(motion, s, t, given), of_vertices);
      std::vector<long double> between;
      for (std::size_t c = 0; c < motion.keyframes[s].positions.size(); ++c)
        between.push_back((1 - t) * static_cast<long double>(motion.keyframes[s].positions[c]) +
                          t * static_cast<long double>(motion.keyframes[s + 1].positions[c]));
      const auto on_line = test::normals_of(motion, between, of_vertices);
      for (std::size_t e = 0; e < right.size(); ++e) {
        std::array<long double, 3> nlerp;
        const auto length = [](const auto& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); };
        for (std::size_t c = 0; c < 3; ++c)
          nlerp[c] = (1 - t) * start[e][c] / length(start[e]) + t * end[e][c] / length(end[e]);
        linear += test::angle_of(nlerp, right[e]);
        straight += test::angle_of(on_line[e], right[e]);
        ++count;
      }
    }
  }
  return {linear / static_cast<double>(count), straight / static_cast<double>(count)};
}

TEST(CurvedCompare, holds_every_scheme_against_the_normals_of_the_curve) {
  Motion motion = test::curved_motion(kTimes, 1.5);
  for (Motion::Keyframe& key : motion.keyframes)
    for (std::size_t c = 0; c < key.positions.size(); ++c)
      key.velocities.push_back(key.positions[(c + 5) % key.positions.size()]);
  motion.keyframes[1].velocities.clear();  // the velocities of Catmull-Rom are used here
  for (const bool given : {false, true}) {
    for (const bool of_vertices : {false, true}) {
      const Comparison comparison = compared(motion, given ? PathKind::kHermite : PathKind::kCatmullRom,
                                             of_vertices ? ElementKind::kVertices : ElementKind::kFaces);
      ASSERT_EQ(comparison.schemes.size(), 3U);
      const Means means = means_by_hand(motion, given, of_vertices);
      EXPECT_NEAR(comparison.schemes[0].quality.mean(), means.linear, 1e-6) << given << of_vertices;
      EXPECT_NEAR(comparison.schemes[1].quality.mean(), means.straight, 1e-6) << given << of_vertices;
      EXPECT_GT(means.linear, 0.002) << "there is something to see";
      EXPECT_EQ(comparison.schemes[2].scheme, "exact");
      EXPECT_LT(comparison.schemes[2].quality.max, 1.1 * kPathAngle);
      EXPECT_GT(comparison.schemes[2].quality.count, 0U);
    }
  }
}

TEST(CurvedCompare, tells_how_far_the_path_bends) {
  // A point that turns by an angle from keyframe to keyframe bends by the sine of half of it; swelling adds a little.
  const Comparison dense =
      compared(test::curved_motion({0, 0.25, 0.5, 0.75, 1}, 0.8), PathKind::kCatmullRom, ElementKind::kFaces);
  EXPECT_GT(dense.bend, 0.05);
  EXPECT_LT(dense.bend, kTooSparse);
  const Comparison sparse =
      compared(test::curved_motion({0, 0.25, 0.5, 0.75, 1}, 8), PathKind::kCatmullRom, ElementKind::kFaces);
  EXPECT_GT(sparse.bend, kTooSparse);
}

TEST(CurvedCompare, refuses_what_has_no_meaning_on_curves) {
  const Motion motion = test::curved_motion(kTimes, 1.5, 6, 4);
  CompareOptions options;
  options.path = PathKind::kHermite;
  EXPECT_EQ(compare(motion, options).error().code, ErrorCode::kUsage) << "no velocities";
  Motion targets = motion;
  for (std::size_t k = 1; k < targets.keyframes.size(); ++k) targets.keyframes[k].time = 1;
  targets.connect_as_targets();
  options.path = PathKind::kCatmullRom;
  EXPECT_EQ(compare(targets, options).error().code, ErrorCode::kUsage) << "weights move vertices straight";
}

}  // namespace
}  // namespace chronormal::curved_compare_test
