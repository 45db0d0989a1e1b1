// Tests how the reader turns targets and animations of glTF files into motions.
#include "io/gltf/gltf_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_weights.h"

namespace chronormal::gltf_motion_test {
namespace {

using test::GltfBuilder, test::GltfFixture, test::positions_at;

GltfMotion motion_of(const GltfBuilder& builder, const std::string& animation = "") {
  const GltfFixture file(builder);
  EXPECT_TRUE(file.ok()) << file.error();
  if (!file.ok()) return {};
  GltfMotionOptions options;
  options.animation = animation;
  Result<GltfMotion> motion = read_gltf_motion(*file, options);
  EXPECT_TRUE(motion.ok()) << motion.error().text();
  if (!motion) return {};
  EXPECT_TRUE(validate(motion.value().motion).ok());
  return std::move(motion).value();
}

Error error_of(const GltfBuilder& builder, const GltfMotionOptions& options = {}) {
  const GltfFixture file(builder);
  EXPECT_TRUE(file.ok()) << file.error();
  if (!file.ok()) return {};
  const Result<GltfMotion> motion = read_gltf_motion(*file, options);
  EXPECT_FALSE(motion.ok());
  return motion.ok() ? Error{} : motion.error();
}

std::vector<float> plus(std::vector<float> base, const std::vector<float>& deltas) {
  std::transform(base.begin(), base.end(), deltas.begin(), base.begin(), [](float a, float b) { return a + b; });
  return base;
}

std::vector<float> joined(std::vector<float> first, const std::vector<float>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::vector<std::uint32_t> corners_of(const Motion& motion) {
  return {motion.topology.corners().begin(), motion.topology.corners().end()};
}

TEST(GltfTargets, are_keyframes_of_segments_from_the_base) {
  const GltfMotion result = motion_of(test::quad_document());
  const Motion& motion = result.motion;
  ASSERT_EQ(motion.keyframes.size(), 3U);
  EXPECT_EQ(motion.keyframes[0].positions, test::kQuad);
  EXPECT_EQ(motion.keyframes[1].positions, plus(test::kQuad, test::kLift));
  EXPECT_EQ(motion.keyframes[2].positions, plus(test::kQuad, test::kShift));
  ASSERT_EQ(motion.segments.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(motion.segments[k].from, 0U);
    EXPECT_EQ(motion.segments[k].to, k + 1);
  }
  EXPECT_EQ(corners_of(motion), (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(result.curve_error, 0);
  ASSERT_EQ(result.parts.size(), 1U);
  const GltfPart& part = result.parts[0];
  EXPECT_FALSE(part.node.has_value());
  EXPECT_EQ(part.mesh, 0U);
  EXPECT_EQ(part.primitive, 0U);
  EXPECT_EQ(part.first_vertex, 0U);
  EXPECT_EQ(part.vertex_count, 4U);
  EXPECT_EQ(part.first_face, 0U);
  EXPECT_EQ(part.face_count, 2U);
}

TEST(GltfTargets, default_weights_do_not_move_the_base) {
  GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["weights"] = {1, 1};
  builder.json["nodes"][0]["weights"] = {0.5, 1};
  EXPECT_EQ(motion_of(builder).motion.keyframes[0].positions, test::kQuad);
}

TEST(GltfTargets, sums_are_rounded_once_to_the_nearest_float) {
  GltfBuilder builder;
  const std::vector<float> base = {0.1F, 0.2F, 0.3F, 1e8F, 0, 0, 0, 1.0F / 3, 0},
                           target = {0.7F, 1e-9F, -0.3F, 3.0F, 0, 0, 0, 0.1F, 1};
  const std::size_t position = builder.add_positions(base);
  builder.add_mesh(GltfBuilder::primitive(position, std::nullopt, {{{"POSITION", builder.add_positions(target)}}}));
  const GltfMotion result = motion_of(builder);
  for (std::size_t i = 0; i < 9; ++i) {
    const long double sum = static_cast<long double>(base[i]) + static_cast<long double>(target[i]);
    EXPECT_EQ(result.motion.keyframes[1].positions[i], static_cast<float>(sum)) << i;
  }
}

// Data of several_meshes(), which makes a document with three meshes, two of which morph, and with nodes in another
// order than the meshes:
//   mesh 0: primitive 0 is a triangle, primitive 1 the quad, primitive 2 points; one target
//   mesh 1: no targets
//   mesh 2: a triangle; two targets, of which the first has normals only
const std::vector<float> kFirst = {0, 0, 0, 1, 0, 0, 0, 1, 0}, kFirstMove = {0, 0, 1, 0, 0, 1, 0, 0, 1};
const std::vector<float> kLast = {5, 0, 0, 6, 0, 0, 5, 1, 0}, kLastMove = {1, 0, 0, 0, 1, 0, 0, 0, 1};

GltfBuilder several_meshes() {
  GltfBuilder builder;
  const std::size_t first = builder.add_positions(kFirst), first_move = builder.add_positions(kFirstMove);
  const std::size_t quad = builder.add_positions(test::kQuad), lift = builder.add_positions(test::kLift);
  const std::size_t last = builder.add_positions(kLast), last_move = builder.add_positions(kLastMove);
  const std::size_t mesh = builder.add_mesh(GltfBuilder::primitive(first, std::nullopt, {{{"POSITION", first_move}}}));
  builder.add_primitive(mesh,
                        GltfBuilder::primitive(quad, builder.add_indices(test::kQuadCorners), {{{"POSITION", lift}}}));
  builder.add_primitive(mesh, GltfBuilder::primitive(first, std::nullopt, {{{"POSITION", first_move}}}, 0));
  builder.add_mesh(GltfBuilder::primitive(first));
  auto primitive = GltfBuilder::primitive(last, std::nullopt, {{{"NORMAL", first_move}}, {{"POSITION", last_move}}});
  primitive["attributes"]["NORMAL"] = builder.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  builder.add_mesh(primitive);
  builder.add_node(2);
  builder.add_node(1);
  builder.add_node(0);
  builder.add_node(2);
  return builder;
}

TEST(GltfTargets, parts_follow_meshes_and_primitives_and_only_those_that_morph) {
  const GltfMotion result = motion_of(several_meshes());
  const Motion& motion = result.motion;
  ASSERT_EQ(result.parts.size(), 3U);
  const std::size_t expected[3][6] = {{0, 0, 0, 3, 0, 1}, {0, 1, 3, 4, 1, 2}, {2, 0, 7, 3, 3, 1}};
  for (std::size_t p = 0; p < 3; ++p) {
    const GltfPart& part = result.parts[p];
    EXPECT_FALSE(part.node.has_value());
    EXPECT_EQ((std::vector{part.mesh, part.primitive, part.first_vertex, part.vertex_count, part.first_face,
                           part.face_count}),
              std::vector(expected[p], expected[p] + 6));
  }
  EXPECT_EQ(corners_of(motion), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 3, 5, 6, 7, 8, 9}));
  ASSERT_EQ(motion.keyframes.size(), 3U);
  EXPECT_EQ(motion.keyframes[0].positions, joined(joined(kFirst, test::kQuad), kLast));
  EXPECT_EQ(motion.keyframes[1].positions,
            joined(joined(plus(kFirst, kFirstMove), plus(test::kQuad, test::kLift)), kLast));
  EXPECT_EQ(motion.keyframes[2].positions, joined(joined(kFirst, test::kQuad), plus(kLast, kLastMove)));
}

TEST(GltfTargets, file_without_targets_is_an_error) {
  GltfBuilder builder;
  builder.add_mesh(GltfBuilder::primitive(builder.add_positions(kFirst)));
  const Error error = error_of(builder);
  EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
  EXPECT_TRUE(error.place.starts_with("a.gltf")) << error.text();
}

TEST(GltfMesh, is_at_its_default_weights) {
  GltfBuilder builder = several_meshes();
  builder.json["meshes"][0]["weights"] = {0.5};
  builder.json["meshes"][2]["weights"] = {1, 2};
  builder.json["nodes"][0]["weights"] = {7, 7};
  const GltfFixture file(builder);
  const Result<GltfMotion> mesh = read_gltf_mesh(*file);
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  const Motion& motion = mesh.value().motion;
  ASSERT_EQ(motion.keyframes.size(), 1U);
  EXPECT_TRUE(motion.segments.empty());
  const auto half = [](std::vector<float> values) {
    for (float& value : values) value *= 0.5F;
    return values;
  };
  EXPECT_EQ(motion.keyframes[0].positions,
            joined(joined(joined(plus(kFirst, half(kFirstMove)), plus(test::kQuad, half(test::kLift))), kFirst),
                   plus(plus(kLast, kLastMove), kLastMove)));
  ASSERT_EQ(mesh.value().parts.size(), 4U);
  EXPECT_EQ(mesh.value().parts[2].mesh, 1U);
  EXPECT_EQ(mesh.value().parts[2].first_vertex, 7U);
  EXPECT_EQ(mesh.value().parts[3].first_face, 4U);
  EXPECT_EQ(motion.topology.face_count(), 5U);
}

TEST(GltfMesh, file_without_faces_is_an_error) {
  GltfBuilder builder;
  builder.add_mesh(GltfBuilder::primitive(builder.add_positions(kFirst), std::nullopt, {}, 0));
  EXPECT_FALSE(read_gltf_mesh(*GltfFixture(builder)).ok());
  EXPECT_FALSE(read_gltf_mesh(*GltfFixture(std::string(R"({"asset": {"version": "2.0"}})"))).ok());
}

TEST(GltfLinear, keyframes_stand_at_keys) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("walk"), 0, {0.5F, 1, 3}, {0, 0, 1, 0.5F, 0.25F, -1});
  for (const char* const name : {"walk", "0"}) {
    const GltfMotion result = motion_of(builder, name);
    const Motion& motion = result.motion;
    ASSERT_EQ(motion.keyframes.size(), 3U);
    ASSERT_EQ(motion.segments.size(), 2U);
    const std::vector<double> times = {0.5, 1, 3};
    const std::vector<std::vector<double>> weights = {{0, 0}, {1, 0.5}, {0.25, -1}};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(motion.keyframes[k].time, times[k]);
      const std::vector<double> expected = test::morphed(test::kQuad, {test::kLift, test::kShift}, weights[k]);
      for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_EQ(static_cast<double>(motion.keyframes[k].positions[i]), expected[i]);
    }
    EXPECT_EQ(motion.segments[0].from, 0U);
    EXPECT_EQ(motion.segments[0].to, 1U);
    EXPECT_EQ(motion.segments[1].from, 1U);
    EXPECT_EQ(motion.segments[1].to, 2U);
    EXPECT_EQ(result.curve_error, 0);
    ASSERT_EQ(result.parts.size(), 1U);
    EXPECT_EQ(result.parts[0].node, 0U);
  }
}

