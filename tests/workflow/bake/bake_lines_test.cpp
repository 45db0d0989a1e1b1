// Tests the deltas of the encoding endpoint (one delta per target) for targets that are active at the same time.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/bake_fixture.h"

namespace chronormal::bake_lines_test {
namespace {

using test::Baked;
using test::GltfBuilder;
using test::ShownError;

BakeOptions endpoint(Weighting weighting = Weighting::kArea) {
  BakeOptions options;
  options.encoding = BakeEncoding::kEndpoint;
  options.weighting = weighting;
  return options;
}

// Gives a file normals that are so misleading that a bake replaces all of them, and bakes the file.
Baked bake_misled(const GltfBuilder& builder, const BakeOptions& options) {
  return test::bake_document(test::with_misleading_normals(builder), options);
}

// Adds an animation that activates three targets, first one after the other and then together.
void add_dance(GltfBuilder& builder) {
  builder.add_track(0, 0, std::vector<float>{0, 1, 2, 3, 4},
                    std::vector<float>{0, 0, 0, 1, 0, 0.5F, 1, 1, 0, 0.3F, 1, 1, 0, 0, 0.7F});
}

std::vector<float> deltas_of(const Baked& baked, std::size_t target) {
  return baked.numbers(baked.mesh()["primitives"][0]["targets"][target]["NORMAL"]);
}

void expect_same_deltas(const Baked& a, const Baked& b) {
  for (std::size_t k = 0; k < a.mesh()["primitives"][0]["targets"].size(); ++k)
    EXPECT_EQ(deltas_of(a, k), deltas_of(b, k));
}

// Returns poses in which only one of the three targets is active, with weights from 0 to 1.
std::vector<test::Pose> poses_alone(std::size_t target) {
  std::vector<test::Pose> poses;
  for (int i = 0; i <= 20; ++i) {
    test::Pose& pose = poses.emplace_back();
    pose.before.assign(3, 0.0);
    pose.after.assign(3, 0.0F);
    pose.after[target] = static_cast<float>(i) / 20;
    pose.before[target] = static_cast<double>(pose.after[target]);
  }
  return poses;
}

// Returns the errors that the deltas of one file have over the track of another file with the same targets.
ShownError error_on_track(const Baked& track, const Baked& deltas, bool uniform = false) {
  test::GltfTruth truth(*track.before, 0);
  truth.uniform = uniform;
  return test::shown_error(truth, *deltas.after, 0, test::poses_of(*track.before, *track.after, 0, 0));
}

TEST(BakeLines, of_targets_active_together_are_better_than_the_best_of_each_alone) {
  double fitted_mean = 0, alone_mean = 0;
  std::size_t seeds = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const Baked alone = bake_misled(test::still_hills_document(3, seed), endpoint());
    GltfBuilder builder = test::hills_document(3, seed);
    add_dance(builder);
    const Baked fitted = bake_misled(builder, endpoint());
    ASSERT_EQ(fitted.error, "");
    if (!alone.report.changed || !fitted.report.changed) continue;  // skips seeds in which a normal turns over
    ++seeds;
    EXPECT_EQ(fitted.report.added_targets, 0U);
    EXPECT_GE(fitted.report.meshes[0].fitted_elements, 24U);
    EXPECT_EQ(alone.report.meshes[0].fitted_elements, 0U);
    const ShownError error = error_on_track(fitted, fitted), of_alone = error_on_track(fitted, alone);
    EXPECT_LT(error.mean(), of_alone.mean());
    EXPECT_LE(error.worst, of_alone.worst + 0.1);  // the poses are not at the instants that the fit used
    // The bake measures its error at more instants, so its report may state a slightly larger error than this test
    // finds.
    EXPECT_LE(error.worst, 1.02 * fitted.report.meshes[0].largest_error);
    EXPECT_GE(error.worst, 0.9 * fitted.report.meshes[0].largest_error);
    fitted_mean += error.mean();
    alone_mean += of_alone.mean();
  }
  RecordProperty("fitted", std::to_string(fitted_mean / static_cast<double>(seeds)));
  RecordProperty("alone", std::to_string(alone_mean / static_cast<double>(seeds)));
  EXPECT_GE(seeds, 7U);
  EXPECT_LT(fitted_mean, 0.6 * alone_mean);
  // docs/theory.md states both averages, in degrees.
  EXPECT_NEAR(alone_mean / static_cast<double>(seeds), 4.42, 0.01);
  EXPECT_NEAR(fitted_mean / static_cast<double>(seeds), 1.14, 0.01);
}

TEST(BakeLines, no_small_change_of_a_delta_is_better) {
  GltfBuilder builder = test::hills_document(3, 4);
  add_dance(builder);
  const Baked baked = bake_misled(builder, endpoint());
  ASSERT_EQ(baked.error, "");
  const auto poses = test::poses_of(*baked.before, *baked.after, 0, 0);
  const test::GltfTruth truth(*baked.before, 0);
  std::vector<std::vector<float>> deltas;
  for (const auto& target : baked.mesh()["primitives"][0]["targets"]) deltas.push_back(baked.numbers(target["NORMAL"]));
  // Returns what the fit minimises: the squares of the components of rendered normals that are perpendicular to the
  // true normals.
  const auto across = [&](std::size_t vertex) {
    double sum = 0;
    for (const test::Pose& pose : poses) {
      const auto base = truth.normals_at({0, 0, 0})[vertex], at = truth.normals_at(pose.before)[vertex];
      const test::Vector right = test::GltfTruth::turn(base, truth.vertices[vertex].stored, at);
      test::Vector shown = truth.vertices[vertex].stored;
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t c = 0; c < 3; ++c)
          shown[c] += static_cast<test::Real>(pose.after[k]) * static_cast<test::Real>(deltas[k][3 * vertex + c]);
      }
      const test::Vector side = test::crossed(shown, right);
      sum += static_cast<double>(test::dotted(side, side) / test::dotted(right, right));
    }
    return sum;
  };
  for (const std::size_t vertex : {std::size_t{6}, std::size_t{12}, std::size_t{18}}) {
    const double best = across(vertex);
    EXPECT_GT(best, 0);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (const float change : {-0.03F, 0.03F}) {
          float& number = deltas[k][3 * vertex + c];
          const float kept = number;
          number += change;
          // The fit used other samples, so for these poses slightly better deltas may exist.
          EXPECT_GT(across(vertex), 0.99 * best);
          number = kept;
        }
      }
    }
  }
}

