#include "chronormal/workflow/bake.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/bake_fixture.h"

namespace chronormal::bake_test {
namespace {

using Json = nlohmann::json;
using test::Baked;
using test::GltfBuilder;
using test::Pose;
using test::ShownError;

BakeOptions with(BakeEncoding encoding) {
  BakeOptions options;
  options.encoding = encoding;
  return options;
}

// Returns poses in which one target alone is active, with weights from 0 to 1. The weights of correction targets follow
// from their formulas.
std::vector<Pose> poses_of_target(const Baked& baked, std::size_t mesh, std::size_t target) {
  const Json& targets = baked.before->json["meshes"][mesh]["primitives"][0]["targets"];
  const Json& after = baked.json()["meshes"][mesh];
  std::vector<Pose> poses;
  for (int i = 0; i <= 100; ++i) {
    Pose pose;
    pose.before.assign(targets.size(), 0.0);
    pose.before[target] = i / 100.0;
    pose.after.assign(after["primitives"][0]["targets"].size(), 0.0F);
    pose.after[target] = static_cast<float>(i / 100.0);
    if (!after.contains("extras") || !after["extras"].contains("chronormal")) {  // the mesh remains flat-shaded
      poses.push_back(std::move(pose));
      continue;
    }
    for (const Json& extra : after["extras"]["chronormal"]["extras"]) {
      float weight = 0;
      const auto of = [&](const Json& index) { return pose.after[index.get<std::size_t>()]; };
      for (const Json& term : extra["linear"]) weight += term[1].get<float>() * of(term[0]);
      for (const Json& term : extra["quadratic"]) weight += term[2].get<float>() * of(term[0]) * of(term[1]);
      pose.after[extra["target"].get<std::size_t>()] = weight;
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

ShownError target_error(const Baked& baked, std::size_t target, std::size_t mesh = 0) {
  return test::shown_error(test::GltfTruth(*baked.before, mesh), *baked.after, mesh,
                           poses_of_target(baked, mesh, target));
}

// Makes a random document: one to four targets, each of which moves a random part of the hills, and a track with random
// interpolation and weights in [-1, 2].
GltfBuilder random_document(unsigned seed) {
  GltfBuilder builder;
  test::Hills hills(seed);
  const std::size_t targets = 1 + hills.below(4), keys = 2 + hills.below(4);
  std::vector<std::vector<float>> deltas;
  for (std::size_t k = 0; k < targets; ++k) deltas.push_back(hills.deltas(hills.uniform(0.2, 1), 0.15));
  builder.add_node(builder.add_mesh(hills.primitive(builder, deltas)));
  const char* interpolation = std::vector{"LINEAR", "STEP", "CUBICSPLINE"}[seed % 3];
  std::vector<float> times, values;
  for (std::size_t key = 0; key < keys; ++key) {
    times.push_back((times.empty() ? 0 : times.back()) + hills.uniform(0.01, 1));
    for (std::size_t k = 0; k < targets * (seed % 3 == 2 ? 3 : 1); ++k)
      values.push_back(hills.below(3) == 0 ? 0.0F : hills.uniform(-1, 2));
  }
  builder.add_animation("random");
  builder.add_track(0, 0, times, values, interpolation);
  return builder;
}

TEST(Bake, exact_is_exact_for_random_targets_and_tracks) {
  std::size_t driven = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const Baked baked = test::bake_document(random_document(seed), with(BakeEncoding::kExact));
    ASSERT_EQ(baked.error, "");
    const ShownError error = test::track_error(baked);
    test::expect_exact(error);
    driven += baked.report.added_targets > 0 ? 1 : 0;
  }
  EXPECT_GT(driven, 50U);
}

TEST(Bake, what_is_not_baked_is_wrong) {
  // Tests the measurement itself: the file must have errors before the bake.
  GltfBuilder builder = test::hills_document(1);
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  Baked baked = test::bake_document(builder);
  baked.after = std::make_unique<test::GltfPlayer>(builder.glb());
  EXPECT_GT(test::track_error(baked).worst, 5);
}

TEST(Bake, endpoint_is_right_at_both_ends_and_states_its_error) {
  for (unsigned seed = 1; seed < 8; ++seed) {
    const Baked baked = test::bake_document(test::with_misleading_normals(test::still_hills_document(2, seed)),
                                            with(BakeEncoding::kEndpoint));
    ASSERT_EQ(baked.error, "");
    EXPECT_EQ(baked.report.added_targets, 0U);
    double worst = 0;
    for (std::size_t target = 0; target < 2; ++target) {
      worst = std::max(worst, target_error(baked, target).worst);
      std::vector<Pose> poses = poses_of_target(baked, 0, target);
      const ShownError ends =
          test::shown_error(test::GltfTruth(*baked.before, 0), *baked.after, 0, {poses.front(), poses.back()});
      EXPECT_LT(ends.worst, 1e-3);
    }
    EXPECT_LE(worst, baked.report.meshes[0].largest_error + 1e-3);
    EXPECT_GE(worst, 0.9 * baked.report.meshes[0].largest_error);
  }
}

bool warns_of(const Baked& baked, const std::string& words) {
  const std::vector<std::string>& warnings = baked.report.warnings;
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& warning) { return warning.find(words) != std::string::npos; });
}

TEST(Bake, the_smallest_form_is_written_where_no_encoding_is_asked_for) {
  GltfBuilder builder = test::still_hills_document(1);
  const Baked still = test::bake_document(builder);
  EXPECT_EQ(still.report.meshes[0].encoding, BakeEncoding::kSmallest);
  EXPECT_EQ(still.report.added_targets, 0U);
  EXPECT_TRUE(warns_of(still, "no animation drives"));
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  const Baked driven = test::bake_document(builder);
  EXPECT_EQ(driven.report.meshes[0].encoding, BakeEncoding::kSmallest);
  EXPECT_GT(driven.report.added_targets, 0U);
  EXPECT_EQ(driven.bytes, test::bake_document(builder, with(BakeEncoding::kSmallest)).bytes);
}

TEST(Bake, exact_without_animations_says_in_the_mesh_and_its_nodes_what_drives_extra_targets) {
  const Baked baked = test::bake_document(test::still_hills_document(2), with(BakeEncoding::kExact));
  ASSERT_EQ(baked.report.meshes[0].extras.size(), 3U);
  const Json expected = R"({"version": 2, "encode": "exact", "sequence": false, "extras": [
    {"target": 2, "linear": [[0, 1.0]], "quadratic": [[0, 0, -1.0]]}, {"target": 3, "linear": [], "quadratic": [[0, 1, 1.0]]},
    {"target": 4, "linear": [[1, 1.0]], "quadratic": [[1, 1, -1.0]]}]})"_json;
  EXPECT_EQ(baked.mesh()["extras"]["chronormal"], expected);
  EXPECT_EQ(baked.json()["nodes"][0]["extras"]["chronormal"], expected);
  EXPECT_EQ(Json::parse(baked.report.drivers),
            Json({{"meshes", {{{"mesh", 0}, {"name", "hills"}, {"chronormal", expected}}}}}));
  std::vector<Pose> poses;
  for (const auto& [a, b] : {std::pair{0.5F, 0.5F}, {1.0F, 0.25F}, {-0.5F, 1.5F}})
    poses.push_back({{static_cast<double>(a), static_cast<double>(b)}, {a, b, a * (1 - a), a * b, b * (1 - b)}});
  test::expect_exact(test::shown_error(test::GltfTruth(*baked.before, 0), *baked.after, 0, poses));
}

