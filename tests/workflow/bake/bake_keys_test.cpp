// Checks the encoding `keys`: a sequence baked with as few keys as the tolerance allows follows the motion in a viewer
// that interpolates linearly.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/workflow/bake.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference.h"
#include "tests/support/shown_glb.h"

namespace chronormal::bake_keys_test {
namespace {

using reference::VectorD;
using test::ShownGlb;

constexpr double kPerDegree = 3.14159265358979323846 / 180;

struct Keys {
  SequenceBake report;
  std::string glb;
};

Keys keys_of(const Motion& motion, double tolerance) {
  BakeOptions options;
  options.encoding = BakeEncoding::kKeys;
  options.tolerance = tolerance;
  Keys keys;
  Result<SequenceBake> baked = bake_sequence(motion, options, keys.glb);
  EXPECT_TRUE(baked) << baked.error().text();
  if (baked) keys.report = std::move(baked).value();
  return keys;
}

// Returns the positions of a motion at a time, in double.
std::vector<VectorD> positions_at(const Motion& motion, double time) {
  std::size_t k = 0;
  while (k + 2 < motion.keyframes.size() && time >= motion.keyframes[k + 1].time) ++k;
  const Motion::Keyframe &from = motion.keyframes[k], &to = motion.keyframes[k + 1];
  const double t = (time - from.time) / (to.time - from.time);
  std::vector<VectorD> result(motion.topology.vertex_count());
  for (std::size_t v = 0; v < result.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c)
      result[v][c] = (1 - t) * double{from.positions[3 * v + c]} + t * double{to.positions[3 * v + c]};
  }
  return result;
}

// The largest angle in degrees between the normals of the file and the vertex normals of the motion, and the largest
// distance between a vertex of the file and its place in the motion. The size of the mesh is about 1.
struct Off {
  double degrees = 0, distance = 0;
};

Off off(const Motion& motion, const ShownGlb& glb, int times) {
  Off worst;
  for (int i = 0; i <= times; ++i) {
    const double time = motion.keyframes.back().time * i / times;
    const std::vector<double> weights = glb.weights(time);
    const std::vector<VectorD> positions = positions_at(motion, time);
    std::vector<VectorD> normals(positions.size(), VectorD{});
    for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
      const auto face = motion.topology.face(f);
      const VectorD n = reference::cross(reference::subtract(positions[face[1]], positions[face[0]]),
                                         reference::subtract(positions[face[2]], positions[face[0]]));
      for (const std::uint32_t v : face) normals[v] = reference::add(normals[v], n);
    }
    for (std::size_t v = 0; v < positions.size(); ++v) {
      worst.degrees = std::max(worst.degrees, reference::angle(glb.normal(v, weights), normals[v]) / kPerDegree);
      worst.distance =
          std::max(worst.distance, reference::length(reference::subtract(glb.position(v, weights), positions[v])));
    }
  }
  return worst;
}

// Samples a motion of one segment at equal intervals, as a program that exports frames does.
Motion sampled(const Motion& motion, std::size_t frames) {
  Motion result = motion;
  result.keyframes.clear();
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(frames - 1);
    Motion::Keyframe& keyframe = result.keyframes.emplace_back();
    keyframe.time = t;
    for (const VectorD& p : positions_at(motion, t)) {
      for (const double c : p) keyframe.positions.push_back(static_cast<float>(c));
    }
  }
  result.connect_as_sequence();
  return result;
}

Motion wandering(std::size_t keys) {
  const fixtures::ClosedMesh mesh = fixtures::icosphere(2);
  Motion motion;
  motion.topology = mesh.topology;
  fixtures::Random random(71);
  for (std::size_t k = 0; k < keys; ++k) {
    Motion::Keyframe& key = motion.keyframes.emplace_back();
    key.time = static_cast<double>(k);
    for (const auto& point : mesh.points) {
      for (const double c : point) key.positions.push_back(static_cast<float>(c + random.uniform(-0.06, 0.06)));
    }
  }
  motion.connect_as_sequence();
  return motion;
}

TEST(BakeKeys, shown_as_straight_lines_are_within_the_tolerance_at_every_instant) {
  const Motion motion = wandering(4);
  std::size_t before = 1000;
  for (const double tolerance : {0.2, 1.0, 3.0}) {
    const Keys keys = keys_of(motion, tolerance);
    ASSERT_TRUE(keys.report.keys);
    const ShownGlb glb(keys.glb);
    EXPECT_EQ(glb.times.size(), keys.report.keys->count);
    EXPECT_EQ(keys.report.targets + 1, keys.report.keys->count);
    EXPECT_EQ(keys.report.keys->left_out, 0U);
    EXPECT_EQ(keys.report.keys->beyond, 0U);
    EXPECT_EQ(keys.report.keys->count, 4 + keys.report.keys->in_between);
    EXPECT_LE(keys.report.largest_error, tolerance);
    const Off worst = off(motion, glb, 300);
    EXPECT_LE(worst.degrees, keys.report.largest_error + 1e-3);
    EXPECT_GT(worst.degrees, 0.2 * tolerance);
    EXPECT_LT(worst.distance, 1e-6);
    EXPECT_LE(keys.report.keys->count, keys.report.keys->even);
    EXPECT_LE(keys.report.keys->count, before) << "a wider tolerance takes no more keys";
    before = keys.report.keys->count;
  }
}