TEST(BakeLines, of_targets_that_are_never_active_together_are_those_of_each_alone) {
  const Baked alone = bake_misled(test::still_hills_document(3), endpoint());
  GltfBuilder builder = test::hills_document(3);
  builder.add_track(0, 0, std::vector<float>{0, 1, 2, 3, 4, 5, 6},
                    std::vector<float>{0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  const Baked after = bake_misled(builder, endpoint());
  ASSERT_EQ(after.error, "");
  EXPECT_EQ(after.report.meshes[0].fitted_elements, 0U);
  expect_same_deltas(after, alone);
}

TEST(BakeLines, the_error_of_weights_beyond_0_and_1_is_stated) {
  std::size_t seeds = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    GltfBuilder builder = test::hills_document(1, seed);
    builder.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{-0.5F, 1, 1.5F});
    const Baked baked = bake_misled(builder, endpoint());
    ASSERT_EQ(baked.error, "");
    if (!baked.report.changed) continue;  // skips seeds in which a normal turns over
    ++seeds;
    const double worst = error_on_track(baked, baked).worst, stated = baked.report.meshes[0].largest_error;
    EXPECT_LE(worst, stated + 1e-3);
    EXPECT_GE(worst, 0.9 * stated);
    const Baked still = bake_misled(test::still_hills_document(1, seed), endpoint());
    EXPECT_GT(worst, 1.1 * still.report.meshes[0].largest_error);
  }
  EXPECT_GE(seeds, 3U);
}