TEST(Bake, extras_of_a_node_stay_and_those_that_are_no_object_are_told_of) {
  GltfBuilder builder = test::still_hills_document(1);
  builder.json["nodes"][0]["extras"] = {{"mine", 7}};
  builder.add_node(0);
  builder.json["nodes"][1]["extras"] = "a note";
  builder.add_node(0);
  const Baked baked = test::bake_document(builder, with(BakeEncoding::kExact));
  const Json& nodes = baked.json()["nodes"];
  EXPECT_EQ(nodes[0]["extras"]["mine"], 7);
  EXPECT_EQ(nodes[0]["extras"]["chronormal"], baked.mesh()["extras"]["chronormal"]);
  EXPECT_EQ(nodes[1]["extras"], "a note");
  EXPECT_EQ(nodes[2]["extras"]["chronormal"], baked.mesh()["extras"]["chronormal"]);
  EXPECT_EQ(baked.report.meshes[0].unmarked_nodes, std::vector<std::size_t>{1});
  const auto tells = [](const std::string& warning) {
    return warning.find("extras of node 1 are not a JSON object") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(baked.report.warnings.begin(), baked.report.warnings.end(), tells));
  // The encoding endpoint writes one delta for each target, so the extras of the file need no formulas for correction
  // targets.
  const Baked endpoint = test::bake_document(builder, with(BakeEncoding::kEndpoint));
  EXPECT_FALSE(endpoint.json()["nodes"][0]["extras"].contains("chronormal"));
}

