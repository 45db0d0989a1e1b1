// Compares the errors that compare --blend finds in the deltas of blend shapes with errors that this test computes.
#include "chronormal/workflow/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analysis/quality/blend_quality.h"
#include "chronormal/core/parallel.h"
#include "chronormal/io/input.h"
#include "tests/support/blend_oracle.h"
#include "tests/support/child_process.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/read_input.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::blend_compare_test {
namespace {

using test::GltfBuilder;
using test::GltfFixture;
using test::random_sheet;
using test::Real;
using test::ShadedMesh;
using Json = GltfBuilder::Json;

constexpr double kNoise = 1e-4;       // largest error, in degrees, from rounding normals and their deltas to float32
constexpr double kExactLimit = 1e-6;  // largest error of exact deltas, in radians

Result<BlendComparison> try_comparing(const GltfBuilder& builder, const BlendCompareOptions& options) {
  const GltfFixture fixture(builder);
  EXPECT_TRUE(fixture.ok()) << fixture.error();
  return compare_blends(*fixture, options);
}

BlendComparison compared(const GltfBuilder& builder, const BlendCompareOptions& options = {}) {
  Result<BlendComparison> result = try_comparing(builder, options);
  EXPECT_TRUE(result.ok()) << result.error().text();
  return result.ok() ? std::move(result).value() : BlendComparison();
}

BlendComparison compared(const Motion& star, const BlendCompareOptions& options = {}) {
  Result<BlendComparison> result = compare_blends(star, options);
  EXPECT_TRUE(result.ok()) << result.error().text();
  return result.ok() ? std::move(result).value() : BlendComparison();
}

const Quality& quality(const BlendErrors& errors, BlendDeltas deltas) {
  const auto found = std::find_if(errors.deltas.begin(), errors.deltas.end(),
                                  [&](const BlendError& error) { return error.deltas == deltas; });
  EXPECT_NE(found, errors.deltas.end());
  return found->quality;
}

double degrees(double radians) { return radians * kDegreesPerRadian; }

std::vector<std::size_t> counts_of(const BlendSubject& subject) {
  std::vector<std::size_t> result;
  for (const BlendErrors& errors : subject.errors) result.push_back(errors.active);
  return result;
}

// Tells for each vertex of a sheet whether a target with a nonzero weight moves a face at the vertex or changes its
// stored normal.
std::vector<bool> moved_vertices(const ShadedMesh& mesh, const std::vector<double>& weights) {
  const auto moves = [](const std::vector<float>& deltas, std::size_t v) {
    return !deltas.empty() && test::vector_at(deltas, v) != test::Vector{0, 0, 0};
  };
  std::vector<bool> result(mesh.vertices());
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0) continue;
    for (std::size_t c = 0; c < mesh.corners.size(); c += 3) {
      if (!moves(mesh.targets[k].positions, mesh.corners[c]) &&
          !moves(mesh.targets[k].positions, mesh.corners[c + 1]) &&
          !moves(mesh.targets[k].positions, mesh.corners[c + 2]))
        continue;
      for (std::size_t i = 0; i < 3; ++i) result[mesh.corners[c + i]] = true;
    }
    for (std::size_t v = 0; v < result.size(); ++v) result[v] = result[v] || moves(mesh.targets[k].normals, v);
  }
  return result;
}

struct Expected {
  double sum = 0, max = 0;
  std::size_t count = 0;

  void add(Real angle) {
    sum += static_cast<double>(angle);
    max = std::max(max, static_cast<double>(angle));
    ++count;
  }
};

// Makes a motion from a set of targets. The keyframes of the motion are the base and, for each target, the positions
// with this target alone at weight 1.
Motion star_of(const BlendSet& set) {
  Motion motion;
  motion.topology = set.topology;
  motion.keyframes.push_back({set.base, 0, "base"});
  for (std::size_t k = 0; k < set.targets.size(); ++k) {
    motion.keyframes.push_back({set.base, 1, std::string("target ").append(std::to_string(k))});
    const BlendTarget& target = set.targets[k];
    for (std::size_t i = 0; i < target.deltas.size(); ++i)
      motion.keyframes.back().positions[3 * std::size_t{target.vertices[i / 3]} + i % 3] += target.deltas[i];
  }
  motion.connect_as_targets();
  return motion;
}

