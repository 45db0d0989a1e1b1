// Tests, besides true normals, everything that viewers and the specification demand of correction targets.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/viewers.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/gltf_compressed.h"

namespace chronormal::bake_trap_test {
namespace {

using Json = nlohmann::json;
using test::Baked;
using test::GltfBuilder;

const std::vector<float> kTimes = {0, 0.1F, 1};  // 0.1F is not exactly 0.1

// Makes hills with two targets, and a track that moves both targets at the same time.
GltfBuilder moving_hills(const char* interpolation = "LINEAR") {
  GltfBuilder builder = test::hills_document(2);
  if (interpolation == std::string("CUBICSPLINE"))
    builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 0, 0, 1, 2, 0, 0, 1, 0.5F, 0, 0},
                      interpolation);
  else
    builder.add_track(0, 0, kTimes, std::vector<float>{0, 0, 1, 0.25F, 0, 1}, interpolation);
  return builder;
}

// Bakes a document and fails if the bake fails. The encoding is exact unless the options have another encoding.
Baked baked(const GltfBuilder& builder, BakeOptions options = {}) {
  if (!options.encoding) options.encoding = BakeEncoding::kExact;
  Baked result = test::bake_document(builder, options);
  EXPECT_EQ(result.error, "");
  return result;
}

const Json& sampler_of(const Baked& baked, std::size_t animation = 0, std::size_t channel = 0) {
  const Json& a = baked.json()["animations"][animation];
  return a["samplers"][a["channels"][channel]["sampler"].get<std::size_t>()];
}

TEST(BakeTraps, positions_of_extra_targets_are_zeros_without_a_view_but_with_bounds) {
  const Baked result = baked(moving_hills());
  const Json& targets = result.mesh()["primitives"][0]["targets"];
  ASSERT_EQ(targets.size(), 5U);
  for (std::size_t k = 2; k < 5; ++k) {
    const Json& accessor = result.json()["accessors"][targets[k]["POSITION"].get<std::size_t>()];
    EXPECT_FALSE(accessor.contains("bufferView"));
    EXPECT_EQ(accessor["min"], Json({0, 0, 0}));
    EXPECT_EQ(accessor["max"], Json({0, 0, 0}));
    for (const float x : result.numbers(targets[k]["POSITION"])) EXPECT_EQ(x, 0);
  }
}

TEST(BakeTraps, dense_zeros_are_bytes_of_every_accessor) {
  const Baked result = baked(moving_hills(), {.dense_zeros = true});
  const std::size_t old = result.before->json["accessors"].size();
  for (std::size_t a = old; a < result.json()["accessors"].size(); ++a) {
    EXPECT_TRUE(result.json()["accessors"][a].contains("bufferView")) << a;
    EXPECT_FALSE(result.json()["accessors"][a].contains("sparse")) << a;
  }
}

TEST(BakeTraps, all_primitives_of_a_mesh_have_the_same_number_of_targets) {
  GltfBuilder builder;
  test::Hills hills(3);
  const std::vector<std::vector<float>> deltas = {hills.deltas(), hills.deltas()};
  const std::size_t mesh = builder.add_mesh(hills.primitive(builder, deltas));
  builder.add_primitive(mesh, hills.primitive(builder, deltas, false));  // shaded flat, since it has no normals
  Json points = hills.primitive(builder, deltas);
  points["mode"] = 0;
  points["targets"][1]["NORMAL"] = builder.add_positions(deltas[0]);
  builder.add_primitive(mesh, points);
  builder.add_node(mesh);
  builder.add_animation("");
  builder.add_track(0, 0, kTimes, std::vector<float>{0, 0, 1, 0.25F, 0, 1});
  const Baked result = baked(builder);
  const Json& primitives = result.mesh()["primitives"];
  EXPECT_EQ(result.report.meshes[0].left_flat, 1U);
  for (const Json& primitive : primitives) {
    ASSERT_EQ(primitive["targets"].size(), 5U);
    for (const Json& target : primitive["targets"]) EXPECT_TRUE(target.contains("POSITION"));
  }
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_TRUE(primitives[0]["targets"][k].contains("NORMAL"));
    EXPECT_FALSE(primitives[1]["targets"][k].contains("NORMAL")) << "a flat primitive has no base normals";
    EXPECT_TRUE(primitives[2]["targets"][k].contains("NORMAL")) << "as another target of it has";
  }
  EXPECT_EQ(primitives[2]["targets"][1]["NORMAL"], points["targets"][1]["NORMAL"]) << "points keep what they have";
  test::expect_exact(test::track_error(result));
}