TEST(Bake, normals_of_extreme_length_are_brought_to_length_1_and_then_right) {
  for (const float length : {3e38F, 1e12F, 1e-12F, 1e-38F}) {
    GltfBuilder builder;
    test::Hills hills(3);
    const std::vector<float> targets[] = {hills.deltas(), hills.deltas()};
    for (float& c : hills.normals) c *= length;
    builder.add_node(builder.add_mesh(hills.primitive(builder, {targets[0], targets[1]})));
    builder.add_animation("move");
    builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0.5F, 1, -0.5F});
    for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kEndpoint}) {
      const Baked baked = test::bake_document(builder, with(encoding));
      ASSERT_EQ(baked.error, "");
      EXPECT_EQ(baked.report.meshes[0].rescaled, 25U);
      for (const float c : baked.numbers(baked.mesh()["primitives"][0]["attributes"]["NORMAL"]))
        EXPECT_LE(std::fabs(c), 1);
      if (encoding == BakeEncoding::kExact) test::expect_exact(test::track_error(baked));
    }
  }
  // If the normals of a file have usual lengths, a bake must rescale no normals and keep the base normals.
  const Baked usual = test::bake_document(test::still_hills_document(1));
  EXPECT_EQ(usual.report.meshes[0].rescaled, 0U);
  EXPECT_EQ(usual.mesh()["primitives"][0]["attributes"],
            usual.before->json["meshes"][0]["primitives"][0]["attributes"]);
}

TEST(Bake, a_target_that_moves_normals_alone_moves_none_when_it_was_baked) {
  for (const bool is_alone : {false, true}) {
    GltfBuilder builder;
    test::Hills hills(4);
    std::vector<std::vector<float>> targets;
    if (!is_alone) targets.push_back(hills.deltas());
    Json primitive = hills.primitive(builder, targets);
    primitive["targets"].push_back({{"NORMAL", builder.add_positions(hills.deltas())}});
    builder.add_node(builder.add_mesh(primitive));
    const Baked baked = test::bake_document(builder);
    ASSERT_EQ(baked.error, "");
    ASSERT_EQ(baked.report.meshes.size(), 1U);
    EXPECT_EQ(baked.report.meshes[0].stilled, 1U);
    const Json& after = baked.mesh()["primitives"][0]["targets"][is_alone ? 0 : 1];
    for (const float c : baked.numbers(after["NORMAL"])) EXPECT_EQ(c, 0);
  }
}

TEST(Bake, keys_that_are_too_near_for_the_slopes_of_products_are_told_of) {
  GltfBuilder builder = test::hills_document(1);
  builder.add_track(0, 0, std::vector<float>{0, 1e-45F, 1}, std::vector<float>{0, 1, 0});
  const Baked baked = test::bake_document(builder, with(BakeEncoding::kExact));
  ASSERT_EQ(baked.error, "");
  EXPECT_NEAR(baked.report.meshes[0].resampling_error, 180, 1e-9);
  const auto tells = [](const std::string& warning) {
    return warning.find("these keys are too close") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(baked.report.warnings.begin(), baked.report.warnings.end(), tells));
}

