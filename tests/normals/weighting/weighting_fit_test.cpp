// Tests the quadratic curves that approximate weighted normals. The stated bound must never be below the error of the
// curve, and must not be far above this error.

#include "chronormal/normals/weighting.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference_elements.h"

namespace chronormal::weighting_fit_test {
namespace {

using fixtures::Point;
using reference::Real;

// Makes a closed fan of `count` triangles around vertex 0. Each coordinate of each vertex moves by up to `distance`, so
// normals at different times may have any angle between them.
Motion fan(std::size_t count, double distance, fixtures::Random& random) {
  std::vector<Point> from = {random.in_cube(0.3)}, to;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle =
        6.283185307179586 * (static_cast<double>(i) + random.uniform(-0.3, 0.3)) / static_cast<double>(count);
    const double radius = random.uniform(0.4, 1.5);
    from.push_back({radius * std::cos(angle), radius * std::sin(angle), random.uniform(-0.4, 0.4)});
    corners.insert(corners.end(),
                   {0, static_cast<std::uint32_t>(1 + i), static_cast<std::uint32_t>(1 + (i + 1) % count)});
  }
  for (const Point& p : from) {
    const Point step = random.in_cube(distance);
    to.push_back({p[0] + step[0], p[1] + step[1], p[2] + step[2]});
  }
  return fixtures::make_motion(fixtures::make_triangles(from.size(), corners), from, to);
}

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

// Returns the largest angle, in radians, between the fitted curve and the weighted normal by its definition, at
// equidistant times.
double sampled_error(const reference::Mesh& mesh, const std::vector<reference::Corner>& corners,
                     const std::string& weighting, const ControlNormals& fit, std::size_t samples) {
  double worst = 0;
  for (std::size_t i = 0; i <= samples; ++i) {
    const Real t = static_cast<Real>(i) / static_cast<Real>(samples), s = 1 - t;
    const auto truth = reference::element_normal(mesh, corners, weighting, t);
    const auto q = reference::add(reference::add(reference::scaled(s * s, test::to_real(fit.n0)),
                                                 reference::scaled(2 * s * t, test::to_real(fit.m))),
                                  reference::scaled(t * t, test::to_real(fit.n1)));
    if (!(reference::length(truth) > 0) || !(reference::length(q) > 0)) continue;
    worst = std::max(worst, static_cast<double>(reference::angle(q, truth)));
  }
  return worst;
}

struct Summary {
  std::size_t elements = 0, certified = 0, loose = 0;
  double largest_ratio = 0;
};

// Compares the stated bounds of the fitted curves of all elements with the errors of these curves at equidistant times.
Summary check_bounds(const Motion& motion, Weighting weighting, std::size_t samples, std::size_t elements = 1) {
  const reference::Mesh mesh = test::reference_mesh(motion.segment(0));
  const NormalGroups groups = vertices_of(motion);
  const auto corners = test::reference_corners(mesh, groups);
  const WeightingFit fit = fit_weighting(motion.segment(0), groups, weighting);
  Summary summary;
  for (std::size_t e = 0; e < std::min(elements, groups.size()); ++e) {
    const double error =
        sampled_error(mesh, corners[e], std::string(weighting_name(weighting)), fit.normals[e], samples);
    // If an element has a single triangle, the direction of its fitted curve is exact and the bound is 0. The bound
    // does not include the rounding of the last bits.
    const double rounding = fit.bounds[e] == 0 ? 1e-12 : 0;
    EXPECT_LE(error, fit.bounds[e] + rounding) << weighting_name(weighting) << ", element " << e;
    EXPECT_LE(fit.bounds[e], std::numbers::pi);
    ++summary.elements;
    if (fit.bounds[e] >= std::numbers::pi) continue;
    ++summary.certified;
    if (error > 1e-9) {
      summary.largest_ratio = std::max(summary.largest_ratio, fit.bounds[e] / error);
      if (fit.bounds[e] > 3 * error) ++summary.loose;
    }
  }
  return summary;
}

constexpr std::array<Weighting, 6> kFitted = {Weighting::kAngle, Weighting::kUniform,      Weighting::kAreaAngle,
                                              Weighting::kMax,   Weighting::kInverseEdges, Weighting::kInverseRoots};

// ---- the bound of the error -----------------------------------------------------------------------------------------

TEST(WeightingFit, the_bound_is_never_below_the_error_of_random_fans) {
  fixtures::Random random(2024);
  for (const Weighting weighting : kFitted) {
    for (const double distance : {0.01, 0.1, 0.3, 1.0, 3.0}) {
      Summary all;
      for (int round = 0; round < 150; ++round) {
        const Summary one = check_bounds(fan(3 + random.below(6), distance, random), weighting, 120);
        all.certified += one.certified;
        all.loose += one.loose;
      }
      SCOPED_TRACE(std::string(weighting_name(weighting)) + ", motion " + std::to_string(distance));
      EXPECT_LE(all.loose, distance < 0.2 ? 0u : 4u) << "more than three times the error";
      EXPECT_GE(all.certified, distance < 0.05 ? 150u : distance < 0.5 ? 143u : 105u);
    }
  }
}

RC_GTEST_PROP(WeightingFit, the_bound_is_never_below_the_error_of_polygons, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const double distance = *rc::gen::element(0.02, 0.2, 1.0);
  const Motion motion = fixtures::shaken(fixtures::box_grid(2), distance, seed);
  const Weighting weighting = *rc::gen::elementOf(kFitted);
  const Summary summary = check_bounds(motion, weighting, 100, 26);
  RC_ASSERT(summary.elements == 26);
  if (distance < 0.1) RC_ASSERT(summary.certified == 26 && summary.loose == 0);
}

TEST(WeightingFit, the_bound_is_never_below_the_error_where_faces_nearly_collapse) {
  // Two triangles share an edge, and one of these triangles nearly collapses.
  fixtures::Random random(77);
  for (const double gap : {1e-1, 1e-3, 1e-6}) {
    const Motion lone = fixtures::collapsing_soup(gap, 40, 5);
    for (std::size_t f = 0; f < 40; ++f) {
      std::vector<Point> from, to;
      for (std::size_t i = 0; i < 3; ++i) {
        const float* const p = lone.keyframes[0].positions.data() + 9 * f + 3 * i;
        const float* const q = lone.keyframes[1].positions.data() + 9 * f + 3 * i;
        from.push_back({p[0], p[1], p[2]});
        to.push_back({q[0], q[1], q[2]});
      }
      from.push_back(random.in_cube(1));
      to.push_back(random.in_cube(1));
      const Motion motion = fixtures::make_motion(fixtures::make_triangles(4, {0, 1, 2, 2, 1, 3}), from, to);
      for (const Weighting weighting : kFitted) (void)check_bounds(motion, weighting, 400, 4);
    }
  }
}

TEST(WeightingFit, the_bound_does_not_depend_on_the_size) {
  fixtures::Random random(3);
  const Motion motion = fan(5, 0.2, random);
  for (const Weighting weighting : kFitted) {
    const double bound = fit_weighting(motion.segment(0), vertices_of(motion), weighting).bounds[0];
    for (const int exponent : {-120, -60, 60, 115}) {
      const double s = std::ldexp(1.0, exponent);
      const Motion other = test::with_positions(motion, [s](const Point& p) {
        return Point{s * p[0], s * p[1], s * p[2]};
      });
      EXPECT_NEAR(fit_weighting(other.segment(0), vertices_of(other), weighting).bounds[0], bound, 1e-5 * bound);
    }
  }
}

// ---- the fitted quadratic curve -------------------------------------------------------------------------------------

TEST(WeightingFit, meets_the_weighted_direction_and_the_area_at_both_ends_and_in_the_middle) {
  const Motion motion = fixtures::shaken(fixtures::box_grid(3), 0.3, 8);
  const NormalGroups groups = vertices_of(motion);
  for (const Weighting weighting : kFitted) {
    const WeightingFit fit = fit_weighting(motion.segment(0), groups, weighting);
    for (const double t : {0.0, 0.5, 1.0}) {
      const auto truth = all_weighted_normals_at(motion.segment(0), groups, weighting, t);
      for (std::size_t e = 0; e < groups.size(); ++e)
        EXPECT_LT(angle_between(normal_at(fit.normals[e], t), truth[e]), 1e-12);
    }
  }
  // By every weighting, the normal of a vertex with a single face has the direction of the normal of this face, and the
  // same length as with area weights.
  const Motion lone = fixtures::moderate_soup(50);
  const auto exact = all_group_control_normals(lone.segment(0), vertices_of(lone));
  for (const Weighting weighting : kFitted) {
    const WeightingFit fit = fit_weighting(lone.segment(0), vertices_of(lone), weighting);
    for (std::size_t e = 0; e < exact.size(); ++e) {
      const double size = std::max({max_abs(exact[e].n0), max_abs(exact[e].m), max_abs(exact[e].n1)});
      EXPECT_LE(max_abs(fit.normals[e].m - exact[e].m), 1e-13 * size);
    }
  }
}

TEST(WeightingFit, is_played_within_its_bound) {
  const Motion motion = fixtures::smooth_morph(8);
  const NormalGroups groups = vertices_of(motion);
  for (const Weighting weighting : kFitted) {
    const WeightingFit fit = fit_weighting(motion.segment(0), groups, weighting);
    const NormalCurves curves(fit.normals);
    std::vector<float> packed(3 * groups.size());
    const auto found = VectorView<float>::packed(packed.data(), groups.size());
    for (const double t : {0.1, 0.35, 0.8}) {
      EXPECT_EQ(curves.unit_normals(t, found), 0u);
      const auto truth = all_weighted_normals_at(motion.segment(0), groups, weighting, t);
      for (std::size_t e = 0; e < groups.size(); ++e) {
        EXPECT_LE(angle_between(to_double(found[e]), truth[e]), fit.bounds[e] + 1e-6);
        EXPECT_LT(fit.bounds[e], 0.6);
      }
    }
  }
}

TEST(WeightingFit, area_is_exact) {
  const Motion motion = fixtures::shaken(fixtures::icosphere(1), 0.5, 2);
  const NormalGroups groups = vertices_of(motion);
  const WeightingFit fit = fit_weighting(motion.segment(0), groups, Weighting::kArea);
  EXPECT_EQ(fit.normals, all_group_control_normals(motion.segment(0), groups));
  EXPECT_EQ(fit.bounds, std::vector<double>(groups.size(), 0.0));
}

TEST(WeightingFit, of_a_mesh_that_stands_still_or_moves_as_a_whole_is_constant) {
  Motion motion = test::still(fixtures::icosphere(1).topology, fixtures::icosphere(1).points);
  for (std::size_t i = 0; i < motion.keyframes[0].positions.size(); ++i) {
    float& p = motion.keyframes[0].positions[i];
    p = std::nearbyint(p * 1024) / 1024;
    motion.keyframes[1].positions[i] = p + 2;
  }
  for (const Weighting weighting : kFitted) {
    const WeightingFit fit = fit_weighting(motion.segment(0), vertices_of(motion), weighting);
    for (std::size_t e = 0; e < fit.bounds.size(); ++e) {
      EXPECT_EQ(degree(fit.normals[e]), 0);
      EXPECT_LT(fit.bounds[e], 1e-12);
    }
  }
}

TEST(WeightingFit, shuffled_faces_give_the_same_bits) {
  const Motion motion = fixtures::shaken(fixtures::box_grid(2), 0.4, 21);
  const Motion shuffled = test::with_faces_in_order(motion, test::shuffled_order(motion.topology.face_count(), 4));
  for (const Weighting weighting : kFitted) {
    const WeightingFit a = fit_weighting(motion.segment(0), vertices_of(motion), weighting);
    const WeightingFit b = fit_weighting(shuffled.segment(0), vertices_of(shuffled), weighting);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.bounds, b.bounds);
  }
}