TEST(BakeTraps, targets_that_lack_what_others_have_get_zeros) {
  GltfBuilder builder = moving_hills();
  Json& primitive = builder.json["meshes"][0]["primitives"][0];
  primitive["targets"].push_back({{"NORMAL", primitive["attributes"]["NORMAL"]}});  // a target that moves no vertex
  builder.json["animations"] = Json::array();
  builder.add_animation("");
  builder.add_track(0, 0, kTimes, std::vector<float>{0, 0, 0, 1, 0.25F, 0, 0, 1, 0});
  const Baked result = baked(builder);
  const Json& third = result.mesh()["primitives"][0]["targets"][2];
  for (const float x : result.numbers(third["NORMAL"])) EXPECT_EQ(x, 0) << "since the surface does not change";
  for (const float x : result.numbers(third["POSITION"])) EXPECT_EQ(x, 0);
}

TEST(BakeTraps, extra_targets_have_tangents_where_others_have) {
  GltfBuilder builder = moving_hills();
  Json& primitive = builder.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TANGENT"] = builder.add_accessor("VEC4", std::vector<float>(100, 0.5F));
  primitive["targets"][0]["TANGENT"] = primitive["targets"][0]["POSITION"];
  const Baked result = baked(builder);
  for (std::size_t k = 2; k < 5; ++k) {
    for (const float x : result.numbers(result.mesh()["primitives"][0]["targets"][k].at("TANGENT"))) EXPECT_EQ(x, 0);
  }
}

TEST(BakeTraps, default_weights_grow_by_their_products) {
  GltfBuilder builder = moving_hills();
  builder.json["meshes"][0]["weights"] = {0.5, 3};
  builder.json["nodes"][0]["weights"] = {0.25, 2};
  builder.add_node(0);
  const Baked result = baked(builder);
  EXPECT_EQ(result.mesh()["weights"], Json({0.5, 3, 0.25, 1.5, -6}));
  EXPECT_EQ(result.json()["nodes"][0]["weights"], Json({0.25, 2, 0.1875, 0.5, -2}));
  EXPECT_FALSE(result.json()["nodes"][1].contains("weights"));
  EXPECT_FALSE(baked(moving_hills()).mesh().contains("weights"));
}

TEST(BakeTraps, target_names_grow_where_there_are_some) {
  GltfBuilder builder = moving_hills();
  EXPECT_FALSE(baked(builder).mesh()["extras"].contains("targetNames"));
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"smile", "blink"}}, {"mine", nullptr}};
  const Baked result = baked(builder);
  EXPECT_EQ(result.mesh()["extras"]["targetNames"],
            Json({"smile", "blink", "chronormal w0*(1-w0)", "chronormal w0*w1", "chronormal w1*(1-w1)"}));
  EXPECT_TRUE(result.mesh()["extras"]["mine"].is_null());
  EXPECT_EQ(result.mesh()["extras"]["chronormal"]["extras"][1],
            R"({"target": 3, "linear": [], "quadratic": [[0, 1, 1.0]]})"_json);
}

TEST(BakeTraps, every_target_has_a_name_of_its_own) {
  GltfBuilder builder = moving_hills();
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"smile", "blink"}}};
  const Json names = baked(builder, {.encoding = BakeEncoding::kHarmless}).mesh()["extras"]["targetNames"];
  EXPECT_GT(names.size(), 2U);
  EXPECT_EQ(std::set<Json>(names.begin(), names.end()).size(), names.size()) << names;
}

TEST(BakeTraps, linear_tracks_become_splines_with_the_slopes_of_products) {
  const Baked result = baked(moving_hills());
  const Json& sampler = sampler_of(result);
  EXPECT_EQ(sampler["interpolation"], "CUBICSPLINE");
  EXPECT_EQ(sampler["input"], sampler_of(baked(moving_hills("STEP")))["input"]) << "no keys were added";
  EXPECT_EQ(result.report.converted_tracks, 1U);
  // The keys are at 0 s, 0.1F s and 1 s, with the weights (0, 0), (1, 0.25) and (0, 1). The expected slopes per second
  // follow from the times as float32.
  const double first = 0.1F, second = 1 - first, a = 1 / first, b = 0.25 / first, c = -1 / second, d = 0.75 / second;
  const std::vector<double> expected = {0,       0,    0,  0,
                                        0,  //
                                        0,       0,    0,  0,
                                        0,  //
                                        a,       b,    a,  0,
                                        b,  //
                                        a,       b,    -a, b + 0.25 * a,
                                        0.5 * b,  //
                                        1,       0.25, 0,  0.25,
                                        0.1875,  //
                                        c,       d,    -c, d + 0.25 * c,
                                        0.5 * d,  //
                                        c,       d,    c,  c,
                                        -d,  //
                                        0,       1,    0,  0,
                                        0,  //
                                        0,       0,    0,  0,
                                        0};
  const std::vector<float> values = result.numbers(sampler["output"]);
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t n = 0; n < values.size(); ++n) EXPECT_EQ(values[n], static_cast<float>(expected[n])) << n;
  test::expect_exact(test::track_error(result));
}