TEST(Bake, targets_that_nothing_drives_get_the_best_single_delta) {
  GltfBuilder builder = test::hills_document(2);
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 0});
  const Baked baked = test::bake_document(builder, with(BakeEncoding::kExact));
  const BakedMesh& mesh = baked.report.meshes[0];
  EXPECT_EQ(mesh.encoding, BakeEncoding::kExact);
  EXPECT_EQ(mesh.undriven, 1U);
  EXPECT_EQ(mesh.extras.size(), 1U);
  EXPECT_LT(target_error(baked, 0).worst, 0.05);
  const double worst = target_error(baked, 1).worst;
  EXPECT_LE(worst, mesh.largest_error + 1e-3);
  EXPECT_GE(worst, 0.9 * mesh.largest_error);
}

TEST(Bake, a_baked_file_is_left_as_it_is) {
  for (const auto& [encoding, name] : kBakeEncodings) {
    if (encoding == BakeEncoding::kKeys) continue;  // the encoding keys is only for sequences
    SCOPED_TRACE(name);
    GltfBuilder builder = test::hills_document(2);
    builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
    const Baked first = test::bake_document(builder, with(encoding));
    ASSERT_TRUE(first.report.changed);
    const Baked second = test::bake_bytes(first.bytes, with(encoding));
    ASSERT_EQ(second.error, "");
    EXPECT_FALSE(second.report.changed);
    EXPECT_TRUE(second.report.meshes[0].already_baked);
    EXPECT_EQ(second.report.meshes[0].encoding, encoding);
    EXPECT_EQ(second.bytes, first.bytes);
  }
}

// Blender 3.4 exports a baked file in this form: every target has its own normals, and booleans in the extras have
// become numbers.
TEST(Bake, extra_targets_that_another_program_emptied_are_left_and_new_ones_written_beside_them) {
  GltfBuilder builder = test::still_hills_document(1);
  Json& mesh = builder.json["meshes"][0];
  const std::size_t zeros = builder.add_positions(std::vector<float>(75));
  mesh["primitives"][0]["targets"].push_back({{"POSITION", zeros}, {"NORMAL", zeros}});
  const Json mark = R"({"version": 2, "encode": "exact", "sequence": 0, "extras": [
    {"target": 1, "linear": [[0.0, 1.0]], "quadratic": [[0.0, 0.0, -1.0]]}]})"_json;
  mesh["extras"] = {{"chronormal", mark}, {"targetNames", {"raise", "chronormal w0*(1-w0)"}}};
  builder.json["nodes"][0]["extras"] = {{"chronormal", mark}};
  const Baked baked = test::bake_document(builder, with(BakeEncoding::kExact));
  ASSERT_EQ(baked.error, "");
  EXPECT_TRUE(baked.report.changed);
  EXPECT_FALSE(baked.report.meshes[0].already_baked);
  EXPECT_EQ(baked.mesh()["extras"]["targetNames"], Json({"raise", "chronormal w0*(1-w0)", "chronormal w0*(1-w0) (2)"}));
  EXPECT_EQ(baked.mesh()["extras"]["chronormal"]["extras"].size(), 1U);
  EXPECT_EQ(baked.mesh()["extras"]["chronormal"]["extras"][0]["target"], 2);
  EXPECT_EQ(baked.json()["nodes"][0]["extras"], Json({{"chronormal", baked.mesh()["extras"]["chronormal"]}}));
  std::vector<Pose> poses;
  for (const float w : {0.25F, 0.5F, 1.0F}) poses.push_back({{static_cast<double>(w), 0}, {w, 0, w * (1 - w)}});
  test::expect_exact(test::shown_error(test::GltfTruth(*baked.before, 0), *baked.after, 0, poses));
}

TEST(Bake, a_baked_file_without_extra_targets_can_be_baked_in_another_way) {
  GltfBuilder builder = test::hills_document(2);
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  const Baked endpoint = test::bake_document(builder, with(BakeEncoding::kEndpoint));
  ASSERT_EQ(endpoint.error, "");
  ASSERT_TRUE(endpoint.report.meshes[0].extras.empty());
  const Baked exact = test::bake_bytes(endpoint.bytes, with(BakeEncoding::kExact));
  ASSERT_EQ(exact.error, "");
  EXPECT_FALSE(exact.report.meshes[0].already_baked);
  EXPECT_EQ(exact.mesh()["extras"]["chronormal"]["encode"], "exact");
  test::expect_exact(test::track_error(exact));
}

