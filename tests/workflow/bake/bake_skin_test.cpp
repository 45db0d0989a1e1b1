// Checks that a bake with the encoding `smallest` judges its candidates by the normals after skinning. The tolerance
// must be kept with joints that squash the mesh, and in viewers with different rules for skinned normals. Joints that
// only rotate and scale uniformly must change nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/bake_fixture.h"
#include "tests/support/skinned_mesh.h"

namespace chronormal::bake_skin_test {
namespace {

using test::Baked;
using test::Carry;
using test::GltfBuilder;
using test::Real;
using test::Rows;
using test::Skin;
using test::Trs;
using Json = GltfBuilder::Json;

constexpr std::size_t kSide = 5, kVertices = kSide * kSide, kTargets = 2;
constexpr double kTolerance = 1;
// Three.js transforms normals by the blended matrix, and Bevy by the inverse transpose of the blended matrix.
const Viewer kThree = find_viewers("three").value()[0], kBevy = find_viewers("bevy").value()[0];

BakeOptions smallest(double tolerance = kTolerance, std::vector<Viewer> viewers = {kThree}) {
  BakeOptions options;
  options.encoding = BakeEncoding::kSmallest;
  options.tolerance = tolerance;
  options.viewers = std::move(viewers);
  return options;
}

const BakedCandidate& chosen(const Baked& baked) {
  for (const BakedCandidate& choice : baked.report.meshes.at(0).candidates)
    if (choice.chosen) return choice;
  ADD_FAILURE() << "nothing is chosen";
  return baked.report.meshes.at(0).candidates.at(0);
}

// Makes hills with a track of poses, one second apart. In each pose, all targets have the same weight.
GltfBuilder played_hills(unsigned seed, const std::vector<float>& weights, const char* interpolation = "LINEAR") {
  GltfBuilder builder = test::hills_document(kTargets, seed);
  std::vector<float> times, values;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    times.push_back(static_cast<float>(k));
    values.insert(values.end(), kTargets, weights[k]);
  }
  builder.add_track(0, 0, times, values, interpolation);
  return builder;
}

// Makes a skin in which all vertices follow joint 0. If `bent`, vertices follow joint 1 more, the larger their x is.
Skin skin_of(bool bent) {
  Skin skin;
  skin.joints.emplace_back();
  skin.weights.emplace_back();
  for (std::size_t v = 0; v < kVertices; ++v) {
    const float part = bent ? static_cast<float>(v % kSide) / static_cast<float>(kSide - 1) : 0;
    for (const int joint : {0, 1, 0, 0}) skin.joints[0].push_back(static_cast<std::uint8_t>(joint));
    for (const float share : {1 - part, part, 0.0F, 0.0F}) skin.weights[0].push_back(share);
  }
  return skin;
}

// Adds the skin with two joints, which are nodes 1 and 2.
void add_skin(GltfBuilder& builder, const Skin& skin, const Trs& one, const Trs& two = {}) {
  builder.add("nodes", one.json());
  builder.add("nodes", two.json());
  skin.add_to(builder, {1, 2});
}

// Adds a channel that rotates joint 1. `turns` has a quaternion for each time.
void add_turns(GltfBuilder& builder, const std::vector<float>& times, const std::vector<float>& turns,
               const char* interpolation = "LINEAR") {
  const std::size_t input = builder.add_accessor("SCALAR", times), output = builder.add_accessor("VEC4", turns);
  Json& animation = builder.json["animations"][0];
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", 2}, {"path", "rotation"}}}});
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
}

Trs scaled(Real x, Real y, Real z) {
  Trs place;
  place.scale = {x, y, z};
  return place;
}

// A function that returns the matrices of the joints at a time.
using World = std::function<std::vector<Rows>(double time)>;
World standing(const Trs& one, const Trs& two = {}) {
  return [one, two](double) { return std::vector<Rows>{one.rows(), two.rows()}; };
}

// Returns the errors after skinning, at 101 times of the track of node 0.
test::ShownError seen_error(const Baked& baked, const Skin& skin, const World& world, Carry rule = Carry::kBlended) {
  const test::GltfTruth truth(*baked.before, 0);
  const std::vector<test::Pose> poses = test::poses_of(*baked.before, *baked.after, 0, 0);
  const std::vector<test::Vector> base = truth.normals_at(std::vector<double>(kTargets, 0.0));
  const Json& sampler = baked.before->json["animations"][0]["samplers"][0];
  const double last = static_cast<double>(baked.before->accessor(sampler["input"].get<std::size_t>()).back());
  test::ShownError error;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    const std::vector<Rows> at = world(last * static_cast<double>(n) / static_cast<double>(poses.size() - 1));
    const std::vector<test::Vector> exact = truth.normals_at(poses[n].before);
    for (std::size_t v = 0; v < kVertices; ++v) {
      const test::Vector right = test::GltfTruth::turn(base[v], truth.vertices[v].stored, test::unit_of(exact[v]));
      const test::Vector shown = baked.after->shown(baked.mesh()["primitives"][0], v, poses[n].after);
      error.add(static_cast<double>(
          test::degrees_between(carried(rule, skin, at, v, shown), carried(rule, skin, at, v, right))));
    }
  }
  return error;
}