// ---- elements without a bound --------------------------------------------------------------------------------------

TEST(WeightingFit, the_bound_is_pi_where_a_face_turns_inside_out) {
  // Vertex 0 has two faces. The first face turns over, and has no area at some time.
  const Motion motion = fixtures::make_motion(fixtures::make_triangles(5, {0, 1, 2, 0, 3, 4}),
                                              {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 1}, {0, -1, 1}},
                                              {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}, {-1, 0, 1}, {0, -1, 1}});
  const WeightingFit fit = fit_weighting(motion.segment(0), vertices_of(motion), Weighting::kUniform);
  EXPECT_EQ(fit.bounds[0], std::numbers::pi);
}

TEST(WeightingFit, a_single_triangle_has_its_own_direction_by_every_weighting) {
  for (const Motion& motion : {fixtures::moderate_soup(50), fixtures::inside_out_soup(5)}) {
    std::vector<ControlNormals> of_faces(motion.topology.face_count());
    face_control_normals(motion.segment(0), {0, of_faces.size()}, of_faces);
    for (const Weighting weighting : kFitted) {
      const WeightingFit fit = fit_weighting(motion.segment(0), vertices_of(motion), weighting);
      for (std::size_t e = 0; e < fit.bounds.size(); ++e) {
        EXPECT_EQ(fit.bounds[e], 0);
        EXPECT_EQ(fit.normals[e], of_faces[e / 3]);
      }
    }
  }
}