TEST(GltfLinear, normalised_integers_are_weights) {
  const auto check = [](auto zero, const std::vector<double>& expected, auto... values) {
    using T = decltype(zero);
    GltfBuilder builder = test::quad_document();
    builder.add_track<T>(builder.add_animation(""), 0, {0, 1}, {static_cast<T>(values)...});
    const GltfFixture file(builder);
    ASSERT_TRUE(file.ok()) << file.error();
    const Result<GltfKeys> keys = file->keys(0, 0);
    ASSERT_TRUE(keys.ok()) << keys.error().text();
    EXPECT_EQ(keys.value().times, (std::vector{0.0, 1.0}));
    ASSERT_EQ(keys.value().values.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(keys.value().values[i], expected[i], 3e-8) << i;
    EXPECT_TRUE(motion_of(builder, "0").motion.keyframes.size() == 2);
  };
  check(std::int8_t{}, {0, 1, -1, -1}, 0, 127, -128, -127);
  check(std::uint8_t{}, {0, 1, 0.2, 1 / 255.0}, 0, 255, 51, 1);
  check(std::int16_t{}, {0, 1, -1, 1 / 32767.0}, 0, 32767, -32768, 1);
  check(std::uint16_t{}, {0, 1, 1 / 65535.0, 0.2}, 0, 65535, 1, 13107);
}

// The weight track of one node: the key times in seconds, and the weights of all targets at each key.
struct Track {
  std::size_t node;
  GltfInterpolation interpolation;
  std::vector<float> times, values;
};

// Returns the true positions of the vertices of a part at a time. Evaluates the weights by the formulas of the
// specification, in code that shares nothing with the reader.
std::vector<double> true_positions(const Track& track, const std::vector<float>& base,
                                   const std::vector<std::vector<float>>& targets, double time) {
  return test::morphed(base, targets,
                       test::weights_at(track.interpolation, track.times, track.values, targets.size(), time));
}

GltfBuilder two_nodes(const std::vector<Track>& tracks) {
  GltfBuilder builder = several_meshes();
  const std::size_t animation = builder.add_animation("two");
  for (const Track& track : tracks)
    builder.add_track<float>(animation, track.node, track.times, track.values,
                             track.interpolation == GltfInterpolation::kStep ? "STEP" : "LINEAR");
  return builder;
}

TEST(GltfLinear, nodes_with_different_keys_are_exact_at_every_time) {
  const std::vector<Track> tracks = {{3, GltfInterpolation::kLinear, {0, 1, 4}, {0, 0, 1, 2, -1, 0.5F}},
                                     {2, GltfInterpolation::kLinear, {0.25F, 1, 2, 5}, {0, 1, 0.5F, 3}}};
  const GltfMotion result = motion_of(two_nodes(tracks), "two");
  // The parts are in the order of the nodes: first node 2 (mesh 0, with the triangle and the quad), then node 3 (mesh
  // 2).
  ASSERT_EQ(result.parts.size(), 3U);
  ASSERT_EQ(result.parts[0].node, 2U);
  EXPECT_EQ(result.parts[1].node, 2U);
  EXPECT_EQ(result.parts[1].primitive, 1U);
  EXPECT_EQ(result.parts[2].node, 3U);
  EXPECT_EQ(result.parts[2].mesh, 2U);
  std::vector<double> times;
  for (const Motion::Keyframe& keyframe : result.motion.keyframes) times.push_back(keyframe.time);
  EXPECT_EQ(times, (std::vector<double>{0, 0.25, 1, 2, 4, 5}));
  EXPECT_EQ(result.motion.segments.size(), 5U);

  const std::vector<float> still(9, 0.0F);
  for (int i = 0; i <= 1000; ++i) {
    const double time = 5 * i / 1000.0;
    const std::vector<double> read = positions_at(result.motion, time);
    std::vector<double> expected = true_positions(tracks[1], kFirst, {kFirstMove}, time);
    for (const auto& more : {true_positions(tracks[1], test::kQuad, {test::kLift}, time),
                             true_positions(tracks[0], kLast, {still, kLastMove}, time)})
      expected.insert(expected.end(), more.begin(), more.end());
    ASSERT_EQ(read.size(), expected.size());
    for (std::size_t k = 0; k < read.size(); ++k) ASSERT_NEAR(read[k], expected[k], 1e-6) << time;
  }
}

TEST(GltfLinear, one_mesh_on_two_nodes_takes_part_twice) {
  const std::vector<Track> tracks = {{0, GltfInterpolation::kLinear, {0, 1}, {0, 0, 0, 1}},
                                     {3, GltfInterpolation::kLinear, {0, 1}, {0, 1, 0, 0}}};
  const GltfMotion result = motion_of(two_nodes(tracks), "two");
  ASSERT_EQ(result.parts.size(), 2U);
  EXPECT_EQ(result.parts[0].node, 0U);
  EXPECT_EQ(result.parts[1].node, 3U);
  EXPECT_EQ(result.parts[1].first_vertex, 3U);
  ASSERT_EQ(result.motion.keyframes.size(), 2U);
  EXPECT_EQ(result.motion.keyframes[0].positions, joined(kLast, plus(kLast, kLastMove)));
  EXPECT_EQ(result.motion.keyframes[1].positions, joined(plus(kLast, kLastMove), kLast));
}

TEST(GltfLinear, several_animations_are_told_apart) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("lift"), 0, {0, 1}, {0, 0, 1, 0});
  builder.add_track<float>(builder.add_animation("shift"), 0, {0, 2}, {0, 0, 0, 1});
  EXPECT_EQ(motion_of(builder, "lift").motion.keyframes[1].positions, plus(test::kQuad, test::kLift));
  EXPECT_EQ(motion_of(builder, "shift").motion.keyframes[1].positions, plus(test::kQuad, test::kShift));
  EXPECT_EQ(motion_of(builder, "1").motion.keyframes[1].time, 2);
  GltfMotionOptions options;
  options.animation = "wave";
  EXPECT_EQ(error_of(builder, options).code, ErrorCode::kUsage);
}