TEST(BakeSkin, tolerance_holds_behind_a_joint_that_flattens) {
  struct Case {
    unsigned seed;
    float weight;
    double tolerance, height;
  };
  std::size_t would_not_do = 0;  // choices without the skin that exceed the tolerance with it
  // In the last four cases, every candidate that keeps the tolerance before skinning exceeds it after skinning.
  for (const Case& c : {Case{2, 0.2F, 1, 0.25},
                        {3, 0.2F, 1, 0.25},
                        {5, 0.2F, 1, 0.25},
                        {1, 0.2F, 0.5, 0.05},
                        {1, 0.4F, 2, 0.05},
                        {2, 0.4F, 2, 0.05},
                        {3, 0.4F, 1, 0.05}}) {
    SCOPED_TRACE(c.seed);
    const Trs flat = scaled(1, 1, c.height);
    GltfBuilder builder = played_hills(c.seed, {0, c.weight});
    const Baked without = test::bake_document(builder, smallest(c.tolerance));
    add_skin(builder, skin_of(false), flat);
    const Baked baked = test::bake_document(builder, smallest(c.tolerance));
    ASSERT_TRUE(baked.ok()) << baked.error;
    would_not_do += seen_error(without, skin_of(false), standing(flat)).worst > 1.2 * c.tolerance ? 1U : 0U;
    const test::ShownError seen = seen_error(baked, skin_of(false), standing(flat));
    EXPECT_LT(seen.worst, 1.02 * c.tolerance);
    EXPECT_TRUE(chosen(baked).within);
    EXPECT_NEAR(chosen(baked).played.worst, seen.worst, 0.04 * seen.worst + 1e-4);
    EXPECT_GE(chosen(baked).bytes, chosen(without).bytes);
    EXPECT_TRUE(baked.report.warnings.empty()) << baked.report.warnings.front();
  }
  EXPECT_GE(would_not_do, 3U);
}

TEST(BakeSkin, tolerance_holds_where_the_joints_bend_while_the_weights_rest) {
  // Joint 1 rotates by 165 degrees about y and back again, within 40 milliseconds.
  constexpr double kMost = 165 / 180.0 * std::numbers::pi;
  const auto turned = [](double angle) {
    Trs place;
    place.rotation = {0, std::sin(angle / 2), 0, std::cos(angle / 2)};
    return place;
  };
  for (const unsigned seed : {2U, 3U}) {
    GltfBuilder builder = played_hills(seed, {0, 0.2F, 0.2F});
    const Baked without = test::bake_document(builder, smallest());
    const Skin skin = skin_of(true);
    add_skin(builder, skin, {}, {});
    const std::vector<float> times = {1.38F, 1.42F, 1.46F};
    std::vector<float> turns;
    for (const double angle : {0.0, kMost, 0.0})
      for (const Real c : turned(angle).rotation) turns.push_back(static_cast<float>(c));
    add_turns(builder, times, turns);
    const World world = [&](double time) {
      const double away = std::max(0.0, 1 - std::fabs(time - 1.42) / 0.04);
      return std::vector<Rows>{Trs().rows(), turned(kMost * away).rows()};
    };
    EXPECT_GT(seen_error(without, skin, world).worst, 0) << seed;
    const Viewer filament = find_viewers("filament").value()[0];
    for (const auto& [viewer, rule] : {std::pair(kThree, Carry::kBlended), {filament, Carry::kByJoint}}) {
      const Baked baked = test::bake_document(builder, smallest(kTolerance, {viewer}));
      ASSERT_TRUE(baked.ok()) << baked.error;
      const test::ShownError seen = seen_error(baked, skin, world, rule);
      EXPECT_LT(seen.worst, 1.05 * std::max(kTolerance, chosen(baked).played.worst)) << seed << viewer.title;
      EXPECT_NEAR(chosen(baked).played.worst, seen.worst, 0.05 * seen.worst) << seed << viewer.title;
      EXPECT_TRUE(chosen(baked).within || !(viewer == kThree));
    }
  }
}