TEST(WeightingFit, the_bound_is_pi_where_a_face_begins_without_area) {
  // Vertex 0 has two faces. The second face has no area at t = 0.
  const Motion motion = fixtures::make_motion(fixtures::make_triangles(5, {0, 1, 2, 0, 3, 4}),
                                              {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 2, 0}},
                                              {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 2, 1}});
  for (const Weighting weighting : {Weighting::kUniform, Weighting::kAngle}) {
    const WeightingFit fit = fit_weighting(motion.segment(0), vertices_of(motion), weighting);
    EXPECT_EQ(fit.bounds[0], std::numbers::pi);
    EXPECT_LT(fit.bounds[1], 1e-9) << "its face has an area throughout";
  }
}

TEST(WeightingFit, straight_corners_are_bounded_by_all_weightings) {
  // Vertex 1 remains on an edge of the quad. A second face at vertex 1 makes its normal depend on the weighting.
  const Motion motion = fixtures::make_motion(fixtures::make_polygons(5, {0, 4, 7}, {0, 1, 2, 3, 1, 0, 4}),
                                              {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {0.5, -1, 0.1}},
                                              {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0.3}, {0.5, -1, 0.2}});
  for (const Weighting weighting : {Weighting::kAngle, Weighting::kAreaAngle, Weighting::kUniform}) {
    const Summary summary = check_bounds(motion, weighting, 200, 5);
    EXPECT_EQ(summary.certified, 5u) << weighting_name(weighting);
    EXPECT_EQ(summary.loose, 0u) << weighting_name(weighting);
  }
}

