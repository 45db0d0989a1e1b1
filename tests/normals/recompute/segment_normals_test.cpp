// Which way to normals is chosen, that it says so, and that both lead to the same normals.

#include "chronormal/normals/segment_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "normals/groups/rings.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/elements.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"

namespace chronormal::segment_normals_test {
namespace {

using Normals = std::vector<Vec3f>;

Normals evaluate(SegmentNormals& normals, double t, Threads threads = Threads::kOne) {
  std::vector<float> packed(3 * normals.size(), 7.0f);
  const auto view = VectorView<float>::packed(packed.data(), normals.size());
  (void)normals.unit_normals(t, view, threads);
  Normals result;
  for (std::size_t i = 0; i < view.count; ++i) result.push_back(view[i]);
  return result;
}

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

// Faces or vertices of a closed mesh in grid order, of degree 2.
MeshShape shape(std::size_t faces, bool vertices, double lines = 0.25) {
  MeshShape result;
  result.faces = faces;
  result.vertices = faces / 2;
  result.elements = vertices ? result.vertices : faces;
  result.faces_per_element = vertices ? 6 : 0;
  result.lines_per_face = lines;
  return result;
}

NormalStrategy chosen(const MeshShape& shape, double evaluations, double tolerance = kExactTolerance) {
  return choose_strategy(shape, {.evaluations = evaluations, .tolerance = tolerance}).strategy;
}

TEST(SegmentNormals, both_strategies_are_within_the_promise_of_exact_arithmetic) {
  const Motion motion = fixtures::smooth_morph(8);
  const Segment segment = motion.segment(0);
  const NormalGroups groups = vertices_of(motion);
  for (const NormalStrategy strategy : {NormalStrategy::kPolynomial, NormalStrategy::kRecompute}) {
    SegmentNormals faces(segment, {.forced = strategy}), vertices(segment, groups, {.forced = strategy});
    for (const double t : {0.0, 0.37, 1.0}) {
      const Normals of_faces = evaluate(faces, t), of_vertices = evaluate(vertices, t);
      ASSERT_EQ(of_faces.size(), 128u);
      ASSERT_EQ(of_vertices.size(), 81u);
      for (std::uint32_t f = 0; f < of_faces.size(); ++f) {
        const Vec3f u = of_faces[f];
        EXPECT_LE(exact::angle(u.x, u.y, u.z, exact::sum_of_faces_at(segment, std::span(&f, 1), t)), 1e-6)
            << name_of(strategy);
      }
      for (std::size_t v = 0; v < of_vertices.size(); ++v) {
        const Vec3f u = of_vertices[v];
        EXPECT_LE(exact::angle(u.x, u.y, u.z, exact::sum_of_faces_at(segment, groups.faces(v), t)), 1e-6)
            << name_of(strategy);
      }
    }
  }
}

TEST(SegmentNormals, the_choice_is_what_runs) {
  const Motion motion = fixtures::smooth_morph(8);
  const Segment segment = motion.segment(0);
  SegmentNormals once(segment), often(segment, {.evaluations = 1000});
  EXPECT_EQ(once.choice().strategy, NormalStrategy::kRecompute);
  EXPECT_EQ(often.choice().strategy, NormalStrategy::kPolynomial);
  EXPECT_EQ(once.bytes(), 0u);
  EXPECT_EQ(often.bytes(), NormalCurves::of_faces(segment).bytes());

  NormalRecompute recompute(segment);
  const NormalCurves curves = NormalCurves::of_faces(segment);
  std::vector<float> packed(3 * 128);
  const auto view = VectorView<float>::packed(packed.data(), 128);
  const auto values = [&view] {
    Normals result;
    for (std::size_t i = 0; i < view.count; ++i) result.push_back(view[i]);
    return result;
  };
  recompute.unit_normals(0.3, view);
  EXPECT_EQ(evaluate(once, 0.3), values());
  EXPECT_EQ(evaluate(once, 0.3, Threads::kAll), values());
  (void)curves.unit_normals(0.3, view);
  EXPECT_EQ(evaluate(often, 0.3), values());
}

TEST(SegmentNormals, normals_in_float32_are_made_by_whoever_was_given) {
  const Motion motion = fixtures::smooth_morph(8);
  const Segment segment = motion.segment(0);
  const NormalGroups groups = vertices_of(motion);
  FloatRecompute faces(motion.topology), vertices(motion.topology, groups);
  SegmentNormals of_faces(segment, {.float_recompute = &faces}),
      of_vertices(segment, groups, {.float_recompute = &vertices});
  for (auto* const each : {&of_faces, &of_vertices}) {
    FloatRecompute& recompute = each == &of_faces ? faces : vertices;
    EXPECT_EQ(each->choice().strategy, NormalStrategy::kRecompute);
    EXPECT_EQ(each->choice().reason.rfind("recompute in float32: ", 0), 0U) << each->choice().reason;
    EXPECT_EQ(each->size(), recompute.size());
    EXPECT_EQ(each->bytes(), recompute.bytes());
    std::vector<float> packed(3 * recompute.size());
    (void)recompute.unit_normals(segment, 0.3, VectorView<float>::packed(packed));
    const Normals normals = evaluate(*each, 0.3);
    for (std::size_t i = 0; i < normals.size(); ++i)
      EXPECT_EQ(normals[i], (Vec3f{packed[3 * i], packed[3 * i + 1], packed[3 * i + 2]}));
  }
  SegmentNormals often(segment, {.evaluations = 1000, .float_recompute = &faces});
  EXPECT_EQ(often.choice().strategy, NormalStrategy::kPolynomial);
  EXPECT_NE(often.choice().reason.find("by recompute in float32"), std::string::npos) << often.choice().reason;
}

TEST(Strategy, curves_pay_later_against_float32) {
  for (const std::size_t faces : {std::size_t{15'000}, std::size_t{1'000'000}, std::size_t{10'000'000}}) {
    for (const bool vertices : {false, true}) {
      const StrategyCosts costs = model_costs(shape(faces, vertices), kExactTolerance);
      EXPECT_GT(costs.break_even_in_float32(), costs.break_even());
      EXPECT_GT(costs.in_float32, costs.evaluate);
    }
  }
}

TEST(MeshShape, what_nearly_collapses_is_seen_and_costs) {
  const Motion smooth = fixtures::smooth_morph(60), collapsing = fixtures::collapsing_soup(1e-6, 3000);
  const MeshShape good = shape_of(smooth.segment(0)), bad = shape_of(collapsing.segment(0));
  EXPECT_LT(good.doubtful, 0.05);
  EXPECT_EQ(good.flagged, 0);
  EXPECT_GT(bad.doubtful, 0.9);
  const NormalCurves curves = NormalCurves::of_faces(collapsing.segment(0));
  EXPECT_NEAR(bad.flagged, static_cast<double>(curves.flagged_count()) / 3000, 0.2);
  EXPECT_GT(model_costs(bad, kExactTolerance).prepare, 2.5 * model_costs(good, kExactTolerance).prepare);
  EXPECT_GT(shape_of(collapsing.segment(0), vertices_of(collapsing)).doubtful, 0.9);
}

TEST(MeshShape, thin_triangles_are_known_to_need_double) {
  const Motion smooth = fixtures::smooth_morph(60);
  Motion thin = smooth;
  for (Motion::Keyframe& keyframe : thin.keyframes)
    for (std::size_t i = 0; i < keyframe.positions.size(); i += 3) keyframe.positions[i] *= 30;
  const auto shape_by = [](const Motion& motion, bool vertices) {
    return vertices ? shape_of(motion.segment(0), vertices_of(motion)) : shape_of(motion.segment(0));
  };
  for (const bool vertices : {false, true}) {
    const MeshShape good = shape_by(smooth, vertices), bad = shape_by(thin, vertices);
    EXPECT_EQ(good.in_float32, 1) << vertices;
    EXPECT_LT(bad.in_float32, 0.3) << vertices;
    EXPECT_EQ(bad.doubtful, 0) << vertices;
    EXPECT_GT(model_costs(bad, kCompactTolerance).prepare, 1.3 * model_costs(good, kCompactTolerance).prepare);
    EXPECT_EQ(model_costs(bad, kExactTolerance).prepare, model_costs(good, kExactTolerance).prepare);
    // They are recomputed in double, too.
    EXPECT_EQ(good.thin, 0) << vertices;
    EXPECT_GT(bad.thin, 0.8) << vertices;
    EXPECT_GT(model_costs(bad, kExactTolerance).recompute, 1.7 * model_costs(good, kExactTolerance).recompute);
  }
}

TEST(MeshShape, what_is_kept_in_double_costs_more_each_time) {
  const Motion collapsing = fixtures::collapsing_soup(1e-6, 3000);
  MeshShape mesh = shape_of(collapsing.segment(0));
  const double flagged = mesh.flagged;
  ASSERT_GT(flagged, 0.5);
  const double with = model_costs(mesh, kExactTolerance).evaluate;
  mesh.flagged = 0;
  EXPECT_GT(with - model_costs(mesh, kExactTolerance).evaluate, 0.5 * flagged);
}

TEST(MeshShape, is_measured_without_the_paths_around_all_vertices) {
  if (!test::AllocationCounter::works()) GTEST_SKIP() << "the sanitizer counts allocations by itself";
  const Motion motion = fixtures::smooth_morph(60);
  const NormalGroups groups = vertices_of(motion);
  const test::AllocationCounter counter;
  (void)shape_of(motion.segment(0), groups);
  EXPECT_LT(counter.peak_bytes(), std::size_t{1} << 16);
  (void)rings_around(motion.topology, groups);
  EXPECT_GT(counter.peak_bytes(), 4 * groups.size()) << "the paths were made before";
}

TEST(SegmentNormals, a_looser_tolerance_keeps_fewer_bytes) {
  const Motion motion = fixtures::smooth_morph(16);
  const StrategyOptions exact{.evaluations = 100}, compact{.evaluations = 100, .tolerance = kCompactTolerance};
  EXPECT_LT(SegmentNormals(motion.segment(0), compact).bytes(), SegmentNormals(motion.segment(0), exact).bytes());
}

TEST(SegmentNormals, nothing_is_no_trouble) {
  const Motion empty = fixtures::make_motion(fixtures::make_triangles(0, {}), {}, {});
  for (const double evaluations : {1.0, 1000.0}) {
    SegmentNormals normals(empty.segment(0), {.evaluations = evaluations});
    EXPECT_EQ(normals.size(), 0u);
    EXPECT_EQ(normals.unit_normals(0.5, {}), 0u);
    EXPECT_FALSE(normals.choice().reason.empty());
  }
}

TEST(Strategy, one_evaluation_is_recomputed_and_many_are_not) {
  for (const std::size_t faces :
       {std::size_t{20}, std::size_t{15'000}, std::size_t{1'000'000}, std::size_t{10'000'000}}) {
    for (const bool vertices : {false, true}) {
      for (const double lines : {0.25, 3.0}) {
        EXPECT_EQ(chosen(shape(faces, vertices, lines), 1), NormalStrategy::kRecompute) << faces;
        EXPECT_EQ(chosen(shape(faces, vertices, lines), 30), NormalStrategy::kPolynomial) << faces;
      }
    }
  }
}

TEST(Strategy, break_even_is_where_the_choice_changes) {
  for (const bool vertices : {false, true}) {
    const MeshShape mesh = shape(1'000'000, vertices);
    const double even = model_costs(mesh, kExactTolerance).break_even();
    EXPECT_GT(even, 1);
    EXPECT_LT(even, 10);
    EXPECT_EQ(chosen(mesh, 0.99 * even), NormalStrategy::kRecompute);
    EXPECT_EQ(chosen(mesh, 1.01 * even), NormalStrategy::kPolynomial);
    EXPECT_LT(model_costs(mesh, kCompactTolerance).break_even(), even);
  }
}

TEST(Strategy, costs_grow_with_disorder_and_distance) {
  const auto cost = [](std::size_t faces, bool vertices, double lines) {
    return model_costs(shape(faces, vertices, lines), kExactTolerance);
  };
  for (const bool vertices : {false, true}) {
    EXPECT_LT(cost(10'000'000, vertices, 0.25).recompute, cost(10'000'000, vertices, 3).recompute / 3);
    EXPECT_LT(cost(1'000'000, vertices, 3).recompute, cost(10'000'000, vertices, 3).recompute);
    EXPECT_LE(cost(15'000, vertices, 0.25).recompute, cost(1'000'000, vertices, 0.25).recompute);
    // Curves do not mind the order of the mesh once they are prepared.
    EXPECT_EQ(cost(10'000'000, vertices, 0.25).evaluate, cost(10'000'000, vertices, 3).evaluate);
  }
}

TEST(Strategy, evaluating_costs_more_the_further_away_curves_are_and_never_jumps) {
  double before = 0;
  for (double size = 1000; size < 1e8; size *= 1.1) {
    const double evaluate = model_costs(shape(static_cast<std::size_t>(size), false), kExactTolerance).evaluate;
    EXPECT_GE(evaluate, before) << size;
    if (before > 0) {
      EXPECT_LT(evaluate, 1.1 * before) << size;
    }
    before = evaluate;
  }
  EXPECT_GT(before, 3 * model_costs(shape(1000, false), kExactTolerance).evaluate);
}

TEST(Strategy, curves_of_low_degree_are_modelled_smaller_and_cheaper) {
  MeshShape mesh = shape(1'000'000, false);
  double bytes = 0, evaluate = 0;
  for (const double degree : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    mesh.degree = degree;
    const StrategyCosts costs = model_costs(mesh, kExactTolerance);
    EXPECT_GT(costs.curve_bytes, bytes);
    EXPECT_GT(costs.evaluate, evaluate);
    bytes = costs.curve_bytes;
    evaluate = costs.evaluate;
  }
  EXPECT_EQ(bytes, 36e6);
}

TEST(Strategy, new_memory_is_part_of_what_preparing_costs) {
  // Curves of degree 0, 1 and 2 keep 16, 24 and 36 bytes, and preparing them differs in nothing else.
  MeshShape mesh = shape(1'000'000, false);
  const auto prepare = [&](double degree) {
    mesh.degree = degree;
    return model_costs(mesh, kExactTolerance).prepare;
  };
  const double of_a_byte = (prepare(2) - prepare(0)) / 20;
  EXPECT_NEAR(prepare(1) - prepare(0), 8 * of_a_byte, 1e-9);
  // To clear memory takes a core from 0.01 to 0.1 ns a byte.
  EXPECT_GT(of_a_byte, 0.01);
  EXPECT_LT(of_a_byte, 0.1);
}

TEST(Strategy, what_is_forced_is_done_and_said) {
  for (const NormalStrategy strategy : {NormalStrategy::kPolynomial, NormalStrategy::kRecompute}) {
    const StrategyChoice choice = choose_strategy(shape(1000, false), {.evaluations = 5, .forced = strategy});
    EXPECT_EQ(choice.strategy, strategy);
    EXPECT_NE(choice.reason.find("asked for"), std::string::npos);
  }
}

TEST(Strategy, the_reason_names_the_winner_and_both_costs) {
  const StrategyChoice once = choose_strategy(shape(1'000'000, false), {});
  EXPECT_EQ(once.reason.rfind("recompute: ", 0), 0u) << once.reason;
  EXPECT_NE(once.reason.find("for 1 evaluation,"), std::string::npos) << once.reason;
  EXPECT_NE(once.reason.find("by polynomial"), std::string::npos) << once.reason;
  EXPECT_NE(once.reason.find("even at"), std::string::npos) << once.reason;
  const StrategyChoice often = choose_strategy(shape(1'000'000, true), {.evaluations = 60});
  EXPECT_EQ(often.reason.rfind("polynomial: ", 0), 0u) << often.reason;
  EXPECT_NE(often.reason.find("60 evaluations"), std::string::npos) << often.reason;
  EXPECT_LT(often.polynomial_cost, often.recompute_cost);
}

TEST(Strategy, any_number_of_evaluations_is_taken) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const MeshShape mesh = shape(1'000'000, false);
  for (const double few : {-1.0, 0.0, 0.5, std::nan(""), -kInfinity}) {
    EXPECT_EQ(chosen(mesh, few), NormalStrategy::kRecompute);
    EXPECT_EQ(choose_strategy(mesh, {.evaluations = few}).recompute_cost, choose_strategy(mesh, {}).recompute_cost);
  }
  EXPECT_EQ(chosen(mesh, kInfinity), NormalStrategy::kPolynomial);
}

TEST(MeshShape, order_and_degree_are_seen) {
  const Motion smooth = fixtures::smooth_morph(100);
  const Segment segment = smooth.segment(0);
  const MeshShape ordered = shape_of(segment);
  EXPECT_EQ(ordered.elements, 20000u);
  EXPECT_EQ(ordered.vertices, 10201u);
  EXPECT_EQ(ordered.triangles_per_face, 1);
  EXPECT_EQ(ordered.faces_per_element, 0);
  EXPECT_LT(ordered.lines_per_face, 0.5);
  EXPECT_EQ(ordered.degree, 2);

  const Motion shuffled = test::with_faces_in_order(smooth, test::shuffled_order(20000, 1));
  EXPECT_GT(shape_of(shuffled.segment(0)).lines_per_face, 1.5);
  EXPECT_NEAR(shape_of(segment, vertices_of(smooth)).faces_per_element, 5.9, 0.05);

  Motion still = smooth;
  still.keyframes[1].positions = still.keyframes[0].positions;
  EXPECT_EQ(shape_of(still.segment(0)).degree, 0);
  const Motion quads = fixtures::make_motion(fixtures::make_polygons(4, {0, 4}, {0, 1, 2, 3}),
                                             std::vector<fixtures::Point>(4), std::vector<fixtures::Point>(4));
  EXPECT_EQ(shape_of(quads.segment(0)).triangles_per_face, 2);
  EXPECT_EQ(shape_of(quads.segment(0)).degree, 0);
}

}  // namespace
}  // namespace chronormal::segment_normals_test