TEST(BakeSkin, figures_of_forms_are_those_of_the_oracle_behind_the_skin) {
  const Trs flat = scaled(1, 0.8, 0.25);
  for (const std::vector<Viewer>& viewers : {std::vector<Viewer>{kThree}, {kBevy}, {kThree, kBevy}}) {
    GltfBuilder builder = test::with_misleading_normals(played_hills(4, {0.2F, 0.3F, 0.4F}, "STEP"));
    add_skin(builder, skin_of(false), flat);
    BakeOptions options = smallest(kTolerance, viewers);
    options.plan = true;
    const Baked baked = test::bake_document(builder, options);
    ASSERT_TRUE(baked.ok()) << baked.error;
    const BakedCandidate& before = baked.report.meshes[0].candidates.front();
    ASSERT_EQ(before.name, "as it is");
    // The judged poses are the three keys of the track and the pose of the mesh's own weights, which are zero.
    double mean = 0, worst = 0;
    for (const Viewer& viewer : viewers) {
      const Carry rule = viewer == kThree ? Carry::kBlended : Carry::kInverseTranspose;
      test::ShownError error;
      const test::GltfTruth truth(*baked.before, 0);
      const std::vector<test::Vector> base = truth.normals_at({0, 0});
      for (const float weight : {0.2F, 0.3F, 0.4F, 0.0F}) {
        const double w = static_cast<double>(weight);
        const std::vector<test::Vector> exact = truth.normals_at({w, w});
        for (std::size_t v = 0; v < kVertices; ++v) {
          const test::Vector right = test::GltfTruth::turn(base[v], truth.vertices[v].stored, test::unit_of(exact[v]));
          const test::Vector shown =
              baked.before->shown(baked.before->json["meshes"][0]["primitives"][0], v, {weight, weight});
          const auto seen = [&](const test::Vector& n) {
            return carried(rule, skin_of(false), {flat.rows(), Trs().rows()}, v, n);
          };
          error.add(static_cast<double>(test::degrees_between(seen(shown), seen(right))));
        }
      }
      EXPECT_EQ(before.played.judged, error.judged);
      mean = std::max(mean, error.mean());
      worst = std::max(worst, error.worst);
    }
    EXPECT_NEAR(before.played.mean, mean, 1e-4);
    EXPECT_NEAR(before.played.worst, worst, 1e-4);
  }
}

TEST(BakeSkin, figures_behind_joints_that_move_are_those_of_the_oracle_by_every_rule) {
  const std::vector<float> weights = {0.1F, 0.2F, 0.4F};
  std::vector<std::vector<Rows>> worlds;  // the matrices of the joints at each key
  std::vector<float> turns;
  for (const double degrees : {0.0, 70.0, 140.0}) {
    Trs turned;
    const double half = degrees / 360 * std::numbers::pi;
    turned.rotation = {0, std::sin(half), 0, std::cos(half)};
    worlds.push_back({Trs().rows(), turned.rows()});
    for (const Real c : turned.rotation) turns.push_back(static_cast<float>(c));
  }
  GltfBuilder builder = played_hills(4, weights, "STEP");
  const Skin skin = skin_of(true);
  add_skin(builder, skin, {});
  add_turns(builder, {0, 1, 2}, turns, "STEP");
  for (const auto& [name, rule] :
       {std::pair("three", Carry::kBlended), {"bevy", Carry::kInverseTranspose}, {"filament", Carry::kByJoint}}) {
    const Baked baked = test::bake_document(builder, smallest(kTolerance, find_viewers(name).value()));
    ASSERT_TRUE(baked.ok()) << baked.error;
    const test::GltfTruth truth(*baked.before, 0);
    const std::vector<test::Vector> base = truth.normals_at({0, 0});
    double worst = 0;
    for (std::size_t key = 0; key < 3; ++key) {
      const double w = static_cast<double>(weights[key]);
      const std::vector<test::Vector> exact = truth.normals_at({w, w});
      for (std::size_t v = 0; v < kVertices; ++v) {
        const test::Vector& stored = truth.vertices[v].stored;
        const test::Vector right = test::GltfTruth::turn(base[v], stored, test::unit_of(exact[v]));
        const auto seen = [&, rule = rule](const test::Vector& n) { return carried(rule, skin, worlds[key], v, n); };
        worst = std::max(worst, static_cast<double>(test::degrees_between(seen(stored), seen(right))));
      }
    }
    EXPECT_NEAR(baked.report.meshes[0].candidates.front().played.worst, worst, 1e-3) << name;
  }
}

