// Compares normals at any weights with normals of blended positions, which are computed in rational numbers or in long
// double. The tests of real files are skipped unless the environment variable CHRONORMAL_DATA names the folder of these
// files.
#include "normals/blend/blend_normals.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/normals/normal_groups.h"
#include "io/gltf/gltf_motion.h"
#include "simd/targets.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/blend_oracle.h"
#include "tests/support/read_input.h"

namespace chronormal::blend_normals_test {
namespace {

constexpr BlendPath kPaths[] = {BlendPath::kTerms, BlendPath::kTouched, BlendPath::kWhole};
constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

BlendNormals normals_of(const BlendSet& set, const NormalGroups* groups, const BlendNormalsOptions& options = {}) {
  return groups ? BlendNormals::of_groups(set, *groups, options) : BlendNormals::of_faces(set, options);
}

struct Evaluated {
  BlendEvaluation evaluation;
  std::vector<float> xyz;

  [[nodiscard]] std::vector<float> of(std::size_t e) const { return {xyz[3 * e], xyz[3 * e + 1], xyz[3 * e + 2]}; }
};

Evaluated evaluate(BlendNormals& normals, std::span<const double> weights, Threads threads = Threads::kOne) {
  Evaluated result;
  result.xyz.assign(3 * normals.size(), std::nanf(""));
  result.evaluation =
      normals.unit_normals(weights, VectorView<float>::packed(result.xyz.data(), normals.size()), threads);
  return result;
}

struct Errors {
  double largest = 0;     // in radians
  std::size_t far = 0;    // elements with an error above 1e-6 rad
  std::size_t zeros = 0;  // normals that are (0, 0, 0)
};

Errors errors_of(const Evaluated& done, const std::vector<exact::Vector>& expected) {
  Errors errors;
  for (std::size_t e = 0; e < expected.size(); ++e) {
    const std::vector<float> u = done.of(e);
    if (u == std::vector<float>{0, 0, 0}) {
      ++errors.zeros;
      errors.far += exact::is_zero(expected[e]) ? 0U : 1U;
      continue;
    }
    const double length = std::hypot(u[0], u[1], u[2]);
    EXPECT_NEAR(length, 1, 3e-7);
    const double angle = exact::is_zero(expected[e]) ? 4 : exact::angle(u[0], u[1], u[2], expected[e]);
    errors.largest = std::max(errors.largest, angle);
    errors.far += angle <= 1e-6 ? 0U : 1U;
  }
  return errors;
}

Errors errors_of(const Evaluated& done, const std::vector<reference::Vector>& expected) {
  Errors errors;
  for (std::size_t e = 0; e < expected.size(); ++e) {
    const std::vector<float> u = done.of(e);
    if (u == std::vector<float>{0, 0, 0}) {
      ++errors.zeros;
      errors.far += reference::length(expected[e]) > 0 ? 1U : 0U;
      continue;
    }
    const auto angle = static_cast<double>(reference::angle(reference::Vector{u[0], u[1], u[2]}, expected[e]));
    errors.largest = std::max(errors.largest, angle);
    errors.far += angle <= 1e-6 ? 0U : 1U;
  }
  return errors;
}

// Checks that the error of each normal is at most 1e-6 radians, except for elements that the result counts as
// uncertain.
template <class Expected>
void expect_exact(const Evaluated& done, const std::vector<Expected>& expected, const std::string& what) {
  const Errors errors = errors_of(done, expected);
  EXPECT_EQ(errors.zeros, done.evaluation.zeros) << what;
  EXPECT_EQ(errors.far, 0U) << what << ": off by " << errors.largest << " rad";
  EXPECT_EQ(done.evaluation.uncertain_elements, 0U) << what;
}

RC_GTEST_PROP(BlendNormals, any_sparse_overlap_and_weights_equal_blended_positions_within_1e_6_rad_on_every_path, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const auto targets = *rc::gen::inRange<std::size_t>(0, 9);
  const BlendSet set = test::random_blend_set(seed, {.cells = 5,
                                                     .targets = targets,
                                                     .reach = *rc::gen::element(0.3, 0.8, 3.0),
                                                     .size = *rc::gen::element(0.01, 0.3, 2.0)});
  const std::vector<double> weights =
      test::random_weights(seed, targets, *rc::gen::inRange<std::size_t>(0, targets + 1));
  const NormalGroups vertices = test::vertices_of(set);
  for (const NormalGroups* groups : {&vertices, static_cast<const NormalGroups*>(nullptr)}) {
    const std::vector<exact::Vector> expected = test::exact_normals(set, groups, weights);
    for (const BlendPath path : kPaths) {
      BlendNormals normals = normals_of(set, groups, {kUnlimited, path});
      const Evaluated done = evaluate(normals, weights);
      expect_exact(done, expected, std::string(test::name_of(path)));
      RC_ASSERT(done.evaluation.path == path);
    }
  }
}

RC_GTEST_PROP(BlendNormals, corners_split_by_creases_are_elements_like_others, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const BlendSet set = test::random_blend_set(seed, {.targets = 4, .reach = 0.8});
  Motion motion;
  motion.topology = set.topology;
  motion.keyframes = {{set.base, 0, ""}, {set.base, 1, ""}};
  motion.segments = {{0, 1}};
  const NormalGroups corners =
      NormalGroups::by_crease_angle(motion, separate_points(set.topology.vertex_count()), 20).value();
  RC_ASSERT(corners.size() > set.topology.vertex_count());
  BlendNormals normals = BlendNormals::of_groups(set, corners);
  const std::vector<double> weights = test::random_weights(seed, 4, 3);
  expect_exact(evaluate(normals, weights), test::exact_normals(set, &corners, weights), "corners");
}

RC_GTEST_PROP(BlendNormals, size_and_place_of_the_mesh_do_not_matter, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const double scale = *rc::gen::element(1e-18, 1e-6, 1e6, 1e16), offset = *rc::gen::element(0.0, 1000.0);
  const BlendSet set = test::random_blend_set(seed, {.targets = 4, .reach = 0.8, .scale = scale, .offset = offset});
  const NormalGroups vertices = test::vertices_of(set);
  const std::vector<double> weights = test::random_weights(seed, 4, 3);
  const std::vector<exact::Vector> expected = test::exact_normals(set, &vertices, weights);
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(set, vertices, {kUnlimited, path});
    expect_exact(evaluate(normals, weights), expected, std::string(test::name_of(path)));
  }
}

RC_GTEST_PROP(BlendNormals, scale_by_a_power_of_two_gives_the_same_bits, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const double scale = std::ldexp(1.0, *rc::gen::inRange(-60, 61));
  const test::BlendShapeOptions options{.targets = 4, .reach = 0.8};
  test::BlendShapeOptions scaled = options;
  scaled.scale = scale;
  const BlendSet set = test::random_blend_set(seed, options), other_set = test::random_blend_set(seed, scaled);
  const std::vector<double> weights = test::random_weights(seed, 4, 4);
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(set, test::vertices_of(set), {kUnlimited, path});
    BlendNormals other = BlendNormals::of_groups(other_set, test::vertices_of(set), {kUnlimited, path});
    const Evaluated before = evaluate(normals, weights), after = evaluate(other, weights);
    RC_ASSERT(before.xyz == after.xyz);
    RC_ASSERT(before.evaluation.recomputed_elements == after.evaluation.recomputed_elements);
  }
}