TEST(BakeTraps, linear_tracks_in_which_products_are_linear_stay) {
  GltfBuilder builder = moving_hills();
  builder.add_animation("one holds still");
  builder.add_track(1, 0, kTimes, std::vector<float>{0.5F, 0, 0.5F, 0, 0.5F, 0});
  const Baked result = baked(builder);
  const Json& sampler = sampler_of(result, 1);
  EXPECT_EQ(sampler["interpolation"], "LINEAR");
  EXPECT_EQ(result.numbers(sampler["output"]),
            (std::vector<float>{0.5F, 0, 0.25F, 0, 0, 0.5F, 0, 0.25F, 0, 0, 0.5F, 0, 0.25F, 0, 0}));
  EXPECT_EQ(result.report.converted_tracks, 1U);
  test::expect_exact(test::track_error(result, 1));
}

TEST(BakeTraps, steps_stay_steps_with_the_products_of_keys) {
  const Baked result = baked(moving_hills("STEP"));
  EXPECT_EQ(sampler_of(result)["interpolation"], "STEP");
  EXPECT_EQ(result.numbers(sampler_of(result)["output"]),
            (std::vector<float>{0, 0, 0, 0, 1, 0.25F, 0.25F, 0.1875F, 0, 1, 0, 0}));
  // Target 0 has only the weights 0 and 1, at which w0 (1 - w0) is zero. The bake therefore adds correction targets
  // only for w0 w1 and w1 (1 - w1).
  test::expect_exact(test::track_error(result));
}

TEST(BakeTraps, single_keys_stay) {
  GltfBuilder builder = test::hills_document(1);
  builder.add_track(0, 0, std::vector<float>{2}, std::vector<float>{0.5F});
  const Baked result = baked(builder);
  EXPECT_EQ(sampler_of(result)["interpolation"], "LINEAR");
  EXPECT_EQ(result.numbers(sampler_of(result)["output"]), (std::vector<float>{0.5F, 0.25F}));
}

TEST(BakeTraps, cubic_splines_get_keys_and_a_stated_error) {
  const Baked result = baked(moving_hills("CUBICSPLINE"));
  const Json& sampler = sampler_of(result);
  const std::vector<float> times = result.numbers(sampler["input"]);
  EXPECT_GT(times.size(), 2U);
  EXPECT_EQ(times.front(), 0);
  EXPECT_EQ(times.back(), 1);
  const Json& input = result.json()["accessors"][sampler["input"].get<std::size_t>()];
  EXPECT_EQ(input["min"], Json({0.0}));
  EXPECT_EQ(input["max"], Json({1.0}));
  EXPECT_GT(result.report.meshes[0].resampling_error, 0);
  EXPECT_LE(result.report.meshes[0].resampling_error, 0.001);
  const test::ShownError error = test::track_error(result);
  test::expect_exact(error);
  EXPECT_LE(error.worst, result.report.meshes[0].resampling_error + 1e-3) << "but for float32";
  // The bake must not change the weights of the author's targets.
  for (int i = 0; i <= 100; ++i) {
    const auto before = result.before->weights_at(0, 0, i / 100.0), after = result.after->weights_at(0, 0, i / 100.0);
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(before[k], after[k], 1e-6F);
  }
  const Baked coarse = baked(moving_hills("CUBICSPLINE"), {.tolerance = 0.5});
  EXPECT_LT(coarse.numbers(sampler_of(coarse)["input"]).size(), times.size());
  EXPECT_LE(test::track_error(coarse).worst, coarse.report.meshes[0].resampling_error + 1e-3);
}

TEST(BakeTraps, every_animation_is_extended) {
  GltfBuilder builder = moving_hills();
  for (int n = 0; n < 3; ++n) {
    builder.add_animation("more");
    builder.add_track(static_cast<std::size_t>(n) + 1, 0, kTimes, std::vector<float>{0, 0, 1, 1, 0.5F, 2});
  }
  const Baked result = baked(builder);
  for (std::size_t a = 0; a < 4; ++a) {
    EXPECT_EQ(result.after->weights_at(a, 0, 0.3).size(), 5U);
    test::expect_exact(test::track_error(result, a));
  }
}

TEST(BakeTraps, instances_get_what_any_of_their_tracks_needs) {
  GltfBuilder builder = test::hills_document(2);
  builder.add_node(0);
  builder.add_track(0, 0, kTimes, std::vector<float>{0, 0, 1, 0, 0, 0});             // target 0 moves alone
  builder.add_track(0, 1, kTimes, std::vector<float>{0, 0, 0, 1, 0, 0.5F}, "STEP");  // target 1 moves alone
  const Baked result = baked(builder);
  ASSERT_EQ(result.report.meshes[0].extras.size(), 2U) << "never both at once";
  EXPECT_EQ(result.report.meshes[0].undriven, 0U);
  EXPECT_EQ(result.report.converted_tracks, 1U);
  test::expect_exact(test::track_error(result, 0, 0));
  test::expect_exact(test::track_error(result, 0, 1));
}