TEST(BakeKeys, keyframes_that_lie_on_lines_are_left_out) {
  const Motion motion = fixtures::smooth_morph(8);
  const Motion frames = sampled(motion, 25);
  const Keys keys = keys_of(frames, 1);
  EXPECT_GT(keys.report.keys->left_out, 10U);
  EXPECT_LT(keys.report.keys->count, 15U);
  EXPECT_EQ(keys.report.keys->even, 25U);
  const Off worst = off(motion, ShownGlb(keys.glb), 200);
  EXPECT_LE(worst.degrees, 1 + 1e-3);
  EXPECT_LT(worst.distance, 1e-5);
  // A keyframe that is not on the straight line between its neighbours must be kept.
  Motion bumped = frames;
  bumped.keyframes[7].positions[30] += 0.01F;
  const ShownGlb glb(keys_of(bumped, 1).glb);
  EXPECT_NE(std::find(glb.times.begin(), glb.times.end(), static_cast<float>(7.0 / 24)), glb.times.end());
  EXPECT_LE(off(bumped, glb, 240).degrees, 1 + 1e-3);
}

TEST(BakeKeys, no_key_could_be_spared) {
  const Motion motion = fixtures::smooth_morph(6);
  const double tolerance = 0.5;
  const Keys keys = keys_of(motion, tolerance);
  ShownGlb glb(keys.glb);
  // Every key must be needed: without the key, linear interpolation between its two neighbours would exceed the
  // tolerance at some normal.
  const std::vector<float> times = glb.times;
  ASSERT_GT(times.size(), 3U);
  for (std::size_t k = 1; k + 2 < times.size(); ++k) {
    double worst = 0;
    for (int i = 0; i <= 20; ++i) {
      const double share = i / 20.0, time = times[k - 1] + share * double{times[k + 1] - times[k - 1]};
      const auto from = glb.weights(times[k - 1]), to = glb.weights(times[k + 1]);
      const auto exact = glb.weights(time);
      for (std::size_t v = 0; v < glb.vertices(); ++v) {
        VectorD line{};
        const VectorD a = glb.normal(v, from), b = glb.normal(v, to);
        for (std::size_t c = 0; c < 3; ++c) line[c] = (1 - share) * a[c] + share * b[c];
        worst = std::max(worst, reference::angle(line, glb.normal(v, exact)) / kPerDegree);
      }
    }
    EXPECT_GT(worst, 0.4 * tolerance) << k;
  }
}

TEST(BakeKeys, collapses_are_left_out_and_counted) {
  std::vector<fixtures::Point> from{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, to{{0, 0, 0}, {1, 0, 0}, {0, -3, 0}};
  const Motion motion = fixtures::make_motion(fixtures::make_triangles(3, {0, 1, 2}), from, to);
  const Keys keys = keys_of(motion, 0.5);
  EXPECT_EQ(keys.report.keys->beyond, 3U) << "three vertices in one segment";
  ASSERT_FALSE(keys.report.warnings.empty());
  EXPECT_NE(keys.report.warnings.front().find("in 3 cases, a normal vanishes or turns too fast"), std::string::npos);
}

TEST(BakeKeys, other_weights_and_no_tolerance_at_all_are_refused) {
  BakeOptions options;
  options.encoding = BakeEncoding::kKeys;
  std::string glb;
  const Motion motion = fixtures::smooth_morph(4);
  options.weighting = Weighting::kAngle;
  EXPECT_EQ(bake_sequence(motion, options, glb).error().code, ErrorCode::kUsage);
  options.weighting = {};
  options.tolerance = 0;
  EXPECT_EQ(bake_sequence(motion, options, glb).error().code, ErrorCode::kUsage);
}

TEST(BakeKeys, there_must_be_times_for_them_in_float32) {
  Motion motion = fixtures::smooth_morph(4);
  motion.keyframes[0].time = 1000000;
  motion.keyframes[1].time = 1000000.0625;  // the next float after 1000000
  motion.connect_as_sequence();
  BakeOptions options;
  options.encoding = BakeEncoding::kKeys;
  options.tolerance = 0.1;
  std::string glb;
  const Result<SequenceBake> baked = bake_sequence(motion, options, glb);
  ASSERT_FALSE(baked);
  EXPECT_EQ(baked.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(baked.error().place, "keyframe 0");
}

}  // namespace
}  // namespace chronormal::bake_keys_test