// ---- errors that oracles compute

TEST(BlendCompare, errors_of_a_file_are_those_of_an_oracle) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    ShadedMesh mesh = random_sheet(seed, 7, 3, 0.4);
    // Target 1 moves some vertices whose normals it does not change, and changes normals of vertices that it does not
    // move.
    for (std::size_t i = 0; i < 90; ++i) mesh.targets[1].positions[i] = 0;
    for (std::size_t i = 0; i < 60; ++i) mesh.targets[1].normals[i] = 0;
    const BlendComparison result = compared(mesh.file(), {.rows = 4, .seed = seed});
    ASSERT_EQ(result.subjects.size(), 1U);
    EXPECT_EQ(result.subjects[0].outputs, 49U);
    ASSERT_EQ(counts_of(result.subjects[0]), (std::vector<std::size_t>{1, 2, 3}));
    for (const BlendErrors& errors : result.subjects[0].errors) {
      const std::vector<double> rows = random_blend_weights({3, 4, errors.active, 0, 1, seed});
      Expected expected;
      for (std::size_t row = 0; row < 4; ++row) {
        const std::vector<double> weights(rows.begin() + static_cast<std::ptrdiff_t>(3 * row),
                                          rows.begin() + static_cast<std::ptrdiff_t>(3 * row + 3));
        const std::vector<bool> moved = moved_vertices(mesh, weights);
        for (std::size_t v = 0; v < mesh.vertices(); ++v)
          if (moved[v]) expected.add(mesh.error(v, weights));
      }
      const Quality& file = quality(errors, BlendDeltas::kFile);
      EXPECT_EQ(file.count, expected.count);
      EXPECT_NEAR(degrees(file.mean()), expected.sum / static_cast<double>(expected.count), 1e-5);
      EXPECT_NEAR(degrees(file.max), expected.max, 1e-4);
      EXPECT_GT(expected.max, 1);
      EXPECT_LT(quality(errors, BlendDeltas::kExact).max, kExactLimit);
      // At the weights and the vertex that the comparison states for the largest error, the oracle must find the same
      // error.
      const BlendError& worst = errors.deltas[0];
      std::vector<double> weights(3);
      for (const BlendError::Weight& w : worst.worst_weights) weights[w.target] = w.weight;
      EXPECT_EQ(worst.worst_weights.size(), errors.active);
      EXPECT_EQ(worst.worst_primitive, std::size_t{0});
      EXPECT_NEAR(static_cast<double>(mesh.error(worst.worst_output, weights)), degrees(worst.quality.max), 1e-4);
    }
  }
}