// The weights of this test move a vertex exactly onto the line through the other two vertices, or very close to this
// line. The library must then recompute the face in double.
TEST(BlendNormals, near_a_collapse_double_takes_over_and_at_it_there_are_counted_zeros) {
  BlendSet set;
  set.topology = fixtures::make_triangles(3, {0, 1, 2});
  set.base = {0, 0, 0, 1, 0, 0, 0.3F, 1, 0.5F};
  set.targets = {{"", {2}, {0, -1, -0.5F}}, {"", {1, 2}, {0.1F, 0, 0, 0.1F, 0, 0}}};
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_faces(set, {kUnlimited, path});
    for (const double gap : {1e-3, 1e-5, 1e-7}) {
      const std::vector<double> weights = {1 - gap, 0.7};
      const Evaluated done = evaluate(normals, weights);
      expect_exact(done, test::exact_normals(set, nullptr, weights), std::string(test::name_of(path)));
      EXPECT_EQ(done.evaluation.recomputed_elements, 1U);
    }
    const Evaluated zero = evaluate(normals, std::vector{1.0, 0.7});
    EXPECT_EQ(zero.xyz, (std::vector<float>{0, 0, 0}));
    EXPECT_EQ(zero.evaluation.zeros, 1U);
    // At the weight 1 - 2^-50, the face is so close to collapsing that double cannot decide its direction. The result
    // must count the face as zero or as uncertain.
    const Evaluated near = evaluate(normals, std::vector{1 - 0x1p-50, 0.7});
    EXPECT_EQ(near.evaluation.zeros + near.evaluation.uncertain_elements, 1U);
    EXPECT_EQ(evaluate(normals, std::vector{0.0, 0.7}).evaluation.zeros, 0U);
  }
}