TEST(BakeLines, without_area_in_the_base_are_right_where_targets_are_active) {
  test::Hills hills(5);
  const std::vector<float> field = hills.positions, other = test::Hills(6).positions;
  std::fill(hills.positions.begin(), hills.positions.end(), 0.0F);
  GltfBuilder builder;
  builder.add_node(builder.add_mesh(hills.primitive(builder, {field, other})));
  builder.add_animation("rise");
  builder.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{1, 0, 1, 1, 0.5F, 0.25F});
  const Baked baked = bake_misled(builder, endpoint());
  ASSERT_EQ(baked.error, "");
  EXPECT_GE(baked.report.meshes[0].fitted_elements, 15U);
  EXPECT_EQ(baked.report.meshes[0].without_base, 25U);
  const ShownError error = error_on_track(baked, baked);
  EXPECT_GT(error.judged, 2000U);
  EXPECT_LE(error.worst, 1.02 * baked.report.meshes[0].largest_error);
  EXPECT_LT(error.mean(), 2);
}

TEST(BakeLines, other_weightings_are_fitted_to_their_own_normals) {
  for (const float scale : {1.0F, 400.0F, 0.01F}) {  // the lengths of normals must not matter
    SCOPED_TRACE(scale);
    test::Hills hills(2);
    std::vector<std::vector<float>> deltas = {hills.deltas(), hills.deltas(), hills.deltas()};
    for (float& c : hills.positions) c *= scale;
    for (std::vector<float>& of_target : deltas) {
      for (float& c : of_target) c *= scale;
    }
    GltfBuilder builder;
    builder.add_node(builder.add_mesh(hills.primitive(builder, deltas)));
    builder.add_animation("move");
    add_dance(builder);
    const Baked uniform = bake_misled(builder, endpoint(Weighting::kUniform));
    const Baked area = bake_misled(builder, endpoint());
    ASSERT_EQ(uniform.error, "");
    const ShownError error = error_on_track(uniform, uniform, true);
    EXPECT_LT(error.mean(), 0.9 * error_on_track(area, area, true).mean());
    EXPECT_LE(error.worst, 1.02 * uniform.report.meshes[0].largest_error);
  }
}

TEST(BakeLines, without_an_animation_each_target_is_for_itself) {
  GltfBuilder builder = test::still_hills_document(2, 3);
  builder.json["nodes"][0]["weights"] = {0.75, 1.0};
  const Baked posed = bake_misled(builder, endpoint());
  ASSERT_EQ(posed.error, "");
  EXPECT_EQ(posed.report.meshes[0].fitted_elements, 0U);
  expect_same_deltas(posed, bake_misled(test::still_hills_document(2, 3), endpoint()));
}

TEST(BakeLines, weights_that_tell_nothing_leave_each_target_for_itself) {
  // In one file, the weights are about a billionth. In the other file, two targets have the same weights, except for a
  // ten-thousandth.
  GltfBuilder tiny = test::hills_document(3, 6), alike = test::hills_document(3, 6);
  tiny.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{1e-9F, 2e-9F, 0, 0, 1e-9F, 1e-9F});
  alike.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{0, 0, 0, 0.5F, 0.5001F, 0, 0.9F, 0.8999F, 0});
  const Baked alone = bake_misled(test::still_hills_document(3, 6), endpoint());
  const Baked of_tiny = bake_misled(tiny, endpoint()), of_alike = bake_misled(alike, endpoint());
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<float> deltas = deltas_of(alone, k), with_tiny = deltas_of(of_tiny, k),
                             with_alike = deltas_of(of_alike, k);
    for (std::size_t i = 0; i < deltas.size(); ++i) {
      EXPECT_NEAR(with_tiny[i], deltas[i], 1e-3);
      EXPECT_NEAR(with_alike[i], deltas[i], 1.5);  // half of the difference that both deltas together must correct
    }
  }
}

TEST(BakeLines, long_animations_are_judged_where_they_were_not_fitted) {
  // The animation has 16 samples for each of its 300 intervals between keys, which are more samples than the fit uses.
  GltfBuilder builder = test::hills_document(3, 8);
  test::Hills random(9);
  std::vector<float> times, values;
  for (int key = 0; key <= 300; ++key) {
    times.push_back(static_cast<float>(key));
    for (int k = 0; k < 3; ++k) values.push_back(random.uniform(0, 1));
  }
  builder.add_track(0, 0, times, values);
  const Baked baked = bake_misled(builder, endpoint());
  ASSERT_EQ(baked.error, "");
  const double worst = error_on_track(baked, baked).worst, stated = baked.report.meshes[0].largest_error;
  EXPECT_LE(worst, 1.05 * stated);
  EXPECT_GE(worst, 0.5 * stated);
}