TEST(BlendCompare, end_point_errors_of_polygons_are_those_of_an_oracle) {
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
    const Motion star = star_of(test::random_blend_set(5));
    const BlendSet set = blend_set_of(star).value();
    const NormalGroups groups = test::vertices_of(set);
    const NormalGroups* const used = kind == ElementKind::kFaces ? nullptr : &groups;
    const auto unit_normals = [&](const std::vector<double>& weights) {
      std::vector<reference::Vector> normals = test::real_normals(set, used, weights);
      for (reference::Vector& n : normals) {
        const Real l = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (Real& c : n) c = l > 0 ? c / l : 0;
      }
      return normals;
    };
    const std::vector<double> none(5);
    const auto base = unit_normals(none);
    std::vector<std::vector<reference::Vector>> ends;
    for (std::size_t k = 0; k < 5; ++k) {
      std::vector<double> one = none;
      one[k] = 1;
      ends.push_back(unit_normals(one));
    }
    const BlendComparison result = compared(star, {.rows = 6, .elements = {kind}});
    ASSERT_EQ(counts_of(result.subjects[0]), (std::vector<std::size_t>{1, 2, 4, 5}));
    for (const BlendErrors& errors : result.subjects[0].errors) {
      const std::vector<double> rows = random_blend_weights({5, 6, errors.active, 0, 1, 1});
      Expected expected;
      for (std::size_t row = 0; row < 6; ++row) {
        const std::vector<double> weights(rows.begin() + static_cast<std::ptrdiff_t>(5 * row),
                                          rows.begin() + static_cast<std::ptrdiff_t>(5 * row + 5));
        const auto truth = unit_normals(weights);
        const std::vector<bool> touched = test::touched_elements(set, used, weights);
        for (std::size_t e = 0; e < truth.size(); ++e) {
          if (!touched[e]) continue;
          test::Vector shown = base[e];
          for (std::size_t k = 0; k < 5; ++k)
            for (std::size_t c = 0; c < 3; ++c) shown[c] += Real(weights[k]) * (ends[k][e][c] - base[e][c]);
          expected.add(test::degrees_between(shown, truth[e]));
        }
      }
      const Quality& end_point = quality(errors, BlendDeltas::kEndPoint);
      EXPECT_EQ(end_point.count, expected.count);
      EXPECT_NEAR(degrees(end_point.mean()), expected.sum / static_cast<double>(expected.count), 1e-4);
      EXPECT_NEAR(degrees(end_point.max), expected.max, 1e-3);
      EXPECT_GT(expected.max, 1);
      EXPECT_LT(quality(errors, BlendDeltas::kExact).max, kExactLimit);
    }
  }
}

TEST(BlendCompare, factors_of_extra_targets_of_a_bake_weigh_them) {
  ShadedMesh mesh = random_sheet(9, 6, 3, 0.2);
  std::fill(mesh.targets[2].positions.begin(), mesh.targets[2].positions.end(), 0.0F);
  GltfBuilder builder = mesh.file();
  builder.json["meshes"][0]["extras"]["chronormal"] = Json::parse(
      R"({"version": 1, "encode": "exact", "sequence": false, "extras": [{"target": 2, "factors": [0, 1]}]})");
  const BlendComparison result = compared(builder, {.rows = 5});
  ASSERT_EQ(counts_of(result.subjects[0]), (std::vector<std::size_t>{1, 2}));
  const std::vector<double> rows = random_blend_weights({2, 5, 2, 0, 1, 1});
  Expected expected;
  for (std::size_t row = 0; row < 5; ++row) {
    const double a = rows[2 * row], b = rows[2 * row + 1];
    for (std::size_t v = 0; v < mesh.vertices(); ++v) expected.add(mesh.error(v, {a, b, a * b}));
  }
  EXPECT_EQ(quality(result.subjects[0].errors[1], BlendDeltas::kFile).count, expected.count);
  EXPECT_NEAR(degrees(quality(result.subjects[0].errors[1], BlendDeltas::kFile).mean()),
              expected.sum / static_cast<double>(expected.count), 1e-5);
}

TEST(BlendCompare, worst_vertex_is_counted_within_its_primitive) {
  const ShadedMesh mesh = random_sheet(8, 5, 2, 0.3);
  ShadedMesh still = random_sheet(3, 4, 2, 0.1);
  for (ShadedMesh::Target& target : still.targets) {
    std::fill(target.positions.begin(), target.positions.end(), 0.0F);
    std::fill(target.normals.begin(), target.normals.end(), 0.0F);
  }
  for (float& c : still.positions) c += 100;
  GltfBuilder builder = still.file();
  builder.add_primitive(0, mesh.primitive(builder));
  const BlendComparison result = compared(builder, {.rows = 3, .active = 2});
  EXPECT_EQ(result.subjects[0].outputs, 41U);
  const BlendError& worst = result.subjects[0].errors[0].deltas[0];
  EXPECT_EQ(worst.worst_primitive, std::size_t{1});
  ASSERT_EQ(worst.worst_weights.size(), 2U);
  EXPECT_NEAR(static_cast<double>(
                  mesh.error(worst.worst_output, {worst.worst_weights[0].weight, worst.worst_weights[1].weight})),
              degrees(worst.quality.max), 1e-4);
}