// Far from the origin, the rounding errors of blended positions are large relative to the edges, and change the
// normals.
TEST(BlendNormals, what_double_cannot_promise_far_from_the_origin_is_counted) {
  BlendSet set;
  set.topology = fixtures::make_triangles(3, {0, 1, 2});
  set.base = {0, 0, 0, 1, 0, 0, 0.3F, 1, 0.5F};
  for (float& c : set.base) c += 0x1p20F;
  set.targets = {{"", {2}, {0, -1, -0.5F}}, {"", {1, 2}, {0.1F, 0, 0, 0.1F, 0, 0}}};
  std::size_t far = 0, sure = 0;
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_faces(set, {kUnlimited, path});
    for (int bits = 4; bits < 48; ++bits) {
      const std::vector<double> weights = {1 - std::ldexp(0.7, -bits), 0.7};
      const Evaluated done = evaluate(normals, weights);
      const Errors errors = errors_of(done, test::exact_normals(set, nullptr, weights));
      EXPECT_LE(errors.far, done.evaluation.uncertain_elements + done.evaluation.zeros) << bits << " bits";
      far += errors.far;
      sure += 1 - done.evaluation.uncertain_elements - done.evaluation.zeros;
    }
  }
  EXPECT_GT(far, 3U);
  EXPECT_GT(sure, 3U);
}

// All edges of a face contribute rounding errors, also the edges that follow a short edge.
TEST(BlendNormals, what_double_cannot_promise_of_a_triangle_with_one_short_edge_is_counted) {
  BlendSet set;
  set.base = {0, 0, 0, 1, 0, 0, 3000, 1000, 500};
  for (float& c : set.base) c += 0x1p20F;
  set.targets = {{"", {2}, {0, -1000, -500}}, {"", {1}, {0, 0, 100}}, {"", {1}, {0, 0, 100}}};
  std::size_t far = 0, sure = 0;
  for (const std::vector<std::uint32_t>& corners :
       {std::vector<std::uint32_t>{0, 1, 2}, std::vector<std::uint32_t>{1, 2, 0}}) {
    set.topology = fixtures::make_triangles(3, corners);
    for (const BlendPath path : kPaths) {
      BlendNormals normals = BlendNormals::of_faces(set, {kUnlimited, path});
      for (int bits = 4; bits < 48; ++bits) {
        const std::vector<double> weights = {1 - std::ldexp(0.7, -bits), 0.7, 1e-12 - 0.7};
        const Evaluated done = evaluate(normals, weights);
        const Errors errors = errors_of(done, test::exact_normals(set, nullptr, weights));
        EXPECT_LE(errors.far, done.evaluation.uncertain_elements + done.evaluation.zeros) << bits << " bits";
        far += errors.far;
        sure += 1 - done.evaluation.uncertain_elements - done.evaluation.zeros;
      }
    }
  }
  EXPECT_GT(far, 3U);
  EXPECT_GT(sure, 3U);
}

// The blended normal of this test is so short that the square of its length is subnormal or zero in double.
TEST(BlendNormals, a_weight_that_barely_opens_a_point_gives_its_direction) {
  BlendSet set;
  set.topology = fixtures::make_triangles(3, {0, 1, 2});
  set.base.assign(9, 0);
  set.targets = {{"", {1, 2}, {1, 2, 3, 3, 1, -2}}};
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_faces(set, {kUnlimited, path});
    for (const double weight : {1e-20, 1e-70, 1e-78, 1e-82, 1e-100, 1e-140}) {
      const std::vector<double> weights = {weight};
      expect_exact(evaluate(normals, weights), test::exact_normals(set, nullptr, {{1.0}}),
                   std::string(test::name_of(path)));
    }
  }
}

// Every target rounds the position once more, in this test always in the same direction. A vertex moves to 256, then
// takes 250 steps of 1 + 127 eps, each of which loses 127 eps, and finally moves all the way back.
TEST(BlendNormals, rounding_of_every_target_counts) {
  constexpr double kEps = 0x1p-52;
  constexpr float kSize = 4e-6F;  // the loss of 7e-12 turns a triangle of this size by 1.8e-6 radians
  BlendSet set;
  set.topology = fixtures::make_triangles(3, {0, 1, 2});
  set.base = {0, 0, 0, kSize, 0, 0, 0, kSize, 0};
  set.targets.assign(252, {"", {2}, {0, 0, 1}});
  std::vector<double> weights(252, 1 + 127 * kEps);
  weights.front() = 256;
  weights.back() = -506;
  const auto expected = test::exact_normals(set, nullptr, weights);
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_faces(set, {kUnlimited, path});
    const Evaluated done = evaluate(normals, weights);
    EXPECT_EQ(errors_of(done, expected).far, 1U) << "no rounding to be counted";
    EXPECT_EQ(done.evaluation.uncertain_elements + done.evaluation.zeros, 1U) << test::name_of(path);
  }
}