TEST(WeightingFit, nearly_straight_corners_are_bounded_more_loosely) {
  // In random quads, one vertex is near the line through its neighbours. The distance between the vertex and the line
  // is as small as rounding to float32 makes it, or larger.
  fixtures::Random random(31);
  for (const double off : {1e-7, 1e-3}) {
    for (int round = 0; round < 50; ++round) {
      const auto points = [&] {
        std::vector<Point> p = {random.in_cube(0.1), random.in_cube(off), random.in_cube(0.1), random.in_cube(0.3),
                                random.in_cube(0.3)};
        p[2][0] += 2, p[3][1] += 1, p[4][1] -= 1;
        for (std::size_t k = 0; k < 3; ++k) p[1][k] += (p[0][k] + p[2][k]) / 2;
        return p;
      };
      const auto from = points(), to = points();
      const Motion motion =
          fixtures::make_motion(fixtures::make_polygons(5, {0, 4, 7}, {0, 1, 2, 3, 1, 0, 4}), from, to);
      for (const Weighting weighting : {Weighting::kAngle, Weighting::kAreaAngle})
        EXPECT_EQ(check_bounds(motion, weighting, 200, 5).certified, 5u);
    }
  }
}

TEST(WeightingFit, by_area_and_angle_a_face_may_lose_its_area_on_the_way) {
  // Face 0 shrinks to a line at t = 1, while face 1 keeps its area.
  const Motion motion = fixtures::make_motion(fixtures::make_triangles(4, {0, 1, 2, 2, 1, 3}),
                                              {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}},
                                              {{0.5, 0.5, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}});
  const Summary summary = check_bounds(motion, Weighting::kAreaAngle, 400, 4);
  EXPECT_EQ(fit_weighting(motion.segment(0), vertices_of(motion), Weighting::kUniform).bounds[1], std::numbers::pi);
  EXPECT_GE(summary.certified, 3u) << "all but vertex 0, which ends without a normal";
}

TEST(WeightingFit, elements_without_area_are_zero_with_bound_0) {
  const Motion motion = test::still(fixtures::make_triangles(5, {0, 1, 2, 2, 1, 3}),
                                    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 2, 0}, {7, 7, 7}});
  for (const Weighting weighting : kFitted) {
    const WeightingFit fit = fit_weighting(motion.segment(0), vertices_of(motion), weighting);
    for (const std::size_t e : {std::size_t{3}, std::size_t{4}}) {
      EXPECT_EQ(fit.normals[e], ControlNormals{});
      EXPECT_EQ(fit.bounds[e], 0);
    }
    EXPECT_LT(fit.bounds[1], 1e-9) << "the face without area does not spoil its neighbours";
  }
}

}  // namespace
}  // namespace chronormal::weighting_fit_test