// ---- the kinds of deltas

TEST(BlendCompare, end_points_are_right_for_each_target_alone_at_weight_one_and_wrong_together) {
  GltfBuilder builder = random_sheet(4, 6, 2, 0.3).file();
  builder.add_track<float>(builder.add_animation("alone"), 0, {0, 1, 2}, {1, 0, 0, 1, 0, 0}, "STEP");
  builder.add_track<float>(builder.add_animation("together"), 0, {0, 1}, {1, 1, 0, 0}, "STEP");
  const BlendComparison alone = compared(builder, {.animation = "alone"});
  ASSERT_EQ(alone.subjects[0].errors.size(), 1U);
  EXPECT_EQ(alone.subjects[0].errors[0].rows, 3U);
  EXPECT_EQ(alone.subjects[0].errors[0].active, 1U);
  EXPECT_LT(degrees(quality(alone.subjects[0].errors[0], BlendDeltas::kEndPoint).max), kNoise);
  EXPECT_GT(degrees(quality(alone.subjects[0].errors[0], BlendDeltas::kFile).max), 1);
  const BlendComparison together = compared(builder, {.animation = "1"});
  EXPECT_EQ(together.subjects[0].errors[0].active, 2U);
  EXPECT_GT(degrees(quality(together.subjects[0].errors[0], BlendDeltas::kEndPoint).max), 1);
  // For a single pose, least squares give nearly exact deltas.
  EXPECT_LT(degrees(quality(together.subjects[0].errors[0], BlendDeltas::kLeastSquares).max), 0.01);
}

TEST(BlendCompare, least_squares_are_over_other_random_weights_but_over_those_of_an_animation) {
  // There are as many poses as targets. If the deltas were fitted to the poses in which they are judged, they would
  // have almost no error.
  const Motion star = star_of(test::random_blend_set(6, {.targets = 12, .reach = 0.7}));
  const BlendErrors random = compared(star, {.rows = 3, .active = 6}).subjects[0].errors[0];
  EXPECT_GT(degrees(quality(random, BlendDeltas::kLeastSquares).mean()), 0.2);
  EXPECT_LT(quality(random, BlendDeltas::kLeastSquares).rms(), quality(random, BlendDeltas::kEndPoint).rms());
  GltfBuilder builder = random_sheet(4, 6, 2, 0.3).file();
  builder.add_track<float>(builder.add_animation(""), 0, {0, 1, 2}, {0.1F, 0.3F, 1, 0.7F, 0, 1});
  const BlendErrors animated = compared(builder, {.rows = 50, .animation = "0"}).subjects[0].errors[0];
  EXPECT_EQ(animated.rows, 33U);
  EXPECT_LT(quality(animated, BlendDeltas::kLeastSquares).rms(), quality(animated, BlendDeltas::kEndPoint).rms());
  EXPECT_LT(quality(animated, BlendDeltas::kExact).max, kExactLimit);
}

// ---- the choice of weights

TEST(BlendCompare, active_targets_are_1_2_4_8_16_and_all_as_far_as_there_are_or_what_is_asked_for) {
  const auto counts = [](std::size_t targets, std::size_t active) {
    const Motion star = star_of(test::random_blend_set(1, {.cells = 3, .targets = targets}));
    return counts_of(compared(star, {.rows = 1, .active = active}).subjects[0]);
  };
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(counts(1, 0), Counts{1});
  EXPECT_EQ(counts(8, 0), (Counts{1, 2, 4, 8}));
  EXPECT_EQ(counts(20, 0), (Counts{1, 2, 4, 8, 16, 20}));
  EXPECT_EQ(counts(20, 5), Counts{5});
}

