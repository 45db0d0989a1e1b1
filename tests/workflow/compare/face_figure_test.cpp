// Compares the figures about one face, which reports show, with the textbook definitions in tests/support/reference.h.
#include "workflow/compare/face_figure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/workflow/compare.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference.h"
#include "tests/support/scheme_names.h"

namespace chronormal::face_figure_test {
namespace {

using reference::Real;
using reference::Vector;

constexpr Real kNear = 1e-6L;  // in radians, or as a share of a length

Vector real(const Vec3d& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }

reference::Triangle triangle_of(const FaceFigure& figure) {
  reference::Triangle triangle{};
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.from[i] = real(figure.corners[i][0]);
    triangle.to[i] = real(figure.corners[i][1]);
  }
  return triangle;
}

// Returns the length of the vector that a Lagrange scheme normalises. Computes the Lagrange weights of the nodes as
// products of differences.
std::optional<Real> lagrange_length(const reference::Triangle& triangle, std::size_t degree, Real t) {
  const auto nodes = reference::exact_nodes(triangle, degree + 1);
  if (!nodes) return std::nullopt;
  Vector sum{};
  for (std::size_t k = 0; k <= degree; ++k) {
    Real weight = 1;
    for (std::size_t j = 0; j <= degree; ++j) {
      if (j != k) weight *= (Real(degree) * t - Real(j)) / (Real(k) - Real(j));
    }
    sum = reference::add(sum, reference::scaled(weight, (*nodes)[k]));
  }
  return reference::length(sum);
}

void expect_near(const Vec3d& found, const Vector& expected, const std::string& what) {
  EXPECT_LT(reference::length(reference::subtract(real(found), expected)), kNear) << what;
}

// Checks de Casteljau's levels by the recursion itself: every point of a level must be on the arc between two points of
// the level before.
void expect_levels(const SchemeFigure& scheme, const reference::Triangle& triangle, std::size_t sample, Real t) {
  const auto nodes = reference::exact_nodes(triangle, scheme.nodes.size());
  if (!nodes) return;
  std::vector<Vector> level = *nodes;
  for (std::size_t k = 0; k < level.size(); ++k) expect_near(scheme.nodes[k], level[k], scheme.scheme + ", node");
  const std::size_t count = level.size();
  std::size_t at = sample * count * (count - 1) / 2;
  while (level.size() > 1) {
    std::vector<Vector> next;
    for (std::size_t i = 0; i + 1 < level.size(); ++i) {
      const auto point = reference::slerp(level[i], level[i + 1], t);
      if (!point) return;
      next.push_back(*point);
      expect_near(scheme.points[at++], *point, scheme.scheme + ", point");
    }
    level = next;
  }
}

void expect_tangents(const SchemeFigure& scheme, const reference::Triangle& triangle, const reference::Place& place,
                     std::size_t sample, Real t) {
  if (scheme.tangents.empty()) return;
  const Vector tangent = real(scheme.tangents[sample]), normal = real(scheme.normals[sample]);
  EXPECT_NEAR(double(reference::length(tangent)), 1, 1e-6);
  EXPECT_NEAR(double(reference::dot(tangent, normal)), 0, 1e-6) << scheme.scheme;
  const auto name = reference::parse_scheme(scheme.scheme);
  const auto frames = reference::frames(name->kind.substr(name->kind.find(':') + 1), triangle, name->number, place);
  if (!frames || scheme.scheme == "quaternion:optimal") return;
  const auto q0 = reference::to_quaternion(reference::to_matrix(frames->first));
  auto q1 = reference::to_quaternion(reference::to_matrix(frames->second));
  if (std::fabs(reference::dot(q0, q1)) < 1e-4L) return;  // rounding decides the direction of rotation
  if (reference::dot(q0, q1) < 0) q1 = reference::scaled(Real(-1), q1);
  const auto r = reference::to_matrix(*reference::slerp(q0, q1, t));
  expect_near(scheme.tangents[sample], {r[0][0], r[1][0], r[2][0]}, scheme.scheme + ", tangent");
}

void expect_matrix(const FaceFigure& figure, const reference::Triangle& triangle) {
  const auto n0 = reference::exact_unit_normal(triangle, 0), n1 = reference::exact_unit_normal(triangle, 1);
  if (!n0 || !n1) return;
  const auto expected = reference::triangle_map(triangle, *n0, *n1);
  ASSERT_TRUE(expected && figure.matrix);
  Real size = 1;
  for (const auto& row : *expected)
    for (const Real x : row) size = std::max(size, std::fabs(x));
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      EXPECT_NEAR(double(Real((*figure.matrix)[i][j]) / size), double((*expected)[i][j] / size), 1e-9);
}

TEST(FaceFigure, paths_lengths_arcs_and_frames_are_those_of_the_textbook) {
  constexpr std::uint64_t kSeed = 55;
  std::cout << "seed " << kSeed << '\n';
  std::map<std::string, std::size_t> held;  // number of compared samples of each scheme
  for (const double moves : {0.3, 3.0}) {
    const Motion motion = fixtures::soup({.face_count = 40, .seed = kSeed, .motion = moves});
    for (std::size_t face = 0; face < 40; ++face) {
      const auto found = face_figure(motion, {face, 0, test::scheme_names(), 11});
      ASSERT_TRUE(found.ok());
      const FaceFigure& figure = found.value();
      const reference::Triangle triangle = triangle_of(figure);
      expect_matrix(figure, triangle);
      for (std::size_t i = 0; i < figure.times.size(); ++i) {
        const Real t = figure.times[i];
        const auto exact = reference::exact_unit_normal(triangle, t);
        if (!exact) continue;
        expect_near(figure.normals[i], *exact, "exact");
        const Real area = reference::length(reference::exact_normal(triangle, t));
        EXPECT_NEAR(double(Real(figure.lengths[i]) / area), 1, 1e-9);
        for (const SchemeFigure& scheme : figure.schemes) {
          const std::size_t middle = figure.times.size() / 2;
          const auto expected =
              reference::unit_normal(scheme.scheme, triangle, t, {face, 0}, real(scheme.normals[middle]));
          const auto name = reference::parse_scheme(scheme.scheme);
          const bool is_tiny = !scheme.lengths.empty() && scheme.lengths[i] < 0.05;  // float32 has too few digits here
          if (!expected || is_tiny || name->kind == "quaternion:optimal") continue;
          const Vector normal = real(scheme.normals[i]);
          // Skips samples at which the scheme took another branch than the oracle. oracle_test.cpp tests this choice.
          if (reference::angle(normal, *expected) > 5 * kNear) continue;
          ++held[scheme.scheme];
          EXPECT_NEAR(scheme.angles[i], double(reference::angle(normal, *exact)), 1e-6) << scheme.scheme;
          const std::map<std::string_view, std::size_t> degrees = {{"linear", 1}, {"quadratic", 2}, {"cubic", 3}};
          const bool is_lagrange = name->kind == "lagrange" || degrees.contains(name->kind);
          if (is_lagrange) {
            const std::size_t degree = name->kind == "lagrange" ? std::size_t(name->number) : degrees.at(name->kind);
            EXPECT_NEAR(scheme.lengths[i], double(*lagrange_length(triangle, degree, t)), 1e-5) << scheme.scheme;
          }
          if (name->kind == "decasteljau") expect_levels(scheme, triangle, i, t);
          EXPECT_EQ(scheme.nodes.empty(), name->kind != "decasteljau");
          EXPECT_TRUE(scheme.tangents.empty() || scheme.scheme.starts_with("quaternion:"));
          expect_tangents(scheme, triangle, {face, 0}, i, t);
        }
      }
    }
  }
  for (const std::string& name : test::scheme_names()) {
    EXPECT_TRUE(name == "quaternion:optimal" || held[name] > 400) << name << ": only " << held[name] << " were held";
  }
}

TEST(FaceFigure, q_is_that_of_the_comparison) {
  const Motion twist = make_builtin_morph("twist").value();
  const auto figure = face_figure(twist, {15001, 0, {}, 21});
  ASSERT_TRUE(figure.ok());
  Motion alone;
  alone.topology = Topology::triangles(3, {0, 1, 2}).value();
  alone.keyframes.resize(2);
  alone.keyframes[1].time = 1;
  for (std::size_t end = 0; end < 2; ++end) {
    for (const auto& corner : figure.value().corners) {
      for (const double x : {corner[end].x, corner[end].y, corner[end].z})
        alone.keyframes[end].positions.push_back(static_cast<float>(x));
    }
  }
  alone.connect_as_sequence();
  const Comparison comparison = compare(alone, CompareOptions{}).value();
  ASSERT_EQ(figure.value().schemes.size(), comparison.schemes.size());
  for (std::size_t s = 0; s < comparison.schemes.size(); ++s) {
    const SchemeFigure& scheme = figure.value().schemes[s];
    EXPECT_EQ(scheme.scheme, comparison.schemes[s].scheme);
    if (!scheme.scheme.starts_with("quaternion:random")) {
      EXPECT_EQ(scheme.sum, comparison.schemes[s].quality.sum) << scheme.scheme;
    }
  }
}

TEST(FaceFigure, a_face_that_collapses_or_has_more_corners_is_shown_as_far_as_it_is_one) {
  const Motion collapsing =
      fixtures::make_motion(fixtures::make_triangles(3, {0, 1, 2}), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                            {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}});  // no area at t = 1/2, then its back is up
  const FaceFigure figure = face_figure(collapsing, {0, 0, {"linear", "quaternion:matrix"}, 3}).value();
  EXPECT_EQ(figure.lengths[1], 0);
  EXPECT_TRUE(std::isnan(figure.schemes[0].angles[1]));
  const Motion flat = fixtures::make_motion(fixtures::make_triangles(3, {0, 1, 2}), {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
                                            {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const FaceFigure opened = face_figure(flat, {0, 0, {"quaternion:matrix"}, 3}).value();
  EXPECT_FALSE(opened.matrix);
  EXPECT_TRUE(opened.schemes[0].tangents.empty()) << "the fallback has no frames";
  const Motion quad = fixtures::make_motion(fixtures::make_polygons(4, {0, 4}, {0, 1, 2, 3}),
                                            {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                            {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0.5}});
  EXPECT_EQ(face_figure(quad, {}).value().corners.size(), 4U);
}

TEST(FaceFigure, what_does_not_exist_is_refused) {
  const Motion twist = make_builtin_morph("twist").value();
  for (const FaceFigureOptions& wrong :
       std::vector<FaceFigureOptions>{{15200, 0, {}, 21}, {0, 1, {}, 21}, {0, 0, {"nlerp"}, 21}, {0, 0, {}, 1}}) {
    const auto figure = face_figure(twist, wrong);
    ASSERT_FALSE(figure.ok());
    EXPECT_EQ(figure.error().code, ErrorCode::kUsage);
  }
}

}  // namespace
}  // namespace chronormal::face_figure_test