// One face is a polygon that winds around a small triangle many times. Targets move the polygon far away, where the
// triangle is smaller than one ulp, and back. All corners of the polygon then coincide, and the computed area of the
// polygon is only rounding error. The edges of the polygon are zero, so the error of this area is bounded only by the
// square of the rounding error of positions. If the polygon has many turns, this bound exceeds the area of the adjacent
// triangle, the only face with a direction.
TEST(BlendNormals, area_that_rounding_of_positions_may_hide_counts) {
  constexpr float kFar = 1.5F * 0x1p52F;  // an ulp of double is 1 at this distance
  for (const int turns : {0, 10}) {
    BlendSet set;
    set.base = {0, 0, 0, 150, 0, 0, 0, 150, 0, -0.49F, -0.49F, 0, 0, 0.49F, 0, 0.49F, -0.49F, 0};
    std::vector<std::uint32_t> offsets = {0, 3}, corners = {0, 1, 2};
    if (turns > 0) corners.push_back(0);
    for (int i = 0; i < turns; ++i) corners.insert(corners.end(), {3, 4, 5});
    if (turns > 0) offsets.push_back(static_cast<std::uint32_t>(corners.size()));
    set.topology = fixtures::make_polygons(6, offsets, corners);
    BlendTarget away{"", {0, 1, 2, 3, 4, 5}, {}};
    for (int v = 0; v < 6; ++v) away.deltas.insert(away.deltas.end(), {kFar, kFar, 0});
    set.targets = {away, away};
    for (const BlendPath path : {BlendPath::kTouched, BlendPath::kWhole}) {  // sums of terms do not use positions
      BlendNormals normals = BlendNormals::of_groups(set, test::vertices_of(set), {kUnlimited, path});
      const std::vector<float> expected = {0, 0, turns == 0 ? 1.0F : 0.0F};
      EXPECT_EQ(evaluate(normals, std::vector{1.0, -1.0}).of(0), expected) << test::name_of(path) << ", " << turns;
    }
  }
}

TEST(BlendNormals, faces_without_area_in_the_base_count_until_a_target_opens_them) {
  BlendSet set;
  set.topology = fixtures::make_triangles(6, {0, 1, 2, 3, 4, 5});
  set.base = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 1, 1, 0, 1, 2, 0, 1};
  set.targets = {{"", {2}, {0, 1, 0}}};
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_faces(set, {kUnlimited, path});
    EXPECT_EQ(evaluate(normals, std::vector{0.0}).evaluation.zeros, 2U);
    const Evaluated open = evaluate(normals, std::vector{-0.5});
    EXPECT_EQ(open.evaluation.zeros, 1U);
    EXPECT_EQ(open.xyz, (std::vector<float>{0, 0, -1, 0, 0, 0}));
  }
}

// If large terms of a sum nearly cancel, the sum still has the rounding errors of the large terms.
TEST(BlendNormals, large_weights_that_nearly_cancel_are_seen) {
  BlendSet set = test::random_blend_set(11, {.targets = 1, .reach = 0.9});
  set.targets.push_back(set.targets[0]);
  fixtures::Random random(1);
  for (float& d : set.targets[1].deltas) d *= 1 + static_cast<float>(random.uniform(0, 1e-3));
  const NormalGroups vertices = test::vertices_of(set);
  for (const double size : {10.0, 100.0, 1000.0}) {
    const std::vector<double> weights = {size, -size};
    BlendNormals normals = BlendNormals::of_groups(set, vertices, {kUnlimited, BlendPath::kTerms});
    const Evaluated done = evaluate(normals, weights);
    expect_exact(done, test::exact_normals(set, &vertices, weights), "canceling");
    EXPECT_GT(done.evaluation.recomputed_elements, 0U);
  }
}

TEST(BlendNormals, weights_beyond_all_measure_never_give_a_nan) {
  const BlendSet set = test::random_blend_set(3, {.targets = 3, .reach = 0.5});
  const NormalGroups vertices = test::vertices_of(set);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(set, vertices, {kUnlimited, path});
    const Evaluated before = evaluate(normals, std::vector{0.5, 0.0, 0.0});
    for (const double weight : {std::nan(""), infinity, -infinity, 1e300, 1e160, -1e100, 1e-300, 5e-324}) {
      const Evaluated done = evaluate(normals, std::vector{0.5, weight, 0.1});
      for (const float c : done.xyz) ASSERT_TRUE(std::isfinite(c) && std::fabs(c) <= 1.0001F) << weight;
      EXPECT_EQ(evaluate(normals, std::vector{0.5, 0.0, 0.0}).xyz, before.xyz) << "nothing stays behind";
    }
  }
}

