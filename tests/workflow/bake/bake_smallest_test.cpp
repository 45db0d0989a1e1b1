// Tests bakes with the encoding `smallest`, for correction targets that only the animations of the file drive. The
// result must keep a tolerance and a limit of bytes. Also tests guarantees for long files, for files that were baked
// before, and for primitives that share arrays.

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/shaded_mesh.h"
#include "workflow/bake/poses/played_poses.h"

namespace chronormal::bake_smallest_test {
namespace {

using test::Baked;
using test::GltfBuilder;

BakeOptions smallest(double tolerance) {
  BakeOptions options;
  options.encoding = BakeEncoding::kSmallest;
  options.tolerance = tolerance;
  options.viewers = {kViewers[0]};
  return options;
}

// Draws `numbers` random numbers for the keys of a track: the weights and, for a cubic spline, also the tangents.
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

const BakedCandidate& chosen(const Baked& baked) {
  for (const BakedCandidate& choice : baked.report.meshes.at(0).candidates)
    if (choice.chosen) return choice;
  ADD_FAILURE() << "nothing is chosen";
  return baked.report.meshes.at(0).candidates.at(0);
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
  ASSERT_EQ(chosen(baked).name, "low rank");
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
  EXPECT_NE(chosen(baked).name, "as it is");
  const std::vector<float> deltas = baked.numbers(baked.mesh()["primitives"][0]["targets"][0]["NORMAL"]);
  for (std::size_t v = 0; v < 3; ++v) EXPECT_GT(1 + deltas[3 * v + 2], 0.5F) << "at weight 1, vertex " << v;
}

TEST(BakeSmallest, leaves_a_file_alone_that_is_within_the_tolerance) {
  GltfBuilder builder = test::hills_document(2, 8);
  builder.add_track(0, 0, {0, 1}, std::vector<float>{0, 0, 1e-5F, 1e-5F});
  const Baked baked = test::bake_document(builder, smallest(0.5));
  ASSERT_TRUE(baked.ok()) << baked.error;
  EXPECT_FALSE(baked.report.changed);
  EXPECT_EQ(chosen(baked).name, "as it is");
}

// Returns the weights of two targets at each of `keys` keys. The targets are active only at the key `at`.
std::vector<float> wink(std::size_t keys, std::size_t at) {
  std::vector<float> weights(2 * keys, 0.0F);
  weights[2 * at] = weights[2 * at + 1] = 1;
  return weights;
}

std::vector<float> seconds(std::size_t keys) {
  std::vector<float> times(keys);
  std::iota(times.begin(), times.end(), 0.0F);
  return times;
}

TEST(BakeSmallest, sees_one_wink_in_a_long_animation_and_in_one_of_many) {
  constexpr std::size_t kKeys = 3000, kClips = 600, kWinks = 411;
  GltfBuilder one = test::hills_document(2, 11), many = one;
  one.add_track(0, 0, seconds(kKeys), wink(kKeys, 1501));
  for (std::size_t clip = 0; clip < kClips; ++clip) {
    if (clip > 0) many.add_animation("clip");
    std::vector<float> weights = wink(12, 5);
    if (clip != kWinks) std::fill(weights.begin(), weights.end(), 0.0F), weights[3] = 0.001F;
    many.add_track(clip, 0, seconds(12), weights);
  }
  for (const GltfBuilder* file : {&one, &many}) {
    const Baked baked = test::bake_document(*file, smallest(0.5));
    ASSERT_TRUE(baked.ok()) << baked.error;
    const BakedCandidate& as_it_is = baked.report.meshes[0].candidates.front();
    EXPECT_GT(as_it_is.played.worst, 10) << "else nothing is judged here";
    EXPECT_FALSE(as_it_is.within);
    EXPECT_TRUE(chosen(baked).within);
    const std::size_t animation = file == &one ? 0 : kWinks;
    std::vector<test::Pose> poses;
    for (int step = 0; step <= 100; ++step) {
      const double time = (file == &one ? 1500.0 : 4.0) + step / 50.0;
      const std::vector<float> before = baked.before->weights_at(animation, 0, time);
      poses.push_back({{before.begin(), before.end()}, baked.after->weights_at(animation, 0, time)});
    }
    EXPECT_LT(shown_error(test::GltfTruth(*baked.before, 0), *baked.after, 0, poses).worst, 0.6);
  }
}

TEST(BakeSmallest, the_keys_that_tell_most_are_those_where_weights_and_products_are_largest) {
  const std::vector<float> times = seconds(1000), weights = wink(1000, 700);
  WeightTrack track{GltfInterpolation::kLinear, {}, 2};
  track.keys.times.assign(times.begin(), times.end());
  track.keys.values.assign(weights.begin(), weights.end());
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  EXPECT_EQ(telling_keys(track, kAll), (std::vector<std::size_t>{0, 699, 700, 701}));
  for (std::size_t key = 0; key < 1000; ++key) track.keys.values[2 * key] += key % 2 == 0 ? 0.01 : 0.02;
  EXPECT_EQ(telling_keys(track, kAll).size(), 1000U);
  for (const std::size_t most : {1U, 2U, 5U, 30U}) {
    const std::vector<std::size_t> keys = telling_keys(track, most);
    EXPECT_LE(keys.size(), most);
    EXPECT_TRUE(std::is_sorted(keys.begin(), keys.end()));
    EXPECT_TRUE(std::count(keys.begin(), keys.end(), 699U) + std::count(keys.begin(), keys.end(), 700U) > 0) << most;
  }
}

TEST(BakeSmallest, the_tracks_that_tell_most_are_those_where_weights_and_products_are_largest) {
  std::vector<WeightTrack> tracks;
  for (std::size_t t = 0; t < 500; ++t) {
    WeightTrack& track = tracks.emplace_back(WeightTrack{GltfInterpolation::kLinear, {}, 2});
    track.keys.times = {0, 1, 2};
    track.keys.values = {0, 0.001 * static_cast<double>(t % 7), 0.001 * static_cast<double>(t % 11), 0, 0, 0};
  }
  tracks[77].keys.values[2] = 0.3;   // the largest weight of the first target
  tracks[78].keys.values[5] = -0.2;  // the largest absolute weight of the second target
  // In track 311, both targets are active at the same time, but neither has its largest weight. In track 402, the
  // targets are active one after the other, so the product of their weights never reaches the product of their largest
  // weights.
  tracks[311].keys.values[2] = tracks[311].keys.values[3] = 0.1;
  tracks[402].keys.values = {0.15, 0, 0, 0, 0, 0.15};
  EXPECT_EQ(telling_tracks(tracks, 500).size(), 500U);
  for (const std::size_t most : {4U, 20U, 160U}) {
    const std::vector<std::size_t> some = telling_tracks(tracks, most);
    EXPECT_LE(some.size(), most);
    EXPECT_TRUE(std::is_sorted(some.begin(), some.end()));
    for (const std::size_t t : {77U, 78U, 311U})
      EXPECT_EQ(std::count(some.begin(), some.end(), t), 1) << t << ", " << most;
    EXPECT_EQ(std::count(some.begin(), some.end(), 402U), 0) << most;
  }
  EXPECT_EQ(telling_tracks(tracks, 1).size(), 1U);
}

TEST(BakeSmallest, is_not_beaten_by_exact_in_bytes_and_error_at_once_whatever_the_tracks) {
  for (const char* interpolation : {"LINEAR", "CUBICSPLINE"}) {
    for (unsigned seed = 40; seed < 52; ++seed) {
      GltfBuilder builder = test::hills_document(3, seed);
      const bool is_spline = std::string(interpolation) == "CUBICSPLINE";
      std::vector<float> weights = random_weights((is_spline ? 9U : 3U) * kTimes.size(), seed);
      if (seed % 2 == 0)
        for (float& weight : weights) weight = 4 * weight - 0.5F;
      builder.add_track(0, 0, kTimes, weights, interpolation);
      BakeOptions exact = smallest(0.5);
      exact.encoding = BakeEncoding::kExact;
      const Baked ours = test::bake_document(builder, smallest(0.5)), theirs = test::bake_document(builder, exact);
      ASSERT_TRUE(ours.ok() && theirs.ok()) << ours.error << theirs.error;
      constexpr std::size_t kNames = 8;  // bytes by which the name "smallest" lengthens the file, compared with "exact"
      const bool is_smaller = theirs.bytes.size() + kNames < ours.bytes.size();
      const double error = test::track_error(ours).worst, of_exact = test::track_error(theirs).worst;
      EXPECT_FALSE(is_smaller && 1.01 * of_exact < error)
          << interpolation << ", seed " << seed << ": " << ours.bytes.size() << " bytes, " << error
          << " degrees against " << theirs.bytes.size() << ", " << of_exact;
      EXPECT_LT(error, 0.6) << interpolation << ", seed " << seed;
    }
  }
}

TEST(BakeSmallest, a_second_bake_judges_what_the_first_one_wrote_and_says_what_to_do) {
  const Baked first = test::bake_document(driven_hills("LINEAR", 3), smallest(40));
  ASSERT_TRUE(first.ok()) << first.error;
  ASSERT_TRUE(first.report.changed);
  const Baked same = test::bake_bytes(first.bytes, smallest(40)), nearer = test::bake_bytes(first.bytes, smallest(0.5));
  ASSERT_TRUE(same.ok() && nearer.ok()) << same.error << nearer.error;
  EXPECT_TRUE(chosen(same).within);
  EXPECT_TRUE(same.report.warnings.empty());
  EXPECT_FALSE(nearer.report.changed);
  EXPECT_FALSE(chosen(nearer).within);
  EXPECT_NEAR(chosen(nearer).played.worst, chosen(first).played.worst, 0.3 * chosen(first).played.worst);
  ASSERT_EQ(nearer.report.warnings.size(), 1U);
  EXPECT_NE(nearer.report.warnings[0].find("bake the ORIGINAL file with this tolerance"), std::string::npos);
}

TEST(BakeSmallest, fits_to_animations_alone_are_taken_only_where_they_are_better) {
  for (const std::size_t viewers : {std::size_t{1}, kViewers.size()}) {
    for (const unsigned seed : {61U, 62U, 63U}) {
      GltfBuilder builder = test::hills_document(3, seed);
      builder.add_track(0, 0, kTimes, random_weights(3 * kTimes.size(), seed));
      BakeOptions options = smallest(0.5), animations_only;
      options.viewers = {kViewers.begin(), kViewers.begin() + static_cast<std::ptrdiff_t>(viewers)};
      animations_only = options;
      animations_only.animations_only = true;
      const Baked plain = test::bake_document(builder, options), fitted = test::bake_document(builder, animations_only);
      ASSERT_TRUE(plain.ok() && fitted.ok()) << plain.error << fitted.error;
      const BakedCandidate &of_plain = chosen(plain), &of_fitted = chosen(fitted);
      EXPECT_GE(of_fitted.within, of_plain.within) << viewers << " viewers, seed " << seed;
      if (of_plain.within) {
        EXPECT_LE(of_fitted.bytes, of_plain.bytes) << viewers << " viewers, seed " << seed;
      } else {
        EXPECT_LE(of_fitted.played.mean, 1.001 * of_plain.played.mean) << viewers << " viewers, seed " << seed;
      }
      EXPECT_EQ(fitted.mesh()["extras"]["chronormal"].contains("animations_only"), of_fitted.animations_only);
    }
  }
}

TEST(BakeSmallest, fits_the_deltas_of_targets_to_animations_alone_without_room_for_extra_targets) {
  for (const unsigned seed : {61U, 62U, 63U}) {
    GltfBuilder builder = test::hills_document(3, seed);
    builder.add_track(0, 0, kTimes, random_weights(3 * kTimes.size(), seed));
    BakeOptions options = smallest(0.5), animations_only;
    options.viewers = {kViewers[0]};
    options.most_targets = 3;
    animations_only = options;
    animations_only.animations_only = true;
    const Baked plain = test::bake_document(builder, options), fitted = test::bake_document(builder, animations_only);
    ASSERT_TRUE(plain.ok() && fitted.ok()) << plain.error << fitted.error;
    EXPECT_EQ(fitted.report.added_targets, 0U);
    EXPECT_LT(test::track_error(fitted).mean(), 0.8 * test::track_error(plain).mean()) << "seed " << seed;
    EXPECT_TRUE(chosen(fitted).animations_only);
  }
}

TEST(BakeSmallest, writes_one_array_for_primitives_that_share_theirs) {
  GltfBuilder builder = driven_hills("LINEAR", 3), shared = builder;
  auto& primitives = shared.json["meshes"][0]["primitives"];
  test::Hills hills(3);
  const std::size_t half = hills.corners.size() / 6 * 3;
  auto second = primitives[0];
  primitives[0]["indices"] = shared.add_indices(
      std::vector<std::uint16_t>(hills.corners.begin(), hills.corners.begin() + static_cast<std::ptrdiff_t>(half)));
  second["indices"] = shared.add_indices(
      std::vector<std::uint16_t>(hills.corners.begin() + static_cast<std::ptrdiff_t>(half), hills.corners.end()));
  primitives.push_back(second);
  const Baked one = test::bake_document(builder, smallest(0.5)), two = test::bake_document(shared, smallest(0.5));
  ASSERT_TRUE(one.ok() && two.ok()) << one.error << two.error;
  EXPECT_EQ(two.report.added_bytes, one.report.added_bytes);
  EXPECT_EQ(chosen(two).bytes, chosen(one).bytes);
  EXPECT_EQ(two.mesh()["primitives"][0]["targets"], two.mesh()["primitives"][1]["targets"]);
  EXPECT_LT(test::track_error(two).worst, 0.6);
}

TEST(BakeSmallest, the_bytes_of_a_plan_are_those_that_are_written) {
  for (const char* interpolation : {"LINEAR", "STEP", "CUBICSPLINE"}) {
    const Baked baked = test::bake_document(driven_hills(interpolation, 3), smallest(0.5));
    ASSERT_TRUE(baked.ok()) << baked.error;
    EXPECT_EQ(chosen(baked).bytes, baked.report.meshes[0].bytes) << interpolation;
  }
}

TEST(BakeSmallest, a_limit_of_bytes_is_kept_by_a_form_about_as_near_as_a_limit_of_targets_finds) {
  for (const unsigned seed : {71U, 72U, 73U, 74U}) {
    GltfBuilder builder = test::hills_document(3, seed);
    builder.add_track(0, 0, kTimes, random_weights(3 * kTimes.size(), seed));
    for (const std::size_t extras : {0U, 1U, 2U, 3U, 4U}) {
      BakeOptions few = smallest(0.1), limited = few;
      few.most_targets = 3 + extras;
      const Baked by_targets = test::bake_document(builder, few);
      ASSERT_TRUE(by_targets.ok()) << by_targets.error;
      limited.most_delta_bytes = chosen(by_targets).bytes;
      const Baked by_bytes = test::bake_document(builder, limited);
      ASSERT_TRUE(by_bytes.ok()) << by_bytes.error;
      EXPECT_LE(chosen(by_bytes).bytes, *limited.most_delta_bytes) << extras;
      EXPECT_LE(by_bytes.report.meshes[0].bytes, *limited.most_delta_bytes) << extras;
      EXPECT_LE(chosen(by_bytes).played.mean, 1.25 * chosen(by_targets).played.mean)
          << "seed " << seed << ", " << extras << " extra targets, " << *limited.most_delta_bytes << " bytes";
    }
  }
}

TEST(BakeSmallest, says_where_a_compressor_that_is_named_rounds_by_more_than_the_tolerance) {
  BakeOptions options = smallest(0.1);
  options.viewers = find_viewers("meshopt").value();
  const Baked rounded = test::bake_document(driven_hills("LINEAR", 3), options);
  ASSERT_TRUE(rounded.ok()) << rounded.error;
  const BakedCandidate& choice = chosen(rounded);
  EXPECT_GT(choice.rounded, 0.1) << "eight bits are half a degree";
  EXPECT_EQ(is_beyond_by_rounding(choice, options), choice.within);
  options.viewers = {kViewers[0]};
  EXPECT_EQ(chosen(test::bake_document(driven_hills("LINEAR", 3), options)).rounded, 0);
}

TEST(BakeSmallest, names_of_targets_in_primitives_are_read_and_extended) {
  GltfBuilder builder = driven_hills("LINEAR", 3);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < kTargets; ++k) names.push_back("t" + std::to_string(k));
  builder.json["meshes"][0]["primitives"][0]["extras"]["targetNames"] = names;
  const Baked baked = test::bake_document(builder, smallest(0.5));
  ASSERT_TRUE(baked.ok()) << baked.error;
  ASSERT_GT(baked.report.added_targets, 0U);
  EXPECT_EQ((*baked.source)->meshes()[0].target_names, names);
  const auto& after = baked.mesh()["primitives"][0]["extras"]["targetNames"];
  EXPECT_EQ(after.size(), kTargets + baked.report.added_targets);
  EXPECT_FALSE(baked.mesh()["extras"].contains("targetNames"));
}

// Correction targets that animations drive have weight 0 when somebody moves a slider of the file.
TEST(BakeSmallest, a_slider_alone_is_judged_as_a_viewer_shows_it) {
  constexpr std::uint64_t kFirstSeed = 1133;
  std::cout << "  from seed " << kFirstSeed << "\n";
  std::size_t followed = 0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 6; ++seed) {
    test::ShadedMesh mesh = test::random_sheet(seed, 6, 2, 0);
    GltfBuilder builder = mesh.file();
    builder.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{0, 0, 1, 0.5F, 0.3F, 1});
    BakeOptions options;
    options.weighting = Weighting::kArea;
    options.viewers = {kViewers[0]};
    const Baked baked = test::bake_bytes(builder.glb(), options);
    ASSERT_TRUE(baked.ok()) << baked.error;
    for (const GltfExtraTarget& extra : baked.report.meshes[0].extras)
      followed += extra.linear.size() + extra.quadratic.size();
    const test::GltfFixture before(builder.glb()), after(baked.bytes);
    AuditOptions asked;
    asked.weighting = Weighting::kArea;
    const Result<Audit> first = audit(*before, asked);
    ASSERT_TRUE(first.ok());
    asked.weighed_like = &first.value();
    const Result<Audit> second = audit(*after, asked);
    ASSERT_TRUE(second.ok());
    for (std::size_t k = 0; k < 2; ++k)
      mesh.targets[k].normals = baked.numbers(baked.mesh()["primitives"][0]["targets"][k]["NORMAL"]);
    for (const AuditSubject& subject : second.value().subjects) {
      for (const AuditSubject& earlier : first.value().subjects) {
        if (earlier.kind == subject.kind && earlier.target == subject.target) {
          EXPECT_EQ(subject.error.judged, earlier.error.judged) << "seed " << seed;
        }
      }
      if (subject.kind != AuditSubject::Kind::kTarget) continue;
      double worst = 0;
      for (std::size_t i = 0; i < subject.samples; ++i) {
        std::vector<double> weights(2);
        weights[*subject.target] = static_cast<double>(i) / static_cast<double>(subject.samples - 1);
        for (std::size_t v = 0; v < mesh.vertices(); ++v)
          worst = std::max(worst, static_cast<double>(mesh.error(v, weights)));
      }
      EXPECT_NEAR(subject.error.worst, worst, 0.02) << "seed " << seed << ", target " << *subject.target;
    }
  }
  EXPECT_GT(followed, 0U);
}

TEST(BakeSmallest, a_result_is_not_worse_because_fewer_normals_are_judged) {
  MotionError before, after;
  before.judged = 1000;
  before.sum = after.sum = 50;
  after.judged = 500;
  EXPECT_FALSE(is_worse(after, before));
  after.sum = 52;
  EXPECT_TRUE(is_worse(after, before));
  after.judged = 4000;  // the track has more keys after the bake
  after.sum = 200;
  EXPECT_FALSE(is_worse(after, before));
}

}  // namespace
}  // namespace chronormal::bake_smallest_test
