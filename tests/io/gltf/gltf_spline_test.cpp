// Tests cubic splines of weights. The reader divides a spline into straight pieces and returns a bound for the error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "chronormal/motion/motion.h"
#include "io/gltf/gltf_motion.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_weights.h"

namespace chronormal::gltf_spline_test {
namespace {

using test::GltfBuilder, test::GltfFixture;

struct Spline {
  std::vector<float> times, values;  // (K) and (K, 3, 2): in-tangent, value, out-tangent of 2 targets
};

GltfMotion cut(const Spline& spline, double tolerance) {
  GltfBuilder builder = test::quad_document();
  builder.add_track(builder.add_animation("curve"), 0, spline.times, spline.values, "CUBICSPLINE");
  const GltfFixture file(builder);
  EXPECT_TRUE(file.ok()) << file.error();
  GltfMotionOptions options;
  options.animation = "curve";
  options.curve_tolerance = tolerance;
  Result<GltfMotion> motion = read_gltf_motion(*file, options);
  EXPECT_TRUE(motion.ok()) << motion.error().text();
  return motion ? std::move(motion).value() : GltfMotion{};
}

// Returns the largest distance between a vertex of the motion and its true position on the spline, at 1,001 equidistant
// times.
double largest_distance(const Spline& spline, const Motion& motion) {
  double largest = 0;
  const double first = spline.times.front(), last = spline.times.back();
  for (int i = 0; i <= 1000; ++i) {
    const double time = first + (last - first) * i / 1000;
    const std::vector<double> weights =
        test::weights_at(GltfInterpolation::kCubicSpline, spline.times, spline.values, 2, time);
    const std::vector<double> expected = test::morphed(test::kQuad, {test::kLift, test::kShift}, weights);
    const std::vector<double> read = test::positions_at(motion, time);
    if (read.size() != expected.size()) return INFINITY;
    for (std::size_t v = 0; v < expected.size(); v += 3)
      largest = std::max(
          largest, std::hypot(read[v] - expected[v], read[v + 1] - expected[v + 1], read[v + 2] - expected[v + 2]));
  }
  return largest;
}

// Returns a bound for the error, as a distance, of rounding the positions of the keyframes to float32.
double rounding(const Motion& motion) {
  double largest = 0;
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    for (const float x : keyframe.positions) largest = std::max(largest, std::fabs(static_cast<double>(x)));
  }
  return largest * 0x1p-23;
}

double diagonal() { return std::sqrt(1 + 1 + 0.25); }  // the diagonal of kQuad

TEST(GltfSpline, that_overshoots_is_within_the_stated_error) {
  const Spline spline = {{0, 1, 3}, {0, 0, 0, 0, 4, -2, /**/ -1, 3, 1, 0.5F, 6, 0, /**/ 2, 2, 0, 1, 0, 0}};
  for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
    const GltfMotion result = cut(spline, tolerance);
    ASSERT_FALSE(result.motion.keyframes.empty());
    EXPECT_TRUE(validate(result.motion).ok());
    EXPECT_GT(result.curve_error, 0);
    EXPECT_LE(result.curve_error, tolerance * diagonal() * 1.0001);
    const double distance = largest_distance(spline, result.motion);
    EXPECT_LE(distance, result.curve_error + rounding(result.motion));
    // The stated error must not be needlessly large: the true distance is at least a tenth of the stated error.
    if (tolerance > 1e-4) {
      EXPECT_GE(distance, result.curve_error / 10);
    }
  }
}

TEST(GltfSpline, keeps_its_keys) {
  const Spline spline = {{0, 1, 3}, {0, 0, 0, 0, 4, -2, /**/ -1, 3, 1, 0.5F, 6, 0, /**/ 2, 2, 0, 1, 0, 0}};
  const GltfMotion result = cut(spline, 1e-3);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& keyframes = result.motion.keyframes;
    const auto found = std::find_if(keyframes.begin(), keyframes.end(), [&](const auto& keyframe) {
      return keyframe.time == static_cast<double>(spline.times[k]);
    });
    ASSERT_NE(found, keyframes.end()) << k;
    const std::vector<double> expected =
        test::morphed(test::kQuad, {test::kLift, test::kShift}, {spline.values[6 * k + 2], spline.values[6 * k + 3]});
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(static_cast<double>(found->positions[i]), expected[i], 1e-6) << k;
  }
}

TEST(GltfSpline, random_ones_are_within_the_stated_error) {
  std::mt19937 random(20240602);
  const auto number = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() % 100001) / 100000.0F;
  };
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    Spline spline;
    const std::size_t keys = 2 + random() % 4;
    const float scale = std::ldexp(1.0F, static_cast<int>(random() % 13) - 6);
    for (std::size_t k = 0; k < keys; ++k) {
      spline.times.push_back(k == 0 ? number(0, 2) : spline.times.back() + number(1e-3F, 2));
      for (int i = 0; i < 6; ++i) spline.values.push_back(scale * number(-1, 1));
    }
    const GltfMotion result = cut(spline, 1e-4);
    ASSERT_FALSE(result.motion.keyframes.empty());
    EXPECT_LE(result.curve_error, 1e-4 * 1.0001 * diagonal());
    EXPECT_LE(largest_distance(spline, result.motion), result.curve_error + rounding(result.motion));
  }
}