TEST(GltfLinear, animation_that_drives_no_weights_is_an_error) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("turn"), 0, {0, 1}, {0, 0, 1, 0});
  builder.json["animations"][0]["channels"][0]["target"]["path"] = "rotation";
  GltfMotionOptions options;
  options.animation = "turn";
  EXPECT_EQ(error_of(builder, options).code, ErrorCode::kInvalidInput);
}

TEST(GltfLinear, channel_without_node_is_not_played) {
  GltfBuilder builder = test::quad_document();
  const std::size_t animation = builder.add_animation("a");
  builder.add_track<float>(animation, 0, {0, 1}, {0, 0, 1, 0});
  builder.add_track<float>(animation, 0, {0, 1}, {0, 0, 0, 1});
  builder.json["animations"][0]["channels"][1]["target"].erase("node");
  EXPECT_EQ(motion_of(builder, "a").motion.keyframes[1].positions, plus(test::kQuad, test::kLift));
}

TEST(GltfLinear, two_channels_of_the_same_weights_are_refused) {
  GltfBuilder builder = test::quad_document();
  const std::size_t animation = builder.add_animation("a");
  builder.add_track<float>(animation, 0, {0, 1}, {0, 0, 1, 0});
  builder.add_track<float>(animation, 0, {0, 1}, {0, 0, 0, 1});
  const GltfFixture file(builder);
  EXPECT_TRUE(file.error().starts_with("a.gltf, /animations/0/channels/1")) << file.error();
}