TEST(BakeTraps, instances_that_stand_still_are_exact_too) {
  for (const bool of_node : {true, false}) {
    GltfBuilder builder = test::hills_document(2);
    builder.add_track(0, 0, kTimes, std::vector<float>{0, 0, 1, 0, 0, 0});  // target 0 moves alone
    builder.add_node(0);
    (of_node ? builder.json["nodes"][1] : builder.json["meshes"][0])["weights"] = {0.5, 0.75};
    const Baked result = baked(builder);
    ASSERT_EQ(result.report.meshes[0].extras.size(), 3U);
    const Json& weights = (of_node ? result.json()["nodes"][1] : result.mesh())["weights"];
    const test::Pose pose = {{0.5, 0.75}, weights.get<std::vector<float>>()};
    test::expect_exact(test::shown_error(test::GltfTruth(*result.before, 0), *result.after, 0, {pose}));
  }
}

TEST(BakeTraps, a_sampler_that_only_this_mesh_uses_is_changed_in_place) {
  GltfBuilder builder = moving_hills();
  builder.add_node(0);
  builder.json["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"node", 1}, {"path", "weights"}}}});
  const Baked result = baked(builder);
  EXPECT_EQ(result.json()["animations"][0]["samplers"].size(), 1U);
  test::expect_exact(test::track_error(result, 0, 0));
  test::expect_exact(test::track_error(result, 0, 1));
}

TEST(BakeTraps, a_sampler_that_other_meshes_use_is_left_to_them) {
  GltfBuilder builder = moving_hills();
  test::Hills other(9);
  const std::vector<float> still(other.positions.size());
  builder.add_node(builder.add_mesh(other.primitive(builder, {still, still})));  // node 1 does not move
  // Node 2 needs fewer correction targets than node 0 does.
  builder.add_node(builder.add_mesh(other.primitive(builder, {other.deltas(), still})));
  for (const int node : {1, 2})
    builder.json["animations"][0]["channels"].push_back(
        {{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}});
  const Baked result = baked(builder);
  const Json& animation = result.json()["animations"][0];
  EXPECT_EQ(animation["samplers"].size(), 3U);
  EXPECT_EQ(animation["samplers"][0], result.before->json["animations"][0]["samplers"][0]);
  EXPECT_EQ(result.after->weights_at(0, 0, 0.3).size(), 5U);
  EXPECT_EQ(result.after->weights_at(0, 1, 0.3).size(), 2U);
  EXPECT_EQ(result.after->weights_at(0, 2, 0.3).size(), 3U);
  test::expect_exact(test::track_error(result, 0, 0));
  test::expect_exact(test::track_error(result, 0, 2));
}

TEST(BakeTraps, of_meshes_that_share_a_sampler_each_gets_its_own) {
  GltfBuilder builder = test::hills_document(1);
  builder.add_track(0, 0, kTimes, std::vector<float>{0, 1, 0});
  test::Hills other(9);
  // The target only scales the mesh, so normals keep their directions and need no correction target.
  builder.add_node(builder.add_mesh(other.primitive(builder, {other.positions})));
  builder.add_node(builder.add_mesh(other.primitive(builder, {other.deltas()})));
  for (const int node : {1, 2})
    builder.json["animations"][0]["channels"].push_back(
        {{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}});
  const Baked result = baked(builder);
  EXPECT_EQ(result.json()["animations"][0]["samplers"].size(), 3U);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    EXPECT_EQ(result.after->weights_at(0, channel, 0.3).size(), channel == 1 ? 1U : 2U);
    test::expect_exact(test::track_error(result, 0, channel));
  }
  GltfBuilder two = test::hills_document(1);
  two.add_track(0, 0, kTimes, std::vector<float>{0, 1, 0});
  two.add_node(two.add_mesh(other.primitive(two, {other.deltas(), other.deltas()})));
  two.json["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"node", 1}, {"path", "weights"}}}});
  EXPECT_FALSE(test::bake_document(two).ok()) << "a track has weights for all targets";
  two.json["meshes"][1] = Json::object();
  two.json["meshes"][1]["primitives"] = Json::array({other.primitive(two, {other.deltas()})});
  const Baked shared = baked(two);
  EXPECT_EQ(shared.json()["animations"][0]["samplers"].size(), 2U);
  test::expect_exact(test::track_error(shared, 0, 0));
  test::expect_exact(test::track_error(shared, 0, 1));
}

TEST(BakeTraps, weights_of_normalised_integers_become_floats) {
  GltfBuilder builder = test::hills_document(1);
  builder.add_track(0, 0, kTimes, std::vector<std::uint8_t>{0, 255, 51});
  const Baked result = baked(builder);
  const Json& output = result.json()["accessors"][sampler_of(result)["output"].get<std::size_t>()];
  EXPECT_EQ(output["componentType"], 5126);
  EXPECT_FALSE(output.value("normalized", false));
  test::expect_exact(test::track_error(result));
}

// A triangle falls over to one side. The base normals point to the back of the triangle, as in files with double-sided
// materials.
TEST(BakeTraps, normals_of_the_inner_side_stay_on_that_side) {
  for (const float tilt : {0.0F, 1e-3F}) {
    GltfBuilder builder;
    const std::size_t base = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::size_t fall = builder.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 1});
    Json primitive =
        GltfBuilder::primitive(base, builder.add_indices(std::vector<std::uint8_t>{0, 1, 2}), {{{"POSITION", fall}}});
    primitive["attributes"]["NORMAL"] = builder.add_positions({tilt, 0, -1, tilt, 0, -1, tilt, 0, -1});
    builder.add_node(builder.add_mesh(primitive));
    builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
    const Baked result = baked(builder);
    const std::vector<float> delta = result.numbers(result.mesh()["primitives"][0]["targets"][0]["NORMAL"]);
    // n(1) = (0, -1, 1), so the normal on the back is (0, 1, -1).
    EXPECT_NEAR(delta[0], 0, 2e-3) << tilt;
    EXPECT_NEAR(delta[1], 1, 2e-3) << tilt;
    EXPECT_NEAR(delta[2], 0, 2e-3) << tilt;
  }
}