TEST(GltfSpline, straight_one_is_not_cut) {
  // The tangents have the slope of the straight line between the keys, so the spline is that line.
  const Spline spline = {{0, 2, 3}, {0, 0, 0, 0, 0.5F, 0, /**/ 0.5F, 0, 1, 0, 0, 0, /**/ 0, 0, 1, 0, 0, 0}};
  const GltfMotion result = cut(spline, 1e-5);
  EXPECT_EQ(result.motion.segments.size(), 2U);
  EXPECT_LE(result.curve_error, 1e-12);
  EXPECT_LE(largest_distance(spline, result.motion), 1e-6);
}

TEST(GltfSpline, finer_tolerance_makes_more_pieces) {
  const Spline spline = {{0, 1}, {0, 0, 0, 0, 3, 0, /**/ -3, 0, 1, 0, 0, 0}};
  const std::size_t coarse = cut(spline, 1e-2).motion.segments.size(), fine = cut(spline, 1e-4).motion.segments.size();
  EXPECT_NEAR(static_cast<double>(fine) / static_cast<double>(coarse), 10, 3);
}

TEST(GltfSpline, normalised_integers_are_tangents_and_values) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<std::int8_t>(builder.add_animation(""), 0, {0, 1}, {0, 0, 127, -127, 127, 0, 0, 0, -128, 0, 0, 0},
                                 "CUBICSPLINE");
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_EQ(file->animations()[0].tracks[0].interpolation, GltfInterpolation::kCubicSpline);
  const Result<GltfKeys> keys = file->keys(0, 0);
  ASSERT_TRUE(keys.ok()) << keys.error().text();
  EXPECT_EQ(keys.value().values, (std::vector<double>{0, 0, 1, -1, 1, 0, 0, 0, -1, 0, 0, 0}));
}

TEST(GltfSpline, beside_a_step_and_a_line_is_cut_at_all_keys) {
  GltfBuilder builder = test::quad_document();
  builder.add_node(0);
  builder.add_node(0);
  const std::size_t animation = builder.add_animation("three");
  const Spline spline = {{0, 2}, {0, 0, 0, 0, 1, 0, /**/ 1, 0, 1, 1, 0, 0}};
  builder.add_track(animation, 0, spline.times, spline.values, "CUBICSPLINE");
  builder.add_track<float>(animation, 1, {0, 0.5F, 2}, {0, 0, 1, 0, 0, 1}, "STEP");
  builder.add_track<float>(animation, 2, {0.25F, 1.75F}, {0, 0, 1, 1});
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  GltfMotionOptions options;
  options.animation = "three";
  options.curve_tolerance = 1e-3;
  const Result<GltfMotion> result = read_gltf_motion(*file, options);
  ASSERT_TRUE(result.ok()) << result.error().text();
  EXPECT_TRUE(validate(result.value().motion).ok());
  for (int i = 0; i < 1000; ++i) {
    const double time = 2 * (i + 0.5) / 1000;
    std::vector<double> expected;
    for (const auto& weights : {test::weights_at(GltfInterpolation::kCubicSpline, spline.times, spline.values, 2, time),
                                test::weights_at(GltfInterpolation::kStep, {0, 0.5F, 2}, {0, 0, 1, 0, 0, 1}, 2, time),
                                test::weights_at(GltfInterpolation::kLinear, {0.25F, 1.75F}, {0, 0, 1, 1}, 2, time)}) {
      const std::vector<double> more = test::morphed(test::kQuad, {test::kLift, test::kShift}, weights);
      expected.insert(expected.end(), more.begin(), more.end());
    }
    const std::vector<double> read = test::positions_at(result.value().motion, time);
    ASSERT_EQ(read.size(), expected.size());
    for (std::size_t k = 0; k < read.size(); ++k)
      EXPECT_NEAR(read[k], expected[k], (k < 12 ? result.value().curve_error : 0) + 1e-6) << time;
  }
}

TEST(GltfSpline, one_that_would_need_too_much_memory_is_refused) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("wild"), 0, {0, 1}, {0, 0, 0, 0, 1e30F, 0, 0, 0, 0, 0, 0, 0},
                           "CUBICSPLINE");
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  GltfMotionOptions options;
  options.animation = "wild";
  const Result<GltfMotion> result = read_gltf_motion(*file, options);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidInput);
  EXPECT_TRUE(result.error().place.starts_with("a.gltf")) << result.error().text();
}

TEST(GltfSpline, that_would_need_more_pieces_than_any_is_refused_at_once) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("steep"), 0, {0, 1}, {0, 0, 0, 0, 1e9F, 0, 0, 0, 0, 0, 0, 0},
                           "CUBICSPLINE");
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  GltfMotionOptions options;
  options.animation = "steep";
  const Result<GltfMotion> motion = read_gltf_motion(*file, options);
  ASSERT_FALSE(motion.ok());
  EXPECT_EQ(motion.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(motion.error().place.find("/animations/"), std::string::npos);
}

}  // namespace
}  // namespace chronormal::gltf_spline_test
