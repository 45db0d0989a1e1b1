// The smallest form of a bake: extra targets that only the animations of the file drive, within a tolerance and a
// limit.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/bake_fixture.h"

namespace chronormal::bake_smallest_test {
namespace {

using test::Baked;
using test::GltfBuilder;

BakeOptions smallest(double tolerance) {
  BakeOptions options;
  options.encoding = BakeEncoding::kSmallest;
  options.tolerance = tolerance;
  options.hosts = {kHosts[0]};
  return options;
}

// Weights of all targets at so many keys; of cubic splines tangents too.
std::vector<float> random_weights(std::size_t numbers, unsigned seed) {
  test::Hills random(seed);
  std::vector<float> weights;
  for (std::size_t n = 0; n < numbers; ++n) weights.push_back(random.uniform(0, 0.4));
  return weights;
}

constexpr std::size_t kTargets = 7;
const std::vector<float> kTimes = {0, 0.5, 1, 2, 2.5, 3};

GltfBuilder driven_hills(const char* interpolation, unsigned seed) {
  GltfBuilder builder = test::hills_document(kTargets, seed);
  const std::size_t of_key = std::string(interpolation) == "CUBICSPLINE" ? 3 : 1;
  builder.add_track(0, 0, kTimes, random_weights(of_key * kTargets * kTimes.size(), seed + 100), interpolation);
  return test::with_misleading_normals(std::move(builder));
}

const BakeChoice& chosen(const Baked& baked) {
  for (const BakeChoice& choice : baked.report.meshes.at(0).choices)
    if (choice.chosen) return choice;
  ADD_FAILURE() << "nothing is chosen";
  return baked.report.meshes.at(0).choices.at(0);
}

TEST(BakeSmallest, is_within_the_tolerance_between_the_keys_of_every_kind_of_track_with_fewer_targets_than_pairs) {
  for (const char* interpolation : {"LINEAR", "STEP", "CUBICSPLINE"}) {
    const Baked baked = test::bake_document(driven_hills(interpolation, 3), smallest(0.5));
    ASSERT_TRUE(baked.ok()) << baked.error;
    const auto error = test::track_error(baked);
    EXPECT_GT(error.judged, 1000U);
    EXPECT_LT(error.worst, 0.6) << interpolation;
    EXPECT_LT(baked.report.added_targets, kTargets * (kTargets + 1) / 2) << interpolation;
    EXPECT_GT(baked.report.added_targets, 0U);
  }
}

TEST(BakeSmallest, extra_targets_of_curves_have_no_terms_and_are_at_rest_where_the_file_is) {
  const Baked baked = test::bake_document(driven_hills("LINEAR", 4), smallest(0.5));
  ASSERT_TRUE(baked.ok()) << baked.error;
  ASSERT_EQ(chosen(baked).form, "low rank");
  for (const GltfExtraTarget& extra : baked.report.meshes[0].extras) {
    EXPECT_TRUE(extra.linear.empty());
    EXPECT_TRUE(extra.quadratic.empty());
  }
}

TEST(BakeSmallest, never_has_more_targets_than_asked_and_says_where_that_is_beyond_the_tolerance) {
  for (const std::size_t most : {kTargets, kTargets + 1, kTargets + 4}) {
    BakeOptions options = smallest(0.01);
    options.most_targets = most;
    const Baked baked = test::bake_document(driven_hills("LINEAR", 5), options);
    ASSERT_TRUE(baked.ok()) << baked.error;
    EXPECT_LE(chosen(baked).targets, most);
    EXPECT_LE(kTargets + baked.report.added_targets, most);
    EXPECT_FALSE(chosen(baked).within);
  }
}

TEST(BakeSmallest, two_animations_share_the_deltas_of_extra_targets_and_each_has_its_own_curves) {
  GltfBuilder builder = driven_hills("LINEAR", 6);
  builder.add_animation("other");
  builder.add_track(1, 0, {0, 1, 4}, random_weights(3 * kTargets, 77));
  const Baked baked = test::bake_document(builder, smallest(0.5));
  ASSERT_TRUE(baked.ok()) << baked.error;
  EXPECT_LT(test::track_error(baked, 0).worst, 0.6);
  EXPECT_LT(test::track_error(baked, 1).worst, 0.6);
}

TEST(BakeSmallest, mends_normals_that_add_up_to_zero_at_the_end_of_a_target_alone) {
  GltfBuilder builder;
  const std::vector<float> up = {0, 0, 1, 0, 0, 1, 0, 0, 1}, down = {0, 0, -1, 0, 0, -1, 0, 0, -1};
  const std::size_t positions = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0}), normals = builder.add_positions(up);
  const std::size_t raised = builder.add_positions(up), against = builder.add_positions(down);
  GltfBuilder::Json primitive = GltfBuilder::primitive(positions, builder.add_indices<std::uint8_t>({0, 1, 2}),
                                                       {{{"POSITION", raised}, {"NORMAL", against}}});
  primitive["attributes"]["NORMAL"] = normals;
  builder.add_mesh(primitive);
  builder.json["nodes"] = {{{"mesh", 0}}};
  const Baked baked = test::bake_document(builder, smallest(0.5));
  ASSERT_TRUE(baked.ok()) << baked.error;
  EXPECT_NE(chosen(baked).form, "as it is");
  const std::vector<float> deltas = baked.numbers(baked.mesh()["primitives"][0]["targets"][0]["NORMAL"]);
  for (std::size_t v = 0; v < 3; ++v) EXPECT_GT(1 + deltas[3 * v + 2], 0.5F) << "at weight 1, vertex " << v;
}

TEST(BakeSmallest, leaves_a_file_alone_that_is_within_the_tolerance) {
  GltfBuilder builder = test::hills_document(2, 8);
  builder.add_track(0, 0, {0, 1}, std::vector<float>{0, 0, 1e-5F, 1e-5F});
  const Baked baked = test::bake_document(builder, smallest(0.5));
  ASSERT_TRUE(baked.ok()) << baked.error;
  EXPECT_FALSE(baked.report.changed);
  EXPECT_EQ(chosen(baked).form, "as it is");
}

}  // namespace
}  // namespace chronormal::bake_smallest_test