TEST(BakeSkin, tolerance_holds_in_each_viewer_in_its_own_way) {
  // The joint scales z by 4. Three.js applies the blended matrix to normals, which stretches their z. Bevy applies the
  // inverse transpose of the blended matrix, which shrinks the z of normals.
  const Trs high = scaled(1, 1, 4);
  GltfBuilder builder = played_hills(2, {0, 0.2F});
  add_skin(builder, skin_of(false), high);
  const Baked three = test::bake_document(builder, smallest(kTolerance, {kThree}));
  const Baked bevy = test::bake_document(builder, smallest(kTolerance, {kBevy}));
  EXPECT_LT(seen_error(three, skin_of(false), standing(high)).worst, 1.02 * kTolerance);
  EXPECT_LT(seen_error(bevy, skin_of(false), standing(high), Carry::kInverseTranspose).worst, 1.02 * kTolerance);
  EXPECT_GT(seen_error(three, skin_of(false), standing(high), Carry::kInverseTranspose).worst, 1.2 * kTolerance);
}

TEST(BakeSkin, what_viewers_show_before_and_after_is_seen_in_their_own_ways) {
  // If the blended matrix flattens the mesh, its inverse transpose changes normals as a matrix does that stretches the
  // mesh.
  const auto viewers_of = [](Real height, const std::vector<Viewer>& viewers) {
    GltfBuilder builder = played_hills(3, {0, 0.4F});
    add_skin(builder, skin_of(false), scaled(1, 1, height));
    BakeOptions options = smallest(kTolerance, viewers);
    options.encoding = BakeEncoding::kEndpoint;
    return test::bake_document(builder, options).report.meshes.at(0).viewers;
  };
  const std::vector<ViewerChange> both = viewers_of(0.25, {kThree, kBevy});
  const ViewerChange raised = viewers_of(4, {kThree}).at(0), even = viewers_of(1, {kThree}).at(0);
  ASSERT_EQ(both.size(), 2U);
  for (std::size_t kind = 0; kind < 2; ++kind) {  // 0: with the deltas of the file, 1: with random deltas
    const ShownErrors &lowered = both[0].poses[kind].before, &bevy = both[1].poses[kind].before;
    EXPECT_GT(even.poses[kind].before.judged, 0U);
    EXPECT_GT(lowered.mean, 1.2 * even.poses[kind].before.mean);
    EXPECT_NEAR(bevy.mean, raised.poses[kind].before.mean, 1e-3);
    EXPECT_NEAR(bevy.worst, raised.poses[kind].before.worst, 1e-3);
    EXPECT_LT(bevy.mean, even.poses[kind].before.mean);
  }
}

// Returns a text with the candidates that a bake considered, and the deltas that the bake wrote.
std::string choices_of(const Baked& baked) {
  std::string text;
  for (const BakedCandidate& c : baked.report.meshes.at(0).candidates)
    text += std::string(c.name) + " " + std::to_string(c.targets) + " " + std::to_string(c.bytes) + " " +
            std::to_string(c.played.judged) + " " + std::to_string(c.played.mean) + " " + std::to_string(c.chosen) +
            "\n";
  for (const auto& target : baked.mesh()["primitives"][0]["targets"])
    for (const float c : baked.numbers(target["NORMAL"])) text += std::to_string(c) + " ";
  return text + std::to_string(baked.report.added_bytes);
}