TEST(BlendCompare, same_seed_gives_the_same_bits_on_any_number_of_threads) {
  const Motion star = make_builtin_morph("bumps").value();
  const auto sums = [&](std::uint64_t seed, std::size_t threads) {
    const ThreadLimit limit(threads);
    std::vector<double> result;
    const BlendComparison comparison = compared(star, {.rows = 2, .seed = seed});
    for (const BlendErrors& errors : comparison.subjects[0].errors)
      for (const BlendError& error : errors.deltas) {
        result.push_back(error.quality.sum);
        result.push_back(error.quality.max);
      }
    return result;
  };
  EXPECT_EQ(sums(1, 1), sums(1, 3));
  EXPECT_NE(sums(1, 1), sums(2, 1));
}

TEST(BlendCompare, an_animation_gives_no_more_poses_than_asked_for_and_each_curve_once) {
  GltfBuilder builder = random_sheet(4, 5, 2, 0.3).file();
  builder.add_node(0);
  const std::size_t animation = builder.add_animation("walk");
  builder.add_track<float>(animation, 0, {0, 1, 2}, {0, 0, 0.5F, 1, 0, 0});
  const std::size_t once = compared(builder, {.rows = 1000, .animation = "walk"}).subjects[0].errors[0].rows;
  EXPECT_EQ(once, 33U);
  EXPECT_EQ(compared(builder, {.rows = 7, .animation = "walk"}).subjects[0].errors[0].rows, 7U);
  Json channel = builder.json["animations"][animation]["channels"][0];
  channel["target"]["node"] = 1;  // another node, which the same sampler drives
  builder.json["animations"][animation]["channels"].push_back(channel);
  EXPECT_EQ(compared(builder, {.rows = 1000, .animation = "walk"}).subjects[0].errors[0].rows, once);
}

// ---- the compared samples

TEST(BlendCompare, meshes_without_normals_and_those_that_stand_still_are_counted) {
  GltfBuilder builder = random_sheet(1, 4, 1, 0.1).file();
  ShadedMesh flat = random_sheet(2, 4, 1, 0.1);
  flat.normals.clear();
  flat.targets[0].normals.clear();
  builder.add_mesh(flat.primitive(builder));
  ShadedMesh still = random_sheet(3, 4, 1, 0.1);
  for (std::vector<float>* const deltas : {&still.targets[0].positions, &still.targets[0].normals})
    std::fill(deltas->begin(), deltas->end(), 0.0F);
  builder.add_mesh(still.primitive(builder));
  ShadedMesh none = random_sheet(3, 4, 0, 0.1);
  builder.add_mesh(none.primitive(builder));
  builder.add_mesh(random_sheet(4, 5, 2, 0.1).primitive(builder), {{"name", "last"}});
  const BlendComparison result = compared(builder, {.rows = 2});
  ASSERT_EQ(result.subjects.size(), 2U);
  EXPECT_EQ(result.subjects[0].mesh, std::size_t{0});
  EXPECT_EQ(result.subjects[1].mesh, std::size_t{4});
  EXPECT_EQ(result.subjects[1].name, "last");
  EXPECT_EQ(result.flat, 1U);
  EXPECT_EQ(result.still, 1U);
}

TEST(BlendCompare, every_method_is_judged_on_the_same_pairs_and_what_cannot_be_lit_is_off_by_180_degrees) {
  // The deltas are the negative base normals. At weight 1, the file renders a normal of length zero, although the
  // surface has a normal.
  ShadedMesh mesh = random_sheet(5, 5, 1, 0.1);
  mesh.targets[0].normals.clear();
  for (const float c : mesh.normals) mesh.targets[0].normals.push_back(-c);
  GltfBuilder builder = mesh.file();
  builder.add_track<float>(builder.add_animation("away"), 0, {0, 1}, {1, 1}, "STEP");
  const BlendErrors errors = compared(builder, {.animation = "away"}).subjects[0].errors[0];
  ASSERT_EQ(errors.deltas.size(), 4U);
  for (const BlendError& error : errors.deltas) {
    EXPECT_EQ(error.quality.count, 50U) << name_of(error.deltas);
    EXPECT_EQ(error.quality.degenerate, 0U);
  }
  const Quality& file = quality(errors, BlendDeltas::kFile);
  EXPECT_EQ(file.missing, 50U);
  EXPECT_NEAR(degrees(file.mean()), 180, 1e-9);
  EXPECT_EQ(quality(errors, BlendDeltas::kExact).missing, 0U);
}