TEST(BakeTraps, a_sampler_that_also_drives_something_else_stays_as_it_is) {
  GltfBuilder builder = test::hills_document(1);
  builder.add_track(0, 0, kTimes, std::vector<float>{0, 1, 0.25F});
  builder.json["extensionsUsed"] = {"KHR_animation_pointer"};
  builder.json["materials"] = {Json::object()};
  builder.json["animations"][0]["channels"].push_back(
      {{"sampler", 0},
       {"target",
        {{"path", "pointer"},
         {"extensions", {{"KHR_animation_pointer", {{"pointer", "/materials/0/alphaCutoff"}}}}}}}});
  const Baked result = baked(builder);
  EXPECT_EQ(sampler_of(result, 0, 1), builder.json["animations"][0]["samplers"][0]);
  EXPECT_EQ(sampler_of(result)["interpolation"], "CUBICSPLINE");
  test::expect_exact(test::track_error(result));
}

TEST(BakeTraps, weights_whose_products_no_float_can_hold_get_no_extra_targets) {
  GltfBuilder builder = test::hills_document(2);
  builder.json["meshes"][0]["weights"] = {1e30, 1e30};
  const Baked poses = test::bake_document(builder, {.encoding = BakeEncoding::kExact});
  if (poses.ok()) {
    EXPECT_TRUE(poses.report.changed);
    for (const Json& weight : poses.mesh()["weights"]) EXPECT_TRUE(weight.is_number());
  }
  GltfBuilder animated = test::hills_document(1);
  animated.add_track(0, 0, kTimes, std::vector<float>{0, 3e38F, 0});
  EXPECT_GE(test::bake_document(animated, {.encoding = BakeEncoding::kExact}).report.meshes[0].resampling_error, 180);
  const Baked harmless = test::bake_document(animated);
  ASSERT_EQ(harmless.error, "");
  EXPECT_EQ(harmless.report.added_targets, 0U);
}