TEST(Bake, stored_normals_of_any_length_keep_their_length_and_offset) {
  GltfBuilder builder;
  test::Hills hills(4);
  for (std::size_t i = 0; i < hills.normals.size(); ++i) hills.normals[i] *= i / 3 % 2 == 0 ? 0.5F : 3;
  builder.add_node(builder.add_mesh(hills.primitive(builder, {hills.deltas()})));
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  test::expect_exact(test::track_error(test::bake_document(builder, with(BakeEncoding::kExact))));
}

TEST(Bake, base_without_area_is_right_but_near_weight_0) {
  GltfBuilder builder;
  test::Hills hills(5);
  const std::vector<float> spread = hills.positions;
  hills.positions.assign(spread.size(), 0);  // all vertices are at one point in the base
  builder.add_node(builder.add_mesh(hills.primitive(builder, {spread})));
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0.01F, 1});
  // Every vertex has its own normal, so each vertex is a separate element. In the base, no element has an area.
  const Baked baked = test::bake_document(builder, with(BakeEncoding::kExact));
  ASSERT_EQ(baked.error, "");
  EXPECT_EQ(baked.report.meshes[0].without_base, 25U);
  const ShownError error = test::track_error(baked);
  EXPECT_GT(error.judged, 0U);
  EXPECT_LT(error.worst, 1e-6 / (0.01 * 0.01) * 180 / 3.14);
}

TEST(Bake, smooth_gives_normals_to_flat_primitives) {
  GltfBuilder builder;
  test::Hills hills(6);
  builder.add_node(builder.add_mesh(hills.primitive(builder, {hills.deltas()}, false)));
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  const Baked flat = test::bake_document(builder);
  EXPECT_FALSE(flat.report.changed);
  EXPECT_EQ(flat.report.meshes[0].left_flat, 1U);
  EXPECT_EQ(flat.bytes, builder.glb());
  Baked smooth = test::bake_document(builder, {.encoding = BakeEncoding::kExact, .smooth = true});
  ASSERT_EQ(smooth.error, "");
  // The oracle takes base normals from the file. The source file has no normals, so the oracle reads the baked file.
  smooth.before = std::make_unique<test::GltfPlayer>(smooth.bytes);
  const test::GltfTruth truth(*smooth.before, 0);
  std::vector<Pose> poses;
  for (int i = 0; i <= 100; ++i) {
    const std::vector<float> weights = smooth.after->weights_at(0, 0, i / 100.0);
    poses.push_back({{weights.begin(), weights.end()}, weights});
  }
  test::expect_exact(test::shown_error(truth, *smooth.after, 0, poses));
  const std::vector<test::Vector> base = truth.normals_at({0, 0});
  for (std::size_t v = 0; v < base.size(); ++v)
    EXPECT_LT(test::degrees_between(base[v], truth.vertices[v].stored), 1e-4);
}

TEST(Bake, recomputed_base_is_that_of_the_geometry) {
  GltfBuilder builder = test::hills_document(1);
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  const Baked baked = test::bake_document(builder, {.recompute_base = true});
  ASSERT_EQ(baked.error, "");
  const std::vector<test::Vector> base = test::GltfTruth(*baked.before, 0).normals_at({0});
  const std::vector<float> stored = baked.numbers(baked.mesh()["primitives"][0]["attributes"]["NORMAL"]);
  for (std::size_t v = 0; v < base.size(); ++v) {
    const test::Vector n = {stored[3 * v], stored[3 * v + 1], stored[3 * v + 2]};
    EXPECT_LT(test::degrees_between(base[v], n), 1e-4);
    EXPECT_NEAR(static_cast<double>(test::length_of(n)), 1, 1e-6);
  }
}