TEST(BlendCompare, normals_that_collapse_are_left_out) {
  // The target folds a triangle onto a line, so there is no normal at weight 1, and only there.
  GltfBuilder builder;
  ShadedMesh mesh;
  mesh.corners = {0, 1, 2};
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1};
  mesh.targets = {{{0, 0, 0, 0, 0, 0, 0, -1, 0}, {}, {}}};
  builder = mesh.file();
  builder.add_track<float>(builder.add_animation("fold"), 0, {0, 1, 2}, {0.5F, 1, 0.25F}, "STEP");
  const BlendErrors errors = compared(builder, {.animation = "fold"}).subjects[0].errors[0];
  for (const BlendError& error : errors.deltas) {
    EXPECT_EQ(error.quality.degenerate, 3U);
    EXPECT_EQ(error.quality.count, 6U);
  }
}

// ---- the built-in set

TEST(BlendCompare, bumps_are_blend_shapes_of_which_each_target_moves_a_part_and_overlaps_others) {
  const Motion star = make_builtin_morph("bumps").value();
  const BlendSet set = blend_set_of(star).value();
  EXPECT_TRUE(validate(set).ok());
  ASSERT_EQ(set.targets.size(), 12U);
  EXPECT_EQ(set.topology.face_count(), 6144U);
  const auto shared = [&](std::size_t a, std::size_t b) {
    std::vector<std::uint32_t> both;
    std::set_intersection(set.targets[a].vertices.begin(), set.targets[a].vertices.end(),
                          set.targets[b].vertices.begin(), set.targets[b].vertices.end(), std::back_inserter(both));
    return both.size();
  };
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_GT(set.targets[k].vertices.size(), 30U) << k;
    EXPECT_LT(set.targets[k].vertices.size(), 1000U) << k;
    EXPECT_GT(shared(k, k + 1 < 12 ? k + 1 : k - 1) + shared(k, k + 3 < 12 ? k + 3 : k - 3), 30U) << k;
  }
  EXPECT_EQ(shared(0, 11), 0U);
  const BlendSubject subject = compared(star, {.rows = 20}).subjects[0];
  EXPECT_EQ(subject.targets[3], "bump_4");
  for (const BlendErrors& errors : subject.errors) {
    EXPECT_GT(degrees(quality(errors, BlendDeltas::kEndPoint).max), 1);
    EXPECT_LT(quality(errors, BlendDeltas::kExact).max, kExactLimit);
  }
}

// ---- errors

void expect_error(const Result<BlendComparison>& result, ErrorCode code, const std::string& words) {
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, code);
  EXPECT_NE(result.error().text().find(words), std::string::npos) << result.error().text();
}

TEST(BlendCompare, options_beyond_their_range_are_misuse) {
  const Motion star = star_of(test::random_blend_set(1));
  const GltfBuilder file = random_sheet(1, 4, 2, 0.1).file();
  for (const std::size_t rows : {std::size_t{0}, kMostBlendRows + 1, ~std::size_t{0}}) {
    expect_error(compare_blends(star, {.rows = rows}), ErrorCode::kUsage, "10,000");
    expect_error(try_comparing(file, {.rows = rows}), ErrorCode::kUsage, "10,000");
  }
  expect_error(compare_blends(star, {.active = 6}), ErrorCode::kUsage, "only 5 targets");
  expect_error(try_comparing(file, {.active = 3}), ErrorCode::kUsage, "more than 2 targets");
  expect_error(compare_blends(star, {.animation = "walk"}), ErrorCode::kUsage, "glTF");
  expect_error(try_comparing(file, {.animation = "walk"}), ErrorCode::kUsage, "walk");
  expect_error(compare_blends(make_builtin_morph("cloth").value(), {}), ErrorCode::kUsage, "sequence");
  expect_error(compare_blends(star, {.elements = {ElementKind::kCorners, true, 200}}), ErrorCode::kUsage, "180");
}