RC_GTEST_PROP(BlendNormals, untouched_elements_keep_their_base_normals_to_the_bit_and_are_not_counted, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const BlendSet set = test::random_blend_set(seed, {.cells = 9, .targets = 6, .reach = 0.4});
  const NormalGroups vertices = test::vertices_of(set);
  const std::vector<double> weights = test::random_weights(seed, 6, 2);
  const std::vector<bool> touched = test::touched_elements(set, &vertices, weights);
  for (const BlendPath path : {BlendPath::kTerms, BlendPath::kTouched}) {
    BlendNormals normals = BlendNormals::of_groups(set, vertices, {kUnlimited, path});
    const Evaluated base = evaluate(normals, std::vector<double>(6)), done = evaluate(normals, weights);
    RC_ASSERT(base.evaluation.touched_elements == 0U && base.evaluation.active_targets == 0U);
    RC_ASSERT(done.evaluation.active_targets == 2U);
    RC_ASSERT(done.evaluation.touched_elements ==
              static_cast<std::size_t>(std::count(touched.begin(), touched.end(), true)));
    for (std::size_t e = 0; e < touched.size(); ++e) RC_ASSERT(touched[e] || base.of(e) == done.of(e));
    RC_ASSERT(evaluate(normals, std::vector<double>(6)).xyz == base.xyz);
  }
}

// ---- memory and its limit -------------------------------------------------------------------------------------------

RC_GTEST_PROP(BlendNormals, cost_is_known_from_counts_and_a_limit_leaves_the_normals_as_they_are, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const BlendSet set = test::random_blend_set(seed, {.cells = 8, .targets = 7, .reach = 0.7});
  const NormalGroups vertices = test::vertices_of(set);
  const BlendCost all = BlendNormals::of_groups(set, vertices).cost();
  RC_ASSERT(all.stored_targets == 7U && all.stored_pairs == all.overlapping_pairs);
  const std::vector<double> weights = test::random_weights(seed, 7, 5);
  const std::vector<exact::Vector> expected = test::exact_normals(set, &vertices, weights);
  for (const double share : {1.0, 0.9, 0.5, 0.2, 0.1, 0.05, 0.0}) {
    const auto limit =
        all.least_bytes + static_cast<std::size_t>(share * static_cast<double>(all.bytes - all.least_bytes));
    const BlendNormalsOptions options{limit, BlendPath::kTerms};
    BlendNormals normals = BlendNormals::of_groups(set, vertices, options);
    const BlendCost cost = normals.cost();
    RC_ASSERT(cost.bytes <= limit);
    RC_ASSERT(2 * cost.stored_pairs <=
              cost.stored_targets * (cost.stored_targets - std::min<std::size_t>(cost.stored_targets, 1)));
    RC_ASSERT(cost.least_bytes == all.least_bytes && cost.pair_elements == all.pair_elements);
    RC_ASSERT(normals.bytes() <= cost.bytes);
    const Evaluated done = evaluate(normals, weights);
    expect_exact(done, expected, "limited");
    if (share == 1) RC_ASSERT(done.evaluation.unstored_elements == 0U && cost == all);
    if (share == 0) {
      RC_ASSERT(cost.stored_targets == 0U && normals.bytes() == all.least_bytes);
      RC_ASSERT(done.evaluation.recomputed_elements == done.evaluation.touched_elements);
    }
    RC_ASSERT(done.evaluation.recomputed_elements >= done.evaluation.unstored_elements);
  }
}

void expect_peak(const BlendSet& set, const NormalGroups& groups, std::size_t max_bytes) {
  const BlendNormalsOptions options{max_bytes, {}};
  const BlendCost cost = BlendNormals::of_groups(set, groups, options).cost();
  BlendSet own_set = set;
  NormalGroups own_groups = groups;
  const test::AllocationCounter counter;
  const BlendNormals normals = BlendNormals::of_groups(std::move(own_set), std::move(own_groups), options);
  const auto peak = static_cast<double>(counter.peak_bytes());
  EXPECT_LE(peak, 1.1 * static_cast<double>(cost.peak_bytes));
  EXPECT_GE(peak, 0.4 * static_cast<double>(cost.peak_bytes)) << "a bound that says nothing";
  EXPECT_LE(static_cast<double>(counter.bytes()), 1.1 * static_cast<double>(cost.bytes));
  EXPECT_LE(normals.bytes(), cost.bytes);
}

