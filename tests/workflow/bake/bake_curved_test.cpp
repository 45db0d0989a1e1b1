// Baked sequences on curved paths, as a reader shows them that does not know how they were made: positions are those of
// the curves, and normals are within the error that the bake states.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"
#include "tests/support/curved_motion.h"
#include "tests/support/shown_glb.h"

namespace chronormal::bake_curved_test {
namespace {

using test::ShownGlb;

const std::vector<double> kTimes = {0, 0.25, 0.5, 0.875, 1.25, 1.5};

struct Baked {
  SequenceBake report;
  std::string glb;
};

Baked baked(const Motion& motion, PathKind path, double tolerance) {
  BakeOptions options;
  options.path = path;
  options.tolerance = tolerance;
  Baked result;
  Result<SequenceBake> report = bake_sequence(motion, options, result.glb);
  EXPECT_TRUE(report.ok()) << report.error().text();
  if (report.ok()) result.report = std::move(report).value();
  return result;
}

// The largest distance of vertices from the curve, and the largest error of normals in degrees, at instants within
// segments.
struct Worst {
  double distance = 0, angle = 0;
};
Worst worst_of(const Motion& motion, const ShownGlb& glb, bool given, int instants) {
  Worst worst;
  for (std::size_t s = 0; s + 1 < motion.keyframes.size(); ++s) {
    for (int i = 0; i <= instants; ++i) {
      const double t = static_cast<double>(i) / instants;
      const std::vector<long double> right = test::on_curve(motion, s, static_cast<long double>(t), given);
      const auto normals = test::normals_of(motion, right, true);
      const std::vector<double> weights =
          glb.weights((1 - t) * motion.keyframes[s].time + t * motion.keyframes[s + 1].time);
      for (std::size_t v = 0; v < glb.vertices(); ++v) {
        const auto p = glb.position(v, weights);
        for (std::size_t c = 0; c < 3; ++c)
          worst.distance = std::max(worst.distance, std::fabs(p[c] - static_cast<double>(right[3 * v + c])));
        worst.angle = std::max(worst.angle, test::angle_of(glb.normal(v, weights), normals[v]) * kDegreesPerRadian);
      }
    }
  }
  return worst;
}

TEST(BakeCurved, positions_are_those_of_the_curve_and_normals_within_what_is_stated) {
  const Motion motion = test::curved_motion(kTimes, 2, 16, 8);
  std::size_t before = 0;
  for (const double tolerance : {90.0, 0.5, 0.01}) {
    const Baked bake = baked(motion, PathKind::kCatmullRom, tolerance);
    const ShownGlb glb(bake.glb);
    const Worst worst = worst_of(motion, glb, false, 40);
    EXPECT_LT(worst.distance, 2e-6) << tolerance;
    EXPECT_NEAR(worst.angle, bake.report.largest_error, 1e-3) << "what is stated is what is shown";
    EXPECT_EQ(bake.report.targets, 5U);
    EXPECT_EQ(glb.targets(), bake.report.targets + bake.report.extra_targets);
    const Result<GltfDocument> document = GltfDocument::read(bake.glb, "baked");
    ASSERT_TRUE(document.ok()) << document.error().text();
    const Result<Audit> audited = audit(document.value(), {});
    EXPECT_TRUE(audited.ok()) << audited.error().text();
    if (tolerance == 90)
      EXPECT_EQ(bake.report.extra_targets, 0U);
    else
      EXPECT_GT(bake.report.extra_targets, before) << "a bend more where it takes one";
    before = bake.report.extra_targets;
  }
  EXPECT_LT(baked(motion, PathKind::kCatmullRom, 0.01).report.largest_error,
            0.3 * baked(motion, PathKind::kCatmullRom, 90).report.largest_error);
}

TEST(BakeCurved, velocities_of_the_file_are_targets_of_their_own) {
  Motion motion = test::curved_motion(kTimes, 1.5, 12, 6);
  for (Motion::Keyframe& key : motion.keyframes)
    for (std::size_t c = 0; c < key.positions.size(); ++c)
      key.velocities.push_back(0.5F * key.positions[(c + 2) % key.positions.size()]);
  motion.keyframes[2].velocities.clear();  // the velocities of Catmull-Rom are used here
  const Baked bake = baked(motion, PathKind::kHermite, 0.5);
  EXPECT_EQ(bake.report.targets, 5U + 5U);
  const Worst worst = worst_of(motion, ShownGlb(bake.glb), true, 40);
  EXPECT_LT(worst.distance, 2e-6);
  EXPECT_NEAR(worst.angle, bake.report.largest_error, 1e-3);
}

// A dense motion whose velocities are those of the motion.
Motion with_velocities(std::size_t keyframes) {
  std::vector<double> times, before, after;
  constexpr double kStep = 0x1p-9;
  for (std::size_t k = 0; k < keyframes; ++k) {
    times.push_back(static_cast<double>(k) / static_cast<double>(keyframes - 1));
    before.push_back(times.back() - kStep);
    after.push_back(times.back() + kStep);
  }
  Motion motion = test::curved_motion(times, 2, 16, 8);
  const Motion earlier = test::curved_motion(before, 2, 16, 8), later = test::curved_motion(after, 2, 16, 8);
  for (std::size_t k = 0; k < keyframes; ++k)
    for (std::size_t c = 0; c < motion.keyframes[k].positions.size(); ++c)
      motion.keyframes[k].velocities.push_back(static_cast<float>(
          (double{later.keyframes[k].positions[c]} - double{earlier.keyframes[k].positions[c]}) / (2 * kStep)));
  return motion;
}

TEST(BakeCurved, normals_follow_velocities_of_the_file_as_closely_as_those_that_follow_from_positions) {
  const Motion motion = with_velocities(25);
  const double from_positions = baked(motion, PathKind::kCatmullRom, 90).report.largest_error;
  const Baked bake = baked(motion, PathKind::kHermite, 90);
  EXPECT_LT(bake.report.largest_error, 2 * from_positions);
  EXPECT_LT(bake.report.largest_error, 0.01);
  const Worst worst = worst_of(motion, ShownGlb(bake.glb), true, 40);
  EXPECT_LT(worst.distance, 2e-6);
  EXPECT_NEAR(worst.angle, bake.report.largest_error, 1e-3);
}

TEST(BakeCurved, a_part_of_a_sequence_moves_as_the_whole_does) {
  const Motion whole = with_velocities(13);
  Motion part = whole;
  part.keyframes = {whole.keyframes.begin() + 4, whole.keyframes.begin() + 9};
  part.connect_as_sequence();
  // The velocities of these parabolas at the ends of the part, where times are even.
  for (const std::size_t k : {4U, 8U}) {
    std::vector<float>& velocities = part.keyframes[k - 4].end_velocities;
    for (std::size_t c = 0; c < whole.keyframes[k].positions.size(); ++c)
      velocities.push_back(6 * (whole.keyframes[k + 1].positions[c] - whole.keyframes[k - 1].positions[c]));
  }
  for (Motion::Keyframe& keyframe : part.keyframes) keyframe.time -= whole.keyframes[4].time;
  const Baked bake = baked(part, PathKind::kCatmullRom, 0.5);
  EXPECT_EQ(bake.report.targets, 4U + 2U) << "both ends have velocities of their own";
  EXPECT_LT(bake.report.largest_error, 0.1);
  const ShownGlb glb(bake.glb);
  for (const std::size_t s : {4U, 7U}) {
    for (const double t : {0.25, 0.5, 0.75}) {
      const auto right = test::on_curve(whole, s, static_cast<long double>(t));
      const auto weights = glb.weights((1 - t) * part.keyframes[s - 4].time + t * part.keyframes[s - 3].time);
      for (std::size_t v = 0; v < glb.vertices(); ++v)
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(glb.position(v, weights)[c], static_cast<double>(right[3 * v + c]), 2e-6) << s << ' ' << v;
    }
  }
}

TEST(BakeCurved, an_element_without_area_at_the_first_key_is_right_later) {
  Motion motion = test::curved_motion(kTimes, 1, 8, 4);
  std::vector<float>& first = motion.keyframes[0].positions;
  for (std::size_t c = 0; c < first.size(); ++c) first[c] = c % 3 == 0 ? 1.0F : 0.0F;  // all vertices are at one point
  const Baked bake = baked(motion, PathKind::kCatmullRom, 0.5);
  const ShownGlb glb(bake.glb);
  for (const std::size_t k : {1U, 3U, 5U}) {
    const std::vector<double> weights = glb.weights(kTimes[k]);
    const auto normals = test::normals_of(motion, test::on_curve(motion, k - 1, 1), true);
    for (std::size_t v = 0; v < glb.vertices(); ++v)
      EXPECT_LT(test::angle_of(glb.normal(v, weights), normals[v]), 1e-5) << k << ' ' << v;
  }
}

TEST(BakeCurved, an_element_that_has_no_area_for_a_while_begins_again_in_the_direction_that_it_takes_then) {
  Motion motion = test::curved_motion({0, 1, 2, 3, 4, 5, 6, 7}, 1, 8, 4);
  for (const std::size_t k : {2U, 3U, 4U, 5U}) {  // all vertices are at one point
    std::vector<float>& positions = motion.keyframes[k].positions;
    for (std::size_t c = 0; c < positions.size(); ++c) positions[c] = c % 3 == 0 ? 1.0F : 0.0F;
  }
  // Nothing moves from key 3 to key 4. From there on, vertices go along their velocities at key 5, which lead to key 6.
  const Baked bake = baked(motion, PathKind::kCatmullRom, 0.5);
  const ShownGlb glb(bake.glb);
  const std::vector<double> weights = glb.weights(4);
  const auto normals = test::normals_of(motion, test::on_curve(motion, 5, 1), true);
  for (std::size_t v = 0; v < glb.vertices(); ++v)
    EXPECT_LT(test::angle_of(glb.normal(v, weights), normals[v]), 1e-5) << v;
}

TEST(BakeCurved, refuses_encodings_and_weightings_that_it_has_not) {
  const Motion motion = test::curved_motion(kTimes, 1, 6, 4);
  std::string glb;
  BakeOptions options;
  options.path = PathKind::kCatmullRom;
  for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kHarmless, BakeEncoding::kKeys}) {
    options.encoding = encoding;
    EXPECT_EQ(bake_sequence(motion, options, glb).error().code, ErrorCode::kUsage);
  }
  options.encoding = {};
  options.weighting = Weighting::kAngle;
  EXPECT_EQ(bake_sequence(motion, options, glb).error().code, ErrorCode::kUsage);
  options.weighting = {};
  options.path = PathKind::kHermite;
  EXPECT_EQ(bake_sequence(motion, options, glb).error().code, ErrorCode::kUsage) << "no velocities";
}

}  // namespace
}  // namespace chronormal::bake_curved_test