TEST(Bake, pairs_below_the_tolerance_are_left_out_and_stated) {
  GltfBuilder builder;
  test::Hills hills(7);
  builder.add_node(builder.add_mesh(hills.primitive(builder, {hills.deltas(1, 0.3), hills.deltas(1, 0.001)})));
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  const auto added = [&builder](double tolerance) {
    BakeOptions options = with(BakeEncoding::kExact);
    options.tolerance = tolerance;
    const Baked baked = test::bake_document(builder, options);
    EXPECT_EQ(baked.error, "");
    const double stated = baked.report.meshes[0].resampling_error;
    EXPECT_LE(stated, tolerance);
    EXPECT_LE(test::track_error(baked).worst, stated + 1e-2) << "it is measured at some instants";
    return baked.report.added_targets;
  };
  EXPECT_EQ(added(0), 3U);
  EXPECT_EQ(added(0.2), 1U) << "the square of the strong target alone";
  EXPECT_EQ(added(90), 0U);
}

TEST(Bake, pairs_of_a_long_animation_are_left_out_until_their_sum_is_the_tolerance) {
  // The animation has more keys than the bake measures poses. The bake therefore bounds the error of all omitted pairs
  // of targets by the sum of their errors.
  GltfBuilder builder;
  test::Hills hills(9);
  std::vector<std::vector<float>> deltas;
  for (int k = 0; k < 5; ++k) deltas.push_back(hills.deltas(1, 0.01));
  builder.add_node(builder.add_mesh(hills.primitive(builder, deltas)));
  builder.add_animation("");
  std::vector<float> times, values;
  for (int key = 0; key < 2200; ++key) {
    times.push_back(static_cast<float>(key));
    for (int k = 0; k < 5; ++k) values.push_back(hills.uniform(0, 1));
  }
  builder.add_track(0, 0, times, values, "STEP");
  std::size_t before = 16;
  for (double tolerance = 1e-3; tolerance < 10; tolerance *= 1.5) {
    BakeOptions options = with(BakeEncoding::kExact);
    options.tolerance = tolerance;
    const Baked baked = test::bake_document(builder, options);
    ASSERT_EQ(baked.error, "");
    EXPECT_LE(baked.report.meshes[0].resampling_error, tolerance);
    EXPECT_LE(baked.report.added_targets, before);
    before = baked.report.added_targets;
  }
  EXPECT_EQ(before, 0U);
}

TEST(Bake, targets_that_only_scale_need_no_extra_ones) {
  GltfBuilder builder;
  test::Hills hills(8);
  builder.add_node(builder.add_mesh(hills.primitive(builder, {hills.positions})));  // the target doubles the size
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  const Baked baked = test::bake_document(builder, with(BakeEncoding::kExact));
  EXPECT_EQ(baked.report.added_targets, 0U);
  test::expect_exact(test::track_error(baked));
}

TEST(Bake, terms_along_the_normal_are_not_left_out_where_together_they_turn_it_over) {
  // n(w) = (1 + w0 + w1 + w2)^2 n(0), which is 0.16 n(0) if all weights are -0.2. No single square or product changes
  // the length as much as all of them together.
  GltfBuilder builder;
  test::Hills hills(8);
  const std::vector<float>& grow = hills.positions;
  builder.add_node(builder.add_mesh(hills.primitive(builder, {grow, grow, grow})));
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 0, -0.2F, -0.2F, -0.2F});
  test::expect_exact(test::track_error(test::bake_document(builder, with(BakeEncoding::kExact))));
}

TEST(Bake, a_wink_in_a_long_animation_is_not_overlooked) {
  GltfBuilder builder = test::hills_document(1);
  std::vector<float> times(20000), values(20000);
  for (std::size_t key = 0; key < times.size(); ++key) times[key] = static_cast<float>(key);
  values[7777] = 1;
  builder.add_track(0, 0, times, values);
  const Baked baked = test::bake_document(builder, with(BakeEncoding::kExact));
  ASSERT_EQ(baked.report.added_targets, 1U);
  const test::GltfTruth truth(*baked.before, 0);
  const std::vector<float> half = baked.after->weights_at(0, 0, 7776.5);
  test::expect_exact(test::shown_error(truth, *baked.after, 0, {{{0.5}, half}}));
}