TEST(GltfStep, holds_still_between_keys_and_jumps_at_them) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("jump"), 0, {0, 1, 3}, {0, 0, 1, 0, 0, 1}, "STEP");
  const GltfMotion result = motion_of(builder, "jump");
  const Motion& motion = result.motion;
  EXPECT_EQ(result.curve_error, 0);
  ASSERT_EQ(motion.segments.size(), 2U);
  const std::vector<float> held[] = {test::kQuad, plus(test::kQuad, test::kLift)};
  const double times[] = {0, 1, 3};
  for (std::size_t s = 0; s < 2; ++s) {
    const Motion::Keyframe& from = motion.keyframes[motion.segments[s].from];
    const Motion::Keyframe& to = motion.keyframes[motion.segments[s].to];
    EXPECT_EQ(from.time, times[s]);
    EXPECT_EQ(to.time, times[s + 1]);
    EXPECT_EQ(from.positions, held[s]);
    EXPECT_EQ(to.positions, held[s]);
  }
  // A key of a STEP track between the first and the last key becomes two keyframes: one just before the time of the key
  // and one just after.
  EXPECT_EQ(std::count_if(motion.keyframes.begin(), motion.keyframes.end(), [](const auto& k) { return k.time == 1; }),
            2);
}

TEST(GltfStep, beside_a_linear_track_each_keeps_its_own_way) {
  const std::vector<Track> tracks = {{2, GltfInterpolation::kStep, {0, 1, 2}, {0, 1, 0.5F}},
                                     {3, GltfInterpolation::kLinear, {0, 0.5F, 2}, {0, 0, 0, 1, 0, -1}}};
  const GltfMotion result = motion_of(two_nodes(tracks), "two");
  const std::vector<float> still(9, 0.0F);
  for (int i = 0; i < 1000; ++i) {
    const double time = 2 * (i + 0.5) / 1000.0;  // never exactly the time of a key
    const std::vector<double> read = positions_at(result.motion, time);
    std::vector<double> expected = true_positions(tracks[0], kFirst, {kFirstMove}, time);
    for (const auto& more : {true_positions(tracks[0], test::kQuad, {test::kLift}, time),
                             true_positions(tracks[1], kLast, {still, kLastMove}, time)})
      expected.insert(expected.end(), more.begin(), more.end());
    ASSERT_EQ(read.size(), expected.size());
    for (std::size_t k = 0; k < read.size(); ++k) ASSERT_NEAR(read[k], expected[k], 1e-6) << time;
  }
}