TEST(BakeSkin, joints_that_turn_and_scale_evenly_change_nothing) {
  const Baked without = test::bake_document(played_hills(2, {0, 0.4F}), smallest());
  ASSERT_TRUE(without.ok());
  Trs even;
  even.translation = {1, 2, 3};
  even.rotation = {0.6, 0, 0, 0.8};
  even.scale = {0.01, 0.01, 0.01};
  Skin two = skin_of(false);  // each row of vertices follows one of the two joints
  for (std::size_t v = 0; v < kVertices; ++v) two.joints[0][4 * v] = static_cast<std::uint8_t>(v / kSide % 2);
  GltfBuilder builder = played_hills(2, {0, 0.4F});
  add_skin(builder, two, even);
  add_turns(builder, {0, 0.3F, 1}, {0, 0, 0, 1, 1, 0, 0, 0, 0.6F, 0, 0.8F, 0});
  EXPECT_EQ(choices_of(test::bake_document(builder, smallest())), choices_of(without));
  // A skin that cannot be read must change nothing: the bake must be the same as without a skin.
  builder.json["nodes"][1]["scale"] = {1, 1, 0.1};
  EXPECT_NE(choices_of(test::bake_document(builder, smallest())), choices_of(without));
  builder.json["skins"][0]["joints"] = {1, 17};
  EXPECT_EQ(choices_of(test::bake_document(builder, smallest())), choices_of(without));
}

TEST(BakeSkin, each_node_that_a_track_drives_is_seen_through_its_own_skin) {
  // Node 0 has no skin, and the skin of node 3 flattens the mesh. The tolerance must be kept for both nodes.
  const Trs flat = scaled(1, 1, 0.25);
  GltfBuilder builder = played_hills(2, {0, 0.2F});
  add_skin(builder, skin_of(false), flat);
  builder.json["nodes"][0].erase("skin");
  builder.add_node(0, {{"skin", 0}});
  Json channel = builder.json["animations"][0]["channels"][0];
  channel["target"]["node"] = 3;
  builder.json["animations"][0]["channels"].push_back(channel);
  const Baked baked = test::bake_document(builder, smallest());
  ASSERT_TRUE(baked.ok()) << baked.error;
  EXPECT_LT(seen_error(baked, skin_of(false), standing(flat)).worst, 1.02 * kTolerance);
  EXPECT_LT(seen_error(baked, skin_of(false), standing({})).worst, 1.02 * kTolerance);
  EXPECT_TRUE(chosen(baked).within);
  // If the joint stretches the mesh, the node without a skin has larger errors than the node with the skin.
  builder.json["nodes"][1]["scale"] = {1, 1, 8};
  const Baked raised = test::bake_document(builder, smallest());
  EXPECT_LT(seen_error(raised, skin_of(false), standing({})).worst, 1.02 * kTolerance);
}

TEST(BakeSkin, skin_with_too_few_joints_is_not_read_whatever_another_skin_of_the_mesh_has) {
  GltfBuilder builder = played_hills(2, {0, 0.2F});
  add_skin(builder, skin_of(true), scaled(1, 1, 0.25));
  builder.add_node(0, {{"skin", builder.add("skins", {{"joints", {2}}})}});
  Json channel = builder.json["animations"][0]["channels"][0];
  channel["target"]["node"] = 3;
  builder.json["animations"][0]["channels"].push_back(channel);
  const Baked baked = test::bake_document(builder, smallest());
  builder.json["nodes"][3].erase("skin");
  EXPECT_EQ(choices_of(baked), choices_of(test::bake_document(builder, smallest())));
}

TEST(BakeSkin, targets_without_an_animation_are_seen_in_the_pose_of_the_file) {
  const Trs flat = scaled(1, 1, 0.2);
  GltfBuilder builder = test::still_hills_document(1, 3);
  const Baked without = test::bake_document(builder, smallest(4));
  add_skin(builder, skin_of(false), flat);
  const Baked baked = test::bake_document(builder, smallest(4));
  ASSERT_TRUE(baked.ok() && without.ok());
  EXPECT_TRUE(chosen(baked).skinned);
  EXPECT_GT(chosen(baked).played.worst, 1.5 * chosen(without).played.worst);
  builder.json["nodes"][1]["scale"] = {3, 3, 3};
  EXPECT_FALSE(chosen(test::bake_document(builder, smallest(4))).skinned);
}