TEST(Bake, fitted_weightings_are_within_their_bound_of_the_weighted_normals) {
  GltfBuilder builder;
  test::Hills hills(10);
  builder.add_node(builder.add_mesh(hills.primitive(builder, {hills.deltas(1, 0.1)})));
  builder.add_animation("");
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  BakeOptions options = with(BakeEncoding::kExact);
  options.weighting = Weighting::kUniform;
  const Baked baked = test::bake_document(builder, options);
  ASSERT_EQ(baked.error, "");
  test::GltfTruth truth(*baked.before, 0);
  truth.uniform = true;
  const ShownError error = test::shown_error(truth, *baked.after, 0, test::poses_of(*baked.before, *baked.after, 0, 0));
  EXPECT_GT(baked.report.meshes[0].largest_error, 0);
  EXPECT_LT(baked.report.meshes[0].largest_error, 2);
  EXPECT_LE(error.worst, baked.report.meshes[0].largest_error + 1e-3);
  EXPECT_GT(test::track_error(baked).worst, 2 * error.worst) << "by area it is another normal";
}

TEST(Bake, fitted_weightings_are_right_where_one_or_two_targets_have_weight_1) {
  GltfBuilder builder = test::hills_document(3);
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 0, 1, 1, 1});
  const auto error_at = [&](const Baked& baked, const std::vector<double>& weights) {
    test::GltfTruth truth(*baked.before, 0);
    truth.uniform = true;
    std::vector<float> all(weights.begin(), weights.end());
    for (const GltfExtraTarget& extra : baked.report.meshes[0].extras)
      all.push_back(static_cast<float>(extra.weight(weights)));
    return test::shown_error(truth, *baked.after, 0, {{weights, all}}).worst;
  };
  const Baked uniform =
      test::bake_document(builder, {.encoding = BakeEncoding::kExact, .weighting = Weighting::kUniform});
  const Baked area = test::bake_document(builder, {.encoding = BakeEncoding::kExact, .weighting = Weighting::kArea});
  ASSERT_EQ(uniform.error, "");
  EXPECT_EQ(uniform.report.meshes[0].encoding, BakeEncoding::kExact);
  EXPECT_EQ(uniform.report.meshes[0].extras.size(), 6U);
  for (const std::vector<double>& weights :
       {std::vector<double>{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}})
    EXPECT_LT(error_at(uniform, weights), 0.01);
  // At other weights, and if three targets are active, the deltas only approximate the requested weighting. The errors
  // of these deltas must be smaller than the errors of area-weighted normals.
  double of_uniform = 0, of_area = 0;
  for (const double w : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    for (const std::vector<double>& weights : {std::vector<double>{w, w, w}, {w, w, 0}, {w, 1 - w, 0}, {w, 0, 1 - w}}) {
      of_uniform += error_at(uniform, weights);
      of_area += error_at(area, weights);
    }
  }
  EXPECT_LT(of_uniform, 0.5 * of_area);
}