// Makes two nodes with the same mesh: a triangle whose third vertex rises by 1. The weight is 0 at 0 s and 1 at 1 s.
GltfBuilder two_nodes() {
  GltfBuilder builder;
  const auto base = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto lift = builder.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 1});
  builder.add_mesh(GltfBuilder::primitive(base, std::nullopt, GltfBuilder::Json::array({{{"POSITION", lift}}})));
  builder.add_node(0);
  builder.add_node(0);
  const auto animation = builder.add_animation("both");
  builder.add_track<float>(animation, 0, {0, 1, 2}, {0, 1, 1});
  builder.add_track<float>(animation, 1, {0, 1, 2}, {0, 1, 1}, "STEP");
  return builder;
}

TEST(GltfSharedKeys, mean_different_weights_by_another_interpolation) {
  GltfBuilder builder = two_nodes();
  auto& samplers = builder.json["animations"][0]["samplers"];
  samplers[1]["input"] = samplers[0]["input"];
  samplers[1]["output"] = samplers[0]["output"];
  const GltfMotion result = motion_of(builder, "both");
  // The second node rests until its weight jumps at 1 s, so in keyframe 1, just before 1 s, only the first node has
  // moved.
  const Motion& motion = result.motion;
  ASSERT_EQ(motion.keyframes.size(), 4U);
  EXPECT_EQ(motion.keyframes[1].positions[3 * 2 + 2], 1);
  EXPECT_EQ(motion.keyframes[1].positions[3 * 5 + 2], 0);
  EXPECT_EQ(motion.keyframes[2].positions[3 * 5 + 2], 1);
}