// Makes a cone over a polygon with many corners. The polygon itself is a face, so each of its corners has three faces:
// the polygon and two triangles.
BlendSet cone_over(std::size_t corners) {
  BlendSet set;
  std::vector<std::uint32_t> offsets = {0}, of_faces;
  for (std::size_t c = 0; c < corners; ++c) {
    const double angle = 6.283185307179586 * static_cast<double>(c) / static_cast<double>(corners);
    for (const double x : {std::cos(angle), std::sin(angle), 0.1 * std::sin(5 * angle)})
      set.base.push_back(static_cast<float>(x));
    of_faces.push_back(static_cast<std::uint32_t>(corners - 1 - c));
  }
  offsets.push_back(static_cast<std::uint32_t>(corners));
  set.base.insert(set.base.end(), {0, 0, 1});
  for (std::size_t c = 0; c < corners; ++c) {
    for (const std::size_t v : {c, (c + 1) % corners, corners}) of_faces.push_back(static_cast<std::uint32_t>(v));
    offsets.push_back(static_cast<std::uint32_t>(of_faces.size()));
  }
  set.topology = fixtures::make_polygons(corners + 1, std::move(offsets), std::move(of_faces));
  for (const float way : {0.3F, -0.2F}) {
    BlendTarget target;
    for (std::uint32_t v = 0; v <= corners; v += 3) {
      target.vertices.push_back(v);
      target.deltas.insert(target.deltas.end(), {0.1F * way, 0, way * static_cast<float>(v % 7)});
    }
    set.targets.push_back(std::move(target));
  }
  return set;
}

TEST(BlendNormals, large_polygons_take_memory_for_their_corners_and_not_for_each_pair_of_them) {
  for (const std::size_t corners : {64U, 65U, 66U, 3000U}) {
    const BlendSet set = cone_over(corners);
    const NormalGroups vertices = test::vertices_of(set);
    EXPECT_LT(BlendNormals::of_groups(set, vertices, {0, {}}).cost().least_bytes, 2000 + 700 * corners);
    const std::vector<double> weights = {0.7, 0.4};
    for (const NormalGroups* groups : {&vertices, static_cast<const NormalGroups*>(nullptr)}) {
      for (const BlendPath path : kPaths) {
        BlendNormals normals = normals_of(set, groups, {kUnlimited, path});
        expect_exact(evaluate(normals, weights), test::real_normals(set, groups, weights),
                     std::to_string(corners).append(" corners, ").append(test::name_of(path)));
      }
    }
  }
}

TEST(BlendNormals, peak_memory_is_at_most_what_was_predicted) {
  if (!test::AllocationCounter::works()) GTEST_SKIP() << "a sanitizer counts allocations itself";
  for (const double reach : {0.05, 0.3, 3.0}) {
    const BlendSet set = test::random_blend_set(5, {.cells = 60, .targets = 20, .reach = reach});
    const NormalGroups groups = test::vertices_of(set);
    const BlendCost cost = BlendNormals::of_groups(set, groups).cost();
    for (const std::size_t limit : {std::size_t{0}, (cost.least_bytes + cost.bytes) / 2, kUnlimited})
      expect_peak(set, groups, limit);
  }
  const BlendSet cone = cone_over(20000);
  expect_peak(cone, test::vertices_of(cone), 0);
}

TEST(BlendNormals, evaluating_on_one_thread_allocates_nothing) {
  if (!test::AllocationCounter::works()) GTEST_SKIP() << "a sanitizer counts allocations itself";
  const BlendSet set = test::random_blend_set(6, {.targets = 6, .reach = 0.6});
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(set, test::vertices_of(set), {kUnlimited, path});
    const std::vector<double> weights = test::random_weights(1, 6, 6);
    std::vector<float> xyz(3 * normals.size());
    const test::AllocationCounter counter;
    (void)normals.unit_normals(weights, VectorView<float>::packed(xyz.data(), normals.size()));
    EXPECT_EQ(counter.allocations(), 0U);
  }
}

// ---- the choice of a path of computation ----------------------------------------------------------------------------

TEST(BlendNormals, choice_is_a_function_of_set_weights_and_options_and_takes_the_cheapest) {
  const BlendSet set = test::random_blend_set(2, {.cells = 40, .targets = 40, .reach = 0.4});
  const NormalGroups groups = test::vertices_of(set);
  BlendNormals normals = BlendNormals::of_groups(set, groups), again = BlendNormals::of_groups(set, groups);
  std::vector<std::size_t> taken(3);
  for (std::size_t active = 0; active <= 40; ++active) {
    const std::vector<double> weights = test::random_weights(active, 40, active);
    const BlendChoice choice = normals.set_weights(weights), same = again.set_weights(weights);
    const BlendEvaluation done = evaluate(normals, weights, Threads::kAll).evaluation;
    EXPECT_EQ(choice.path, done.path);
    EXPECT_EQ(choice.path, same.path);
    EXPECT_EQ(choice.terms_ns, same.terms_ns);
    EXPECT_EQ(choice.touched_elements, done.touched_elements);
    const double costs[] = {choice.terms_ns, choice.touched_ns, choice.whole_ns};
    EXPECT_EQ(costs[static_cast<int>(choice.path)], *std::min_element(std::begin(costs), std::end(costs)));
    ++taken[static_cast<std::size_t>(choice.path)];
  }
  EXPECT_GT(taken[0], 0U);
  EXPECT_GT(taken[1] + taken[2], 0U) << "all targets at once";
  EXPECT_EQ(normals.set_weights(test::random_weights(1, 40, 1)).path, BlendPath::kTerms);
}

