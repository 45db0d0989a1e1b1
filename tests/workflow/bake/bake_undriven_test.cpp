// Tests bakes of rigs that nothing drives. The weights of correction targets are quadratic formulas of the weights of
// the author's targets. The test evaluates the formulas in the file, and compares the result with cross products in
// random poses.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "tests/support/bake_fixture.h"

namespace chronormal::bake_undriven_test {
namespace {

using test::Baked;
using test::GltfBuilder;

constexpr std::size_t kTargets = 6;

BakeOptions smallest(double tolerance = 0.5) {
  BakeOptions options;
  options.encoding = BakeEncoding::kSmallest;
  options.tolerance = tolerance;
  options.viewers = {kViewers[0]};
  options.is_posed = true;
  return options;
}

GltfBuilder rig(unsigned seed, std::size_t targets = kTargets) {
  return test::with_misleading_normals(test::still_hills_document(targets, seed));
}

// Returns the weights of all targets. `own` has the weights of the author's targets. The weights of the correction
// targets are computed by the formulas in the file.
std::vector<float> driven(const Baked& baked, const std::vector<double>& own) {
  std::vector<float> all(own.begin(), own.end());
  const auto& extras = baked.mesh()["extras"]["chronormal"]["extras"];
  all.resize(own.size() + extras.size());
  for (const auto& extra : extras) {
    double sum = 0;
    for (const auto& term : extra["linear"]) sum += term[1].get<double>() * own[term[0].get<std::size_t>()];
    for (const auto& term : extra["quadratic"])
      sum += term[2].get<double>() * own[term[0].get<std::size_t>()] * own[term[1].get<std::size_t>()];
    all[extra["target"].get<std::size_t>()] = static_cast<float>(sum);
  }
  return all;
}

std::vector<std::vector<double>> random_poses(std::size_t count, std::size_t active, unsigned seed,
                                              std::size_t targets = kTargets) {
  std::mt19937 random(seed);
  std::vector<std::vector<double>> poses;
  for (std::size_t n = 0; n < count; ++n) {
    std::vector<double>& pose = poses.emplace_back(targets, 0.0);
    for (std::size_t k = 0; k < active; ++k) pose[random() % targets] = static_cast<double>(random() % 1000) / 1000;
  }
  return poses;
}

test::ShownError error_in(const Baked& baked, const std::vector<std::vector<double>>& poses, bool drives = true) {
  std::vector<test::Pose> both;
  for (const std::vector<double>& pose : poses) {
    std::vector<float> after = driven(baked, pose);
    if (!drives) std::fill(after.begin() + static_cast<std::ptrdiff_t>(pose.size()), after.end(), 0.0F);
    both.push_back({pose, after});
  }
  return shown_error(test::GltfTruth(*baked.before, 0), *baked.after, 0, both);
}

Baked without_extras(unsigned seed, std::size_t targets = kTargets) {
  BakeOptions options = smallest();
  options.most_targets = targets;
  return test::bake_document(rig(seed, targets), options);
}

TEST(BakeUndriven, extra_targets_bring_poses_that_no_fit_has_seen_nearer) {
  const Baked baked = test::bake_document(rig(3), smallest()), without = without_extras(3);
  ASSERT_TRUE(baked.ok() && without.ok()) << baked.error << without.error;
  EXPECT_GT(baked.report.added_targets, 0U);
  EXPECT_EQ(without.report.added_targets, 0U);
  const auto poses = random_poses(200, 3, 99);
  const double before = error_in(without, poses).mean(), after = error_in(baked, poses).mean();
  EXPECT_LT(after, 0.2 * before) << before;
}

TEST(BakeUndriven, shows_the_deltas_of_its_own_targets_alone_where_nobody_drives_the_extra_ones) {
  const Baked baked = test::bake_document(rig(4), smallest()), without = without_extras(4);
  ASSERT_TRUE(baked.ok() && without.ok()) << baked.error << without.error;
  ASSERT_GT(baked.report.added_targets, 0U);
  const auto poses = random_poses(100, 2, 7);
  EXPECT_LE(error_in(baked, poses, false).mean(), 1.01 * error_in(without, poses).mean());
}

TEST(BakeUndriven, quadratics_of_many_terms_bring_a_rig_of_many_pairs_nearer) {
  BakeOptions options = smallest();
  options.most_targets = 10 + 32;  // room for 32 of the 55 products
  const Baked baked = test::bake_document(rig(5, 10), options), without = without_extras(5, 10);
  ASSERT_TRUE(baked.ok() && without.ok()) << baked.error << without.error;
  ASSERT_GT(baked.report.added_targets, 0U);
  EXPECT_LE(baked.report.added_targets, 32U);
  EXPECT_GT(baked.report.meshes.at(0).extras.at(0).quadratic.size(), 2U);
  const auto poses = random_poses(200, 4, 98, 10);
  const double before = error_in(without, poses).mean(), after = error_in(baked, poses).mean();
  EXPECT_LT(after, 0.3 * before) << before;
}

TEST(BakeUndriven, no_extra_target_has_more_terms_than_are_stated) {
  constexpr std::size_t kMany = 18;  // 18 targets have 189 products
  BakeOptions options = smallest();
  options.most_targets = kMany + 64;
  const Baked baked = test::bake_document(rig(5, kMany), options);
  ASSERT_TRUE(baked.ok()) << baked.error;
  std::size_t most = 0;
  for (const GltfExtraTarget& extra : baked.report.meshes.at(0).extras)
    most = std::max(most, extra.linear.size() + extra.quadratic.size());
  EXPECT_LE(most, 160U);
  EXPECT_GT(most, 100U);
}

TEST(BakeUndriven, a_plan_says_what_more_and_more_extra_targets_gain) {
  BakeOptions options = smallest(0.001);
  options.plan = true;
  const Baked baked = test::bake_document(rig(6), options);
  ASSERT_TRUE(baked.ok()) << baked.error;
  std::vector<const BakedCandidate*> tried;
  for (const BakedCandidate& choice : baked.report.meshes.at(0).candidates)
    if (choice.name == "quadratics") tried.push_back(&choice);
  ASSERT_GE(tried.size(), 3U);
  for (std::size_t n = 0; n + 1 < tried.size(); ++n) EXPECT_LT(tried[n]->targets, tried[n + 1]->targets);
  EXPECT_LT(tried.back()->played.mean, 0.2 * tried.front()->played.mean);
}

TEST(BakeUndriven, poses_that_are_given_decide_what_is_corrected) {
  // In these poses, only targets 0 and 1 are ever active together.
  const auto poses = parse_poses("[[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [1, 1, 0, 0, 0, 0]]", "poses.json");
  ASSERT_TRUE(poses.ok());
  BakeOptions options = smallest();
  options.poses = poses.value();
  const Baked baked = test::bake_document(rig(7), options);
  ASSERT_TRUE(baked.ok()) << baked.error;
  std::vector<std::vector<double>> together;
  for (int n = 1; n <= 20; ++n) together.push_back({n / 20.0, 1 - n / 40.0, 0, 0, 0, 0});
  EXPECT_LT(error_in(baked, together).worst, 1);
  EXPECT_LE(baked.report.added_targets, 5U) << "the products of two targets";
}

TEST(BakeUndriven, a_pose_for_a_target_that_is_not_there_is_refused_by_its_place) {
  GltfBuilder builder = rig(8);
  builder.json["meshes"][0]["extras"]["targetNames"] = {"a", "b", "c", "d", "smile", "f"};
  BakeOptions options = smallest();
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {R"([{"smile": 1}, {"smlie": 1}])", "p.json, /1/smlie: no mesh has a target 'smlie'; did you mean 'smile'?"},
           {"[[1, 2]]",
            "p.json, /0: the pose has 2 weights, but no mesh has as many targets; give weights by the names of "
            "targets"}}) {
    options.poses = parse_poses(text, "p.json").value();
    EXPECT_EQ(test::bake_document(builder, options).error, message);
  }
}