TEST(GltfSharedKeys, mean_different_weights_for_another_number_of_targets) {
  // The mesh of the first node has three targets and LINEAR keys. The mesh of the second node has one target and
  // CUBICSPLINE keys. Both tracks use the same six numbers as values.
  GltfBuilder builder = two_nodes();
  const auto& target = builder.json["meshes"][0]["primitives"][0]["targets"][0];
  auto three = builder.json["meshes"][0]["primitives"][0];
  three["targets"] = {target, target, target};
  const auto mesh = builder.add_mesh(three);
  builder.json["nodes"][0]["mesh"] = mesh;
  auto& samplers = builder.json["animations"][0]["samplers"];
  const auto times = builder.add_accessor("SCALAR", std::vector<float>{0, 1});
  const auto weights = builder.add_accessor("SCALAR", std::vector<float>{0, 0, 0, 0, 1, 0});
  for (auto& sampler : samplers) {
    sampler["input"] = times;
    sampler["output"] = weights;
  }
  samplers[1]["interpolation"] = "CUBICSPLINE";
  const GltfMotion result = motion_of(builder, "both");
  EXPECT_EQ(result.motion.keyframes.back().positions[3 * 2 + 2], 1) << "0 + 1 + 0 of three targets";
  EXPECT_EQ(result.motion.keyframes.back().positions[3 * 5 + 2], 1) << "the value of the last key, between tangents";
}