TEST(Bake, errors_say_what_and_where) {
  GltfBuilder builder = test::still_hills_document(1);
  const auto expect = [](const GltfBuilder& document, const BakeOptions& options, const std::string& words) {
    const std::string error = test::bake_document(document, options).error;
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  expect(builder, {.most_bytes = 10}, "bytes, but --max-bytes allows only 10");
  builder.json["meshes"][0]["extras"] = 5;
  expect(builder, {}, "/meshes/0/extras: the extras are not a JSON object");
  GltfBuilder still;
  test::Hills hills(1);
  still.add_mesh(hills.primitive(still, {std::vector<float>(hills.positions.size())}));
  const auto expect_unchanged = [](const GltfBuilder& document) {
    const test::Baked result = test::bake_document(document, {});
    ASSERT_EQ(result.error, "");
    EXPECT_FALSE(result.report.changed);
    EXPECT_TRUE(result.bytes == document.glb());
  };
  expect_unchanged(still);
  GltfBuilder none;
  none.add_mesh(hills.primitive(none, {}));
  expect_unchanged(none);
}

TEST(Bake, more_pairs_of_targets_than_a_file_can_carry_are_refused) {
  constexpr std::size_t kTargets = 141;  // 141 targets have 10,011 products
  GltfBuilder builder = test::hills_document(kTargets);
  std::vector<float> weights(2 * kTargets);
  for (std::size_t k = 0; k < kTargets; ++k) weights[kTargets + k] = 1;
  builder.add_track(0, 0, std::vector<float>{0, 1}, weights);
  const Baked baked = test::bake_document(builder, {.encoding = BakeEncoding::kExact});
  EXPECT_NE(baked.error.find("the result would need more than 10000 correction targets, one for each two targets that "
                             "move the same normals; use --encode endpoint"),
            std::string::npos)
      << baked.error;
}

TEST(Bake, tiny_and_huge_meshes_are_as_exact) {
  for (const float scale : {1e-30F, 1e-12F, 1e12F, 1e18F}) {
    SCOPED_TRACE(scale);
    GltfBuilder builder;
    test::Hills hills(11);
    std::vector<float> deltas = hills.deltas();
    for (float& x : hills.positions) x *= scale;
    for (float& x : deltas) x *= scale;
    builder.add_node(builder.add_mesh(hills.primitive(builder, {deltas})));
    builder.add_animation("");
    builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
    test::expect_exact(test::track_error(test::bake_document(builder, with(BakeEncoding::kExact))));
  }
}

// Bakes every moving glTF file of the real data. Tests the animations of each file, and each target alone.
TEST(BakeRealData, exact_is_exact_in_every_file) {
  const char* data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::string(data) + "/gltf")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    SCOPED_TRACE(entry.path().string());
    const Result<GltfDocument> document = GltfDocument::open(entry.path().string());
    ASSERT_TRUE(document.ok()) << document.error().text();
    const Result<std::string> glb = GltfEdit(document.value()).bytes("a.glb");
    ASSERT_TRUE(glb.ok()) << glb.error().text();
    BakeOptions options = with(BakeEncoding::kExact);
    options.weighting = Weighting::kArea;  // by other weightings, normals are only approximated
    const Baked baked = test::bake_bytes(glb.value(), options);
    ASSERT_EQ(baked.error, "");
    if (baked.report.meshes.empty()) continue;
    ++files;
    std::map<std::size_t, test::GltfTruth> truths;
    for (std::size_t a = 0; a < document.value().animations().size(); ++a) {
      for (const GltfTrack& track : document.value().animations()[a].tracks) {
        const std::size_t mesh = *document.value().nodes()[track.node].mesh;
        const test::GltfTruth& truth = truths.try_emplace(mesh, *baked.before, mesh).first->second;
        const ShownError error =
            test::shown_error(truth, *baked.after, mesh, test::poses_of(*baked.before, *baked.after, a, track.channel));
        EXPECT_LT(error.mean(), 0.01);
        EXPECT_LT(error.worst, 0.05);
      }
    }
    for (const BakedMesh& mesh : baked.report.meshes) {
      for (std::size_t k = 0; k < document.value().meshes()[mesh.mesh].target_count; ++k) {
        const ShownError error = target_error(baked, k, mesh.mesh);
        EXPECT_LT(error.mean(), 0.01);
        EXPECT_LT(error.worst, 0.05);
      }
    }
  }
  EXPECT_GE(files, 9U);
}

// Choosing a candidate takes a large part of the time of a bake, so the bake must report progress during this choice.
TEST(Bake, progress_goes_forward_while_a_form_is_chosen_and_ends_with_everything_done) {
  GltfBuilder builder = test::hills_document(3);
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1, 0.5F, 1, 0, 1});
  std::vector<std::size_t> reached;
  BakeOptions options;
  options.progress = [&](std::size_t done, std::size_t total) {
    EXPECT_EQ(total, 6U);
    reached.push_back(done);
  };
  ASSERT_TRUE(test::bake_document(builder, options).ok());
  EXPECT_TRUE(std::is_sorted(reached.begin(), reached.end()));
  EXPECT_EQ(reached.back(), 6U);
  EXPECT_GT(std::count_if(reached.begin(), reached.end(), [](std::size_t done) { return done < 3; }), 3);
}

}  // namespace
}  // namespace chronormal::bake_test