TEST(BlendCompare, files_without_anything_to_compare_say_so) {
  ShadedMesh flat = random_sheet(2, 4, 1, 0.1);
  flat.normals.clear();
  flat.targets[0].normals.clear();
  expect_error(try_comparing(flat.file(), {}), ErrorCode::kInvalidInput,
               "the file has no mesh with both morph targets and normals; export the mesh with both");
  GltfBuilder undriven = random_sheet(2, 4, 1, 0.1).file();
  undriven.add_node(undriven.add_mesh(flat.primitive(undriven)));
  undriven.add_track<float>(undriven.add_animation("turn"), 1, {0, 1}, {0, 1});
  expect_error(try_comparing(undriven, {.animation = "turn"}), ErrorCode::kUsage, "drives no mesh");
  GltfBuilder sequence = random_sheet(2, 4, 2, 0.1).file();
  sequence.json["meshes"][0]["extras"]["chronormal"] =
      Json::parse(R"({"version": 1, "encode": "exact", "sequence": true})");
  sequence.add_track<float>(sequence.add_animation("walk"), 0, {0, 1}, {1, 0, 0, 1});
  expect_error(try_comparing(sequence, {}), ErrorCode::kUsage, "--animation");
  EXPECT_EQ(compared(sequence, {.animation = "walk"}).subjects.size(), 1U);
}

TEST(BlendCompare, an_animation_and_a_number_of_active_targets_are_not_both_taken) {
  expect_error(try_comparing(random_sheet(2, 4, 1, 0.1).file(), {.active = 1, .animation = "walk"}), ErrorCode::kUsage,
               "an animation itself says which targets are active; leave out either the number of active targets or "
               "the animation");
}

TEST(BlendCompare, so_many_targets_that_their_weights_do_not_fit_are_refused_before_anything_is_read) {
  GltfBuilder builder = random_sheet(2, 4, 1, 0.1).file();
  Json& targets = builder.json["meshes"][0]["primitives"][0]["targets"];
  const Json first = targets[0];
  for (std::size_t k = 1; k < 20000; ++k) targets.push_back(first);
  expect_error(try_comparing(builder, {.rows = 1}), ErrorCode::kInvalidInput,
               "of 20,000 targets would need too much memory");
}

// ---- real data

TEST(BlendCompare, face_by_other_people_is_off_by_tens_of_degrees_with_end_points_and_by_rounding_when_exact) {
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers make half a minute of it";
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  const std::string folder = std::string(data) + "/face_mpfb2/", targets = folder + "targets/";
  const Result<Motion> star = test::read_motion(test::targets_over(folder + "base.obj", {targets}));
  ASSERT_TRUE(star.ok()) << star.error().text();
  const BlendSubject face = compared(star.value()).subjects[0];
  EXPECT_EQ(counts_of(face), (std::vector<std::size_t>{1, 2, 4, 8, 16, 102}));
  double last = 0;
  for (const BlendErrors& errors : face.errors) {
    const Quality& end_point = quality(errors, BlendDeltas::kEndPoint);
    EXPECT_GT(degrees(end_point.max), 30) << errors.active;
    EXPECT_GT(end_point.mean(), last);  // errors grow with the number of active targets
    last = end_point.mean();
    EXPECT_LT(quality(errors, BlendDeltas::kExact).max, kExactLimit) << errors.active;
  }
}

}  // namespace
}  // namespace chronormal::blend_compare_test