TEST(BakeLines, what_is_right_already_is_not_fitted_to_rounding) {
  // If targets only change the heights over a grid, the normals have only linear terms.
  test::Hills hills(7);
  std::vector<std::vector<float>> deltas = {hills.deltas(), hills.deltas()};
  for (std::vector<float>& of_target : deltas) {
    for (std::size_t i = 0; i < of_target.size(); ++i) of_target[i] = i % 3 == 2 ? of_target[i] : 0;
  }
  GltfBuilder builder;
  builder.add_node(builder.add_mesh(hills.primitive(builder, deltas)));
  builder.add_animation("move");
  builder.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{0, 0, 1, 0.5F, 0.5F, 1});
  const Baked baked = bake_misled(builder, endpoint());
  EXPECT_EQ(baked.report.meshes[0].fitted_elements, 0U);
  EXPECT_LT(error_on_track(baked, baked).worst, 1e-4);
  EXPECT_LT(baked.report.meshes[0].largest_error, 1e-4);
}

TEST(BakeLines, more_targets_than_are_fitted_are_judged_all_the_same) {
  GltfBuilder builder = test::hills_document(65, 2);
  std::vector<float> last(65, 0.05F), values(65, 0.0F);
  values.insert(values.end(), last.begin(), last.end());
  builder.add_track(0, 0, std::vector<float>{0, 1}, values);
  const Baked baked = bake_misled(builder, endpoint());
  ASSERT_EQ(baked.error, "");
  EXPECT_EQ(baked.report.meshes[0].fitted_elements, 0U);
  const double worst = error_on_track(baked, baked).worst, stated = baked.report.meshes[0].largest_error;
  EXPECT_LE(worst, 1.05 * stated);
}

TEST(BakeLines, a_wink_in_a_long_animation_counts) {
  GltfBuilder builder = test::hills_document(2, 3);
  std::vector<float> times, values;
  for (int key = 0; key < 8000; ++key) {
    times.push_back(static_cast<float>(key));
    const bool wink = key == 4323;  // the fit does not use this key as one of its 2,000 samples
    values.push_back(wink ? 1.0F : 0.01F);
    values.push_back(wink ? 1.0F : 0.01F);
  }
  builder.add_track(0, 0, times, values, "STEP");
  const Baked baked = bake_misled(builder, endpoint());
  ASSERT_EQ(baked.error, "");
  const ShownError error = test::shown_error(test::GltfTruth(*baked.before, 0), *baked.after, 0,
                                             {{{1, 1}, {1, 1}}, {{0.01F, 0.01F}, {0.01F, 0.01F}}});
  EXPECT_GT(error.worst, 1);
  EXPECT_LE(error.worst, baked.report.meshes[0].largest_error + 1e-3);
}

TEST(BakeLines, a_target_that_is_never_active_keeps_what_it_has_alone_and_its_error_is_stated) {
  GltfBuilder builder = test::hills_document(3, 5);
  // The third target is never active in the animation, so its deltas are the same as in a file without an animation.
  // The error of the third target alone may be the largest error.
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 0, 0.01F, 0.01F, 0});
  const Baked baked = bake_misled(builder, endpoint());
  const Baked alone = bake_misled(test::still_hills_document(3, 5), endpoint());
  EXPECT_EQ(deltas_of(baked, 2), deltas_of(alone, 2));
  const double worst = test::shown_error(test::GltfTruth(*baked.before, 0), *baked.after, 0, poses_alone(2)).worst;
  EXPECT_GT(worst, 0.5);
  EXPECT_LE(worst, baked.report.meshes[0].largest_error + 1e-3);
}

}  // namespace
}  // namespace chronormal::bake_lines_test