TEST(BakeTraps, more_than_eight_morphed_attributes_are_a_warning) {
  const auto warns = [](const Baked& result) {
    for (const std::string& warning : result.report.warnings) {
      if (warning.find("morph targets are in the result") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(warns(baked(moving_hills())));  // 10 attributes: the positions and normals of 5 targets
  GltfBuilder one = test::hills_document(1);
  one.add_track(0, 0, kTimes, std::vector<float>{0, 1, 0});
  EXPECT_FALSE(warns(baked(one)));
}

TEST(BakeTraps, primitives_that_draco_compresses_get_the_same_deltas) {
  test::Hills hills(12);
  const std::vector<float> deltas = hills.deltas();
  const auto animate = [](GltfBuilder& builder, Json primitive) {
    builder.add_node(builder.add_mesh(std::move(primitive)));
    builder.add_animation("");
    builder.add_track(0, 0, kTimes, std::vector<float>{0, 1, 0});
  };
  GltfBuilder plain, compressed;
  animate(plain, hills.primitive(plain, {deltas}));
  const std::string coded = test::draco_mesh(hills.positions, {hills.corners.begin(), hills.corners.end()},
                                             test::DracoOrder::kKept, hills.normals);
  animate(compressed, test::draco_primitive(compressed, coded, hills.vertices(), hills.corners.size(), true,
                                            {{{"POSITION", compressed.add_positions(deltas)}}}));
  const Baked expected = baked(plain), result = baked(compressed);
  const Json& primitive = result.mesh()["primitives"][0];
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(result.numbers(primitive["targets"][k]["NORMAL"]),
              expected.numbers(expected.mesh()["primitives"][0]["targets"][k]["NORMAL"]));
  }
  EXPECT_EQ(primitive["extensions"], compressed.json["meshes"][0]["primitives"][0]["extensions"]);
  EXPECT_NE(test::bake_document(compressed, {.recompute_base = true}).error.find("Draco"), std::string::npos);
}

TEST(BakeTraps, nothing_but_the_listed_pointers_changes) {
  const Baked result = baked(moving_hills());
  EXPECT_GT(result.report.left_out_bytes, 0U) << "the weights that the track had before";
  EXPECT_EQ(result.after->bin().size(),
            result.before->bin().size() - result.report.left_out_bytes + result.report.added_bytes);
  const auto& pointers = result.report.pointers;
  EXPECT_TRUE(std::is_sorted(pointers.begin(), pointers.end()));
  Json patched = result.after->json;
  for (const std::string& pointer : pointers) {
    const Json::json_pointer at(pointer);
    if (result.before->json.contains(at)) patched[at] = result.before->json[at];
  }
  for (auto& [key, value] : result.before->json["meshes"][0]["primitives"][0]["attributes"].items())
    EXPECT_EQ(result.mesh()["primitives"][0]["attributes"][key], value);
  for (const Json& accessor : result.before->json["meshes"][0]["primitives"][0]["attributes"])
    EXPECT_EQ(result.numbers(accessor), result.before->accessor(accessor.get<std::size_t>()));
  // New entries of the following lists must come after the existing entries.
  for (const Json::json_pointer& list : {Json::json_pointer("/accessors"), Json::json_pointer("/bufferViews"),
                                         Json::json_pointer("/meshes/0/primitives/0/targets")}) {
    Json& items = patched[list];
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(result.before->json[list].size()), items.end());
  }
  patched["meshes"][0].erase("extras");
  patched["nodes"][0].erase("extras");
  for (Json& target : patched["meshes"][0]["primitives"][0]["targets"]) target.erase("NORMAL");
  EXPECT_EQ(patched, result.before->json);
}

// Changes the first channel so that it drives the value at a JSON pointer, by the extension KHR_animation_pointer.
GltfBuilder driven_by_pointer(const std::string& pointer, GltfBuilder builder = moving_hills()) {
  builder.json["extensionsUsed"] = {"KHR_animation_pointer"};
  builder.json["animations"][0]["channels"][0]["target"] = {
      {"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
  return builder;
}

TEST(BakeTraps, weights_that_a_pointer_drives_are_baked_as_those_of_a_channel) {
  const Baked by_channel = baked(moving_hills());
  ASSERT_GT(by_channel.report.added_targets, 0U);
  for (const char* const pointer : {"/nodes/0/weights", "/meshes/0/weights"}) {
    const Baked by_pointer = baked(driven_by_pointer(pointer));
    ASSERT_EQ(by_pointer.error, "") << pointer;
    EXPECT_EQ(by_pointer.report.added_targets, by_channel.report.added_targets) << pointer;
    EXPECT_EQ(by_pointer.mesh(), by_channel.mesh()) << pointer;
    EXPECT_EQ(by_pointer.json()["animations"][0]["samplers"], by_channel.json()["animations"][0]["samplers"])
        << pointer;
    EXPECT_EQ(by_pointer.after->bin(), by_channel.after->bin()) << pointer;
  }
}

TEST(BakeTraps, a_pointer_to_the_weights_of_a_mesh_drives_every_node_without_weights_of_its_own) {
  GltfBuilder builder = driven_by_pointer("/meshes/0/weights");
  builder.add_node(0);
  builder.json["nodes"][builder.add_node(0)]["weights"] = std::vector<double>(2, 0.5);
  const test::GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  std::vector<std::size_t> nodes;
  for (const GltfTrack& track : (*file).animations()[0].tracks) nodes.push_back(track.node);
  EXPECT_EQ(nodes, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(baked(builder).error, "");
}

TEST(BakeTraps, a_pointer_to_what_is_not_there_and_a_second_one_to_the_same_weights_are_refused) {
  EXPECT_NE(test::bake_document(driven_by_pointer("/meshes/7/weights")).error.find("/meshes/7/weights"),
            std::string::npos);
  GltfBuilder builder = driven_by_pointer("/nodes/0/weights");
  builder.json["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}});
  EXPECT_NE(test::bake_document(builder).error.find("another channel"), std::string::npos);
}

TEST(BakeTraps, a_pointer_to_one_weight_keeps_only_its_own_mesh_from_extra_targets) {
  const auto with_single = [](const std::string& pointer) {
    GltfBuilder builder = test::hills_document(2);
    builder.json["extensionsUsed"] = {"KHR_animation_pointer"};
    builder.add_mesh(builder.json["meshes"][0]["primitives"][0]);
    const bool drives_weights = pointer.starts_with("/meshes/0/weights/") || pointer.starts_with("/nodes/0/weights/");
    if (!drives_weights) builder.add_track(0, 0, kTimes, std::vector<float>{0, 0, 1, 0.25F, 0, 1});
    builder.add_track(0, 0, kTimes, std::vector<float>{0, 0.25F, 1});
    builder.json["animations"][0]["channels"].back()["target"] = {
        {"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
    return builder;
  };
  for (const char* const pointer : {"/meshes/0/weights/1", "/nodes/0/weights/1"}) {
    const BakeOptions exact = {.encoding = BakeEncoding::kExact};
    EXPECT_NE(test::bake_document(with_single(pointer), exact).error.find("drives a single weight"), std::string::npos);
    const BakeOptions harmless = {.encoding = BakeEncoding::kHarmless};
    const Baked without = test::bake_document(with_single(pointer), harmless);
    ASSERT_EQ(without.error, "") << pointer;
    EXPECT_EQ(without.report.added_targets, 0U);
    EXPECT_TRUE(without.report.changed);
    EXPECT_TRUE(std::any_of(without.report.warnings.begin(), without.report.warnings.end(), [](const auto& warning) {
      return warning.find("drives a single weight") != std::string::npos;
    }));
    const Baked other = test::bake_document(with_single("/cameras/0/weights/1"), harmless);
    EXPECT_GT(other.report.added_targets, 0U);
  }
  for (const char* const pointer : {"/meshes/0/extras/weights", "/materials/0/weights", "/cameras/0/weights/1"})
    EXPECT_EQ(baked(with_single(pointer)).error, "") << pointer;
}

TEST(BakeTraps, tracks_that_break_a_rule_get_zeros_for_correction_targets) {
  using Floats = std::vector<float>;
  struct Case {
    const char* interpolation;
    Floats times, weights;
    bool shares = false;  // true if the channel takes the sampler of the good animation
  };
  const std::vector<Case> cases = {{"CUBICSPLINE", {0}, {0, 0, 0.5F, 0.25F, 0, 0}},
                                   {"LINEAR", {1, 0}, {0.5F, 1, 0.25F, 0}},
                                   {"STEP", {0, 1, 2}, {0.5F, 1, 0.25F, 0}},
                                   {"LINEAR", kTimes, {0, 0, 1, 0.25F, 0, 1}, true}};
  for (const Case& bad : cases) {
    GltfBuilder builder = moving_hills();
    const std::size_t animation = bad.shares ? 0 : builder.add_animation("bad");
    if (bad.shares)
      builder.json["animations"][0]["channels"].push_back(Json(builder.json["animations"][0]["channels"][0]));
    else
      builder.add_track(animation, 0, bad.times, bad.weights, bad.interpolation);
    const Baked result = test::bake_bytes(builder.glb(), {.encoding = BakeEncoding::kExact}, {});
    ASSERT_EQ(result.error, "") << bad.interpolation;
    const std::size_t targets = result.mesh()["primitives"][0]["targets"].size();
    ASSERT_GT(targets, 2U);
    const Floats wide = result.numbers(sampler_of(result, animation, bad.shares ? 1 : 0)["output"]);
    ASSERT_EQ(wide.size() * 2, bad.weights.size() * targets) << bad.interpolation;
    for (std::size_t i = 0; i < wide.size(); ++i)
      EXPECT_EQ(wide[i], i % targets < 2 ? bad.weights[i / targets * 2 + i % targets] : 0) << bad.interpolation;
    // The good track is the same as without the bad one.
    const Baked good = baked(moving_hills());
    EXPECT_EQ(result.numbers(sampler_of(result)["output"]), good.numbers(sampler_of(good)["output"]));
  }
}

TEST(BakeTraps, a_track_that_cannot_be_extended_keeps_its_mesh_from_correction_targets) {
  for (const std::vector<float>& weights : {std::vector<float>{0, 1, 0.5F}, {0, std::nanf(""), 1, 0.5F}}) {
    GltfBuilder builder = moving_hills();
    builder.add_track(builder.add_animation("bad"), 0, std::vector<float>{0, 1}, weights);
    const Baked exact = test::bake_bytes(builder.glb(), {.encoding = BakeEncoding::kExact}, {});
    EXPECT_NE(exact.error.find("/animations/1/channels/0"), std::string::npos) << exact.error;
    const Baked result = test::bake_bytes(builder.glb(), {.encoding = BakeEncoding::kHarmless}, {});
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.report.added_targets, 0U);
    EXPECT_TRUE(result.report.changed);
    EXPECT_TRUE(std::any_of(result.report.warnings.begin(), result.report.warnings.end(), [](const auto& warning) {
      return warning.find("numbers that cannot be read") != std::string::npos;
    }));
  }
}

TEST(BakeTraps, expressions_of_avatars_are_poses_that_a_bake_judges) {
  // In the animation, only one target is active at a time, with weight 0 or 1. Only the expression therefore needs
  // correction targets.
  for (const bool is_first_version : {true, false}) {
    GltfBuilder builder = test::hills_document(2);
    builder.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{1, 0, 0, 0, 0, 1}, "STEP");
    const std::size_t without = test::bake_document(builder, {.encoding = BakeEncoding::kExact}).report.added_targets;
    const auto bind = [&](int target) {
      return is_first_version ? Json{{"mesh", 0}, {"index", target}, {"weight", 50}}
                              : Json{{"node", 0}, {"index", target}, {"weight", 0.5}};
    };
    const Json binds = {bind(0), bind(1), Json{{"mesh", 9}, {"node", 9}, {"index", 0}, {"weight", 1}}, Json("?")};
    if (is_first_version)
      builder.json["extensions"]["VRM"]["blendShapeMaster"]["blendShapeGroups"] = {{{"name", "Joy"}, {"binds", binds}}};
    else
      builder.json["extensions"]["VRMC_vrm"]["expressions"]["preset"]["happy"] = {{"morphTargetBinds", binds}};
    const Baked with = test::bake_document(builder, {.encoding = BakeEncoding::kExact});
    ASSERT_EQ(with.error, "");
    EXPECT_EQ(without, 0U);
    EXPECT_EQ(with.report.added_targets, 3U) << "the pair, and what each has too much at a half";
    EXPECT_EQ((**with.source).meshes()[0].expressions,
              (std::vector<GltfExpression>{{is_first_version ? "Joy" : "happy", {0.5, 0.5}}}));
    EXPECT_EQ(with.json()["extensions"], builder.json["extensions"]);
  }
}

// Makes hills with a track that drives every target, and with an expression of an avatar that sets three targets.
GltfBuilder avatar_of_hills(unsigned seed, double strength) {
  constexpr std::size_t kTargets = 7;
  GltfBuilder builder = test::with_misleading_normals(test::hills_document(kTargets, seed));
  test::Hills random(seed + 100);
  const std::vector<float> times = {0, 0.5, 1, 2, 2.5, 3};
  std::vector<float> weights;
  for (std::size_t n = 0; n < kTargets * times.size(); ++n) weights.push_back(random.uniform(0, 0.4));
  builder.add_track(0, 0, times, weights);
  Json binds;
  for (const int target : {0, 1, 2}) binds.push_back({{"node", 0}, {"index", target}, {"weight", strength}});
  builder.json["extensions"]["VRMC_vrm"]["expressions"]["preset"]["happy"] = {{"morphTargetBinds", binds}};
  return builder;
}

// Returns the worst error of the expressions or of the tracks of a file, in degrees.
double worst_of(const GltfDocument& document, AuditSubject::Kind kind) {
  const Result<Audit> audited = audit(document, {.viewers = {}});
  EXPECT_TRUE(audited.ok());
  double worst = 0;
  for (const AuditSubject& subject : audited.value().subjects)
    if (subject.kind == kind) worst = std::max(worst, subject.error.worst);
  return worst;
}

TEST(BakeTraps, what_a_bake_says_of_expressions_is_what_an_audit_finds_in_the_file) {
  std::set<std::string_view> forms;
  std::size_t compared = 0;
  for (const double tolerance : {0.5, 3.0}) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
      BakeOptions options = {.tolerance = tolerance};
      options.viewers = find_viewers("three").value();
      const Baked baked = test::bake_document(avatar_of_hills(seed, 0.1 * seed), options);
      ASSERT_EQ(baked.error, "");
      const test::GltfFixture after(baked.bytes);
      ASSERT_TRUE(after.ok()) << after.error();
      for (const BakedCandidate& choice : baked.report.meshes[0].candidates) {
        if (!choice.chosen) continue;
        forms.insert(choice.name);
        const double expression = worst_of(*after, AuditSubject::Kind::kExpression),
                     track = worst_of(*after, AuditSubject::Kind::kTrack);
        // Audit and bake take samples of a track at different instants, but judge the expression in the same pose.
        EXPECT_GE(choice.played.worst, expression - 1e-3) << choice.name;
        if (expression > 1.2 * track) {
          EXPECT_NEAR(choice.played.worst, expression, 1e-3) << choice.name;
          ++compared;
        }
      }
    }
  }
  EXPECT_GT(compared, 0U);
  EXPECT_TRUE(forms.contains("low rank")) << "its curves give extra targets no weight in an expression";
}

}  // namespace
}  // namespace chronormal::bake_trap_test