TEST(BakeSkin, no_surface_gets_worse_behind_the_skin) {
  // The deltas of the file are exact deltas plus noise. At some vertices, the deltas of the file have smaller errors
  // before skinning than the deltas of the bake, but larger errors after skinning.
  const Trs flat = scaled(1, 1, 0.1);
  for (const BakeEncoding encoding : {BakeEncoding::kEndpoint, BakeEncoding::kHarmless, BakeEncoding::kSmallest}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      GltfBuilder builder = played_hills(seed, {0, 1});
      const test::GltfPlayer player(builder.glb());
      const test::GltfTruth truth(player, 0);
      const std::vector<test::Vector> base = truth.normals_at({0, 0});
      test::Hills noise(seed + 50);
      for (std::size_t k = 0; k < kTargets; ++k) {
        const std::vector<test::Vector> end = truth.normals_at({k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0});
        std::vector<float> deltas;
        for (std::size_t v = 0; v < kVertices; ++v) {
          const test::Vector right = test::unit_of(test::GltfTruth::turn(base[v], truth.vertices[v].stored, end[v]));
          for (std::size_t c = 0; c < 3; ++c)
            deltas.push_back(static_cast<float>(right[c] - truth.vertices[v].stored[c]) + noise.uniform(-0.1, 0.1));
        }
        builder.json["meshes"][0]["primitives"][0]["targets"][k]["NORMAL"] = builder.add_positions(deltas);
      }
      add_skin(builder, skin_of(false), flat);
      BakeOptions options = smallest(0.1);
      options.encoding = encoding;
      options.most_targets = kTargets;
      options.weighting = Weighting::kArea;
      const Baked baked = test::bake_document(builder, options);
      ASSERT_TRUE(baked.ok()) << baked.error;
      test::ShownError before_of_all, after_of_all;
      const std::vector<test::Pose> poses = test::poses_of(*baked.before, *baked.after, 0, 0);
      for (const test::Pose& pose : poses) {
        const std::vector<test::Vector> exact = truth.normals_at(pose.before);
        for (std::size_t v = 0; v < kVertices; ++v) {
          const auto seen = [&](const test::Vector& n) {
            return carried(Carry::kBlended, skin_of(false), {flat.rows(), Trs().rows()}, v, n);
          };
          const test::Vector right =
              seen(test::unit_of(test::GltfTruth::turn(base[v], truth.vertices[v].stored, exact[v])));
          const auto error_of = [&](const test::GltfPlayer& viewer, const std::vector<float>& weights) {
            return static_cast<double>(test::degrees_between(
                seen(viewer.shown(viewer.json["meshes"][0]["primitives"][0], v, weights)), right));
          };
          before_of_all.add(error_of(*baked.before, {pose.before.begin(), pose.before.end()}));
          after_of_all.add(error_of(*baked.after, pose.after));
        }
      }
      EXPECT_LE(after_of_all.mean(), before_of_all.mean() + 0.01) << name_of(encoding) << " " << seed;
      EXPECT_LE(after_of_all.worst, 1.03 * before_of_all.worst + 0.1) << name_of(encoding) << " " << seed;
    }
  }
}

TEST(BakeSkin, says_where_the_skin_leaves_no_form_within) {
  GltfBuilder builder = played_hills(2, {0, 0.2F});
  BakeOptions options = smallest(2);
  options.most_targets = kTargets;
  const Baked without = test::bake_document(builder, options);
  EXPECT_TRUE(chosen(without).within) << chosen(without).played.worst;
  add_skin(builder, skin_of(false), scaled(1, 1, 0.1));
  const Baked baked = test::bake_document(builder, options);
  ASSERT_TRUE(baked.ok()) << baked.error;
  EXPECT_FALSE(chosen(baked).within) << chosen(baked).played.worst;
  ASSERT_FALSE(baked.report.warnings.empty());
  EXPECT_NE(baked.report.warnings.front().find("could not bring all errors within 2 degrees with the skin applied"),
            std::string::npos)
      << baked.report.warnings.front();
  const auto& candidates = baked.report.meshes[0].candidates;
  EXPECT_EQ(std::count_if(candidates.begin(), candidates.end(), [](const BakedCandidate& c) { return c.chosen; }), 1);
}

TEST(BakeSkin, file_that_was_baked_before_is_judged_behind_its_skin) {
  GltfBuilder builder = played_hills(2, {0, 0.2F});
  add_skin(builder, skin_of(false), scaled(1, 1, 0.25));
  const Baked once = test::bake_document(builder, smallest());
  ASSERT_TRUE(once.ok()) << once.error;
  const Baked again = test::bake_bytes(once.bytes, smallest());
  ASSERT_TRUE(again.report.meshes.at(0).already_baked);
  EXPECT_NEAR(chosen(again).played.worst, chosen(once).played.worst, 0.02 * chosen(once).played.worst);
  EXPECT_TRUE(chosen(again).within);
}

}  // namespace
}  // namespace chronormal::bake_skin_test