TEST(BakeUndriven, an_animation_that_moves_nothing_keeps_extra_targets_at_rest) {
  for (const char* interpolation : {"LINEAR", "STEP", "CUBICSPLINE"}) {
    GltfBuilder builder = rig(9, 10);
    builder.add_animation("idle");
    const std::size_t of_key = std::string(interpolation) == "CUBICSPLINE" ? 3 : 1;
    builder.add_track(0, 0, {0, 1, 2}, std::vector<float>(3 * of_key * 10, 0.0F), interpolation);
    const Baked baked = test::bake_document(builder, smallest());
    ASSERT_TRUE(baked.ok()) << baked.error;
    ASSERT_GT(baked.report.added_targets, 0U);
    for (const double time : {0.0, 0.3, 1.7})
      EXPECT_EQ(baked.after->weights_at(0, 0, time), std::vector<float>(10 + baked.report.added_targets, 0.0F));
  }
}

// A bake warns if nothing drives a mesh. The warning must be true: either the bake wrote correction targets, or
// correction targets would improve nothing.
TEST(BakeUndriven, says_that_nothing_drives_extra_targets_only_where_there_are_none) {
  const auto said = [](const Baked& baked) {
    const auto& warnings = baked.report.warnings;
    return std::count_if(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return warning.find("no animation drives the targets") != std::string::npos;
    });
  };
  const Baked posed = test::bake_document(rig(1), smallest());
  ASSERT_TRUE(posed.ok()) << posed.error;
  ASSERT_GT(posed.report.added_targets, 0U);
  EXPECT_EQ(said(posed), 0);
  EXPECT_EQ(said(without_extras(1)), 1);
  for (const std::string& warning : without_extras(1).report.warnings)
    EXPECT_EQ(warning.find("--poses"), std::string::npos) << warning;
}

}  // namespace
}  // namespace chronormal::bake_undriven_test