// ---- threads, layouts ----------------------------------------------------------------------

TEST(BlendNormals, any_number_of_threads_gives_the_same_bits) {
  const BlendSet set = test::random_blend_set(7, {.cells = 150, .targets = 10, .reach = 0.6});
  const NormalGroups groups = test::vertices_of(set);
  ASSERT_GT(groups.size(), 16384U) << "more than a block";
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(set, groups, {kUnlimited, path});
    for (const std::size_t active : {0U, 1U, 4U, 10U}) {
      const std::vector<double> weights = test::random_weights(active, 10, active);
      const Evaluated one = evaluate(normals, weights);
      EXPECT_EQ(one.evaluation.active_targets, active);
      for (const std::size_t threads : {1U, 2U, 3U, 16U}) {
        const ThreadLimit limit(threads);
        const Evaluated all = evaluate(normals, weights, Threads::kAll);
        EXPECT_EQ(all.xyz, one.xyz);
        EXPECT_EQ(all.evaluation.zeros, one.evaluation.zeros);
        EXPECT_EQ(all.evaluation.recomputed_elements, one.evaluation.recomputed_elements);
      }
    }
  }
}

TEST(BlendNormals, planes_have_the_bits_of_packed_results) {
  const BlendSet set = test::random_blend_set(7, {.targets = 3, .reach = 0.6});
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(set, test::vertices_of(set), {kUnlimited, path});
    const std::vector<double> weights = {0.5, -1, 2};
    const Evaluated packed = evaluate(normals, weights);
    std::vector<float> planes(3 * normals.size());
    float* const x = planes.data();
    const auto view = VectorView<float>::planes(x, x + normals.size(), x + 2 * normals.size(), normals.size());
    (void)normals.unit_normals(weights, view);
    for (std::size_t e = 0; e < normals.size(); ++e)
      ASSERT_EQ(packed.of(e), (std::vector<float>{view[e].x, view[e].y, view[e].z}));
  }
}

// The number of elements is not a multiple of the number of lanes, and the faces are triangles and larger polygons.
TEST(BlendNormals, every_instruction_set_gives_the_same_bits) {
  for (const std::size_t cells : {1U, 2U, 5U, 12U}) {
    const BlendSet set = test::random_blend_set(cells, {.cells = cells, .targets = 6, .reach = 0.7});
    const NormalGroups vertices = test::vertices_of(set);
    const std::vector<double> weights = test::random_weights(cells, 6, 4);
    for (const NormalGroups* groups : {&vertices, static_cast<const NormalGroups*>(nullptr)}) {
      for (const BlendPath path : kPaths) {
        BlendNormals normals = normals_of(set, groups, {kUnlimited, path});
        const std::vector<float> expected = evaluate(normals, weights).xyz;
        for (const std::int64_t target : supported_targets()) {
          const ScopedTarget scope(target);
          EXPECT_EQ(evaluate(normals, weights).xyz, expected) << target_name(target) << ", " << test::name_of(path);
        }
      }
    }
  }
}

TEST(BlendNormals, sets_without_anything_are_evaluated_all_the_same) {
  BlendNormals nothing = BlendNormals::of_faces(BlendSet{});
  EXPECT_EQ(nothing.size(), 0U);
  EXPECT_EQ(evaluate(nothing, {}).evaluation.zeros, 0U);
  BlendSet isolated;
  isolated.topology = fixtures::make_triangles(3, {});
  isolated.base = {0, 0, 0, 1, 1, 1, 2, 2, 2};
  isolated.targets = {{"", {1}, {1, 0, 0}}};
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(isolated, test::vertices_of(isolated), {kUnlimited, path});
    const Evaluated done = evaluate(normals, std::vector{1.0});
    EXPECT_EQ(done.xyz, std::vector<float>(9));
    EXPECT_EQ(done.evaluation.zeros, 3U);
    EXPECT_EQ(done.evaluation.touched_elements, 0U);
  }
}