TEST(GltfBodies, meshes_and_nodes_are_never_one_point) {
  const GltfMotion result = motion_of(two_nodes(), "both");
  EXPECT_EQ(result.motion.body_of_vertex, (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 1}));
  // In the keyframe at 0 s, the triangles of both nodes are at the same place, but must not be welded.
  const Motion start{result.motion.topology, {result.motion.keyframes[0]}, {}, result.motion.body_of_vertex};
  EXPECT_EQ(weld_coincident(start).count, 6U);
}

TEST(GltfTargets, that_move_normals_alone_are_no_motion) {
  GltfBuilder builder = two_nodes();
  const auto normals = builder.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  auto& primitive = builder.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] = normals;
  primitive["targets"][0] = {{"NORMAL", normals}};
  EXPECT_NE(error_of(builder).message.find("nothing in this file moves"), std::string::npos);
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok());
  EXPECT_FALSE(has_moving_targets(*file));
}

TEST(GltfMemory, keyframes_beyond_what_is_allowed_are_refused_before_they_are_made) {
  GltfBuilder builder = test::quad_document();
  std::vector<float> times, values;
  for (int i = 0; i < 1000; ++i) {
    times.push_back(static_cast<float>(i));
    values.insert(values.end(), {static_cast<float>(i % 2), 0});
  }
  builder.add_track(builder.add_animation("long"), 0, times, values);
  GltfMotionOptions options;
  options.animation = "long";
  options.most_bytes = 1000 * 4 * 12 - 1;
  const Error error = error_of(builder, options);
  EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
  EXPECT_TRUE(error.place.starts_with("a.gltf")) << error.text();
  options.animation.clear();
  EXPECT_TRUE(read_gltf_motion(*GltfFixture(builder), options).ok());
  options.most_bytes = 3 * 4 * 12 - 1;
  EXPECT_EQ(error_of(builder, options).code, ErrorCode::kInvalidInput);
}

TEST(GltfMemory, vertices_that_32_bits_cannot_name_are_refused_before_they_are_read) {
  constexpr std::size_t kVertices = 300000, kNodes = 5000;  // many nodes have the same mesh
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(std::vector<float>(3 * kVertices)),
                    target = builder.add_accessor_over(std::nullopt, "VEC3", 5126, kVertices);
  builder.make_sparse<std::uint32_t, float>(target, {1}, {1, 2, 3});
  const std::size_t mesh =
      builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners), {{{"POSITION", target}}}));
  for (std::size_t n = 0; n < kNodes; ++n) (void)builder.add_node(mesh);
  GltfOptions reading;
  reading.max_expansion = std::numeric_limits<std::size_t>::max();
  const GltfFixture file(builder.glb(), std::nullopt, reading);
  ASSERT_TRUE(file.ok()) << file.error();
  GltfMotionOptions options;
  options.world = true;
  options.most_bytes = std::numeric_limits<std::size_t>::max();
  const Result<GltfMotion> motion = read_gltf_motion(*file, options);
  ASSERT_FALSE(motion.ok());
  if constexpr (sizeof(std::size_t) > 4) {
    EXPECT_EQ(
        motion.error().text(),
        "a.gltf: the mesh has more than 1,431,655,765 vertices, which is the most that can be read; split the mesh");
  }
}

TEST(GltfTargets, of_meshes_without_a_whole_face_are_no_motion) {
  GltfBuilder builder = test::quad_document();
  auto& primitive = builder.json["meshes"][0]["primitives"][0];
  primitive["mode"] = 5;
  primitive["indices"] = builder.add_indices(std::vector<std::uint16_t>{0, 1});
  EXPECT_EQ(error_of(builder).text(),
            "a.gltf: the meshes have no faces, so they have no normals; export meshes with faces");
}

}  // namespace
}  // namespace chronormal::gltf_motion_test