TEST(BlendNormals, moved_objects_go_on) {
  const BlendSet set = test::random_blend_set(7);
  BlendNormals first = BlendNormals::of_groups(set, test::vertices_of(set));
  const std::vector<double> weights = test::random_weights(1, 5, 3);
  const std::vector<float> before = evaluate(first, weights).xyz;
  BlendNormals second = std::move(first);
  EXPECT_EQ(evaluate(second, weights).xyz, before);
  first = std::move(second);
  EXPECT_EQ(evaluate(first, weights).xyz, before);
}

// ---- files from other projects --------------------------------------------------------------------------------------

namespace fs = std::filesystem;

class RealBlendNormals : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    data_ = folder;
  }

  [[nodiscard]] BlendSet face() const {
    const fs::path folder = fs::path(data_) / "face_mpfb2";
    return blend_set_of(
               test::read_motion(test::targets_over((folder / "base.obj").string(), {(folder / "targets").string()}))
                   .value())
        .value();
  }

  void expect_all_paths(const BlendSet& set, const NormalGroups* groups, std::size_t active, std::uint64_t seed) const {
    const std::vector<double> weights = test::random_weights(seed, set.targets.size(), active);
    const auto expected = test::real_normals(set, groups, weights);
    for (const BlendPath path : kPaths) {
      BlendNormals normals = normals_of(set, groups, {kUnlimited, path});
      const Evaluated done = evaluate(normals, weights);
      expect_exact(done, expected, std::to_string(active).append(" active, ").append(test::name_of(path)));
    }
  }

  std::string data_;
};

TEST_F(RealBlendNormals, face_equals_blended_positions_for_1_2_8_and_all_102_targets) {
  const BlendSet set = face();
  ASSERT_EQ(set.targets.size(), 102U);
  const NormalGroups vertices = test::vertices_of(set);
  for (const BlendPath path : kPaths) {
    BlendNormals normals = BlendNormals::of_groups(set, vertices, {kUnlimited, path});
    BlendNormals faces = BlendNormals::of_faces(set, {kUnlimited, path});
    for (const std::size_t active : {1U, 2U, 8U, 102U}) {
      for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const std::vector<double> weights = test::random_weights(10 * active + seed, 102, active);
        const std::string what = std::to_string(active).append(" active, ").append(test::name_of(path));
        expect_exact(evaluate(normals, weights), test::real_normals(set, &vertices, weights), what);
        expect_exact(evaluate(faces, weights), test::real_normals(set, nullptr, weights), what + ", faces");
      }
    }
  }
}

TEST_F(RealBlendNormals, float32_carries_most_touched_vertices_of_the_face) {
  BlendNormals normals = BlendNormals::of_groups(face(), test::vertices_of(face()), {kUnlimited, BlendPath::kTerms});
  const auto share = [&](std::size_t active) {
    std::size_t touched = 0, recomputed = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const BlendEvaluation done = evaluate(normals, test::random_weights(seed, 102, active)).evaluation;
      touched += done.touched_elements;
      recomputed += done.recomputed_elements;
    }
    return static_cast<double>(recomputed) / static_cast<double>(touched);
  };
  EXPECT_LT(share(2), 0.001);
  EXPECT_LT(share(8), 0.005);
  EXPECT_LT(share(102), 0.1);
}

TEST_F(RealBlendNormals, face_stays_below_its_predicted_memory) {
  if (!test::AllocationCounter::works()) GTEST_SKIP() << "a sanitizer counts allocations itself";
  const BlendSet set = face();
  const NormalGroups vertices = test::vertices_of(set);
  for (const std::size_t limit : {std::size_t{0}, std::size_t{8} << 20, kUnlimited}) expect_peak(set, vertices, limit);
}

TEST_F(RealBlendNormals, morph_targets_of_gltf_files_equal_blended_positions) {
  for (const char* const name :
       {"MorphStressTest/glTF/MorphStressTest.gltf", "AnimatedMorphSphere/glTF/AnimatedMorphSphere.gltf",
        "MorphPrimitivesTest/glTF/MorphPrimitivesTest.gltf"}) {
    const Result<GltfDocument> document = GltfDocument::open((fs::path(data_) / "gltf" / name).string());
    ASSERT_TRUE(document.ok()) << document.error().text();
    const Motion motion = read_gltf_motion(document.value(), {}).value().motion;
    const BlendSet set = blend_set_of(motion).value();
    const NormalGroups groups = NormalGroups::of_vertices(set.topology, weld_coincident(motion));
    for (std::size_t active = 1; active <= set.targets.size(); ++active) {
      expect_all_paths(set, &groups, active, active);
      expect_all_paths(set, nullptr, active, active);
    }
  }
}

}  // namespace
}  // namespace chronormal::blend_normals_test
