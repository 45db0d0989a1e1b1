// Compares winding numbers with an oracle in integers, and crossings with roots in rational numbers. A case is one
// point that moves through one mesh. The test has 100,000 cases from a fixed seed, or as many as the variable
// CHRONORMAL_FULL_CASES asks for.

#include "chronormal/analysis/containment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/io/input.h"
#include "tests/support/exact_cases.h"
#include "tests/support/fixtures.h"
#include "tests/support/read_input.h"
#include "tests/support/winding_oracle.h"

namespace chronormal::containment_test {
namespace {

using exact::Corners;
using fixtures::Random;

constexpr std::uint64_t kSeed = 20230;

// The faces of a tetrahedron, a double pyramid and a cube, as indices of vertices, counterclockwise as seen from
// outside.
const std::array<std::vector<Corners>, 3> kMeshes{{
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
    {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}},
    {{0, 2, 1},
     {1, 2, 3},
     {4, 5, 6},
     {5, 7, 6},
     {0, 1, 4},
     {1, 5, 4},
     {2, 6, 3},
     {3, 6, 7},
     {0, 4, 2},
     {2, 4, 6},
     {1, 3, 5},
     {3, 7, 5}},
}};
const std::array<std::vector<Vec3f>, 3> kShapes{{
    {{-8, -8, -8}, {8, -8, -8}, {0, 8, -8}, {0, 0, 8}},
    {{8, 0, 0}, {-8, 0, 0}, {0, 8, 0}, {0, -8, 0}, {0, 0, 8}, {0, 0, -8}},
    {{-8, -8, -8}, {8, -8, -8}, {-8, 8, -8}, {8, 8, -8}, {-8, -8, 8}, {8, -8, 8}, {-8, 8, 8}, {8, 8, 8}},
}};

std::vector<float> flat(const std::vector<Vec3f>& points) {
  std::vector<float> result;
  for (const Vec3f& p : points) result.insert(result.end(), {p.x, p.y, p.z});
  return result;
}
VectorView<const float> view(const std::vector<float>& xyz) { return VectorView<const float>::packed(xyz); }

// A closed mesh and some points, all of which move over one segment.
struct Scene {
  std::vector<Corners> faces;
  Topology topology;
  std::vector<float> mesh_from, mesh_to;
  std::vector<Vec3f> from, to;

  Scene(std::vector<Corners> corners, const std::vector<Vec3f>& at_start, const std::vector<Vec3f>& at_end)
      : faces(std::move(corners)), mesh_from(flat(at_start)), mesh_to(flat(at_end)) {
    std::vector<std::uint32_t> all;
    for (const Corners& face : faces) all.insert(all.end(), face.begin(), face.end());
    topology = fixtures::make_triangles(at_start.size(), std::move(all));
  }

  [[nodiscard]] Segment segment() const { return {&topology, view(mesh_from), view(mesh_to)}; }
  [[nodiscard]] Containment containment() const {
    return Containment::make(topology, separate_points(topology.vertex_count()), view(mesh_from)).value();
  }
  [[nodiscard]] std::vector<Crossing> crossings() const {
    const std::vector<float> a = flat(from), b = flat(to);
    return containment().crossings(segment(), view(a), view(b));
  }
  [[nodiscard]] std::vector<std::int32_t> windings(double t) const {
    const std::vector<float> a = flat(from), b = flat(to);
    return containment().winding_numbers(segment(), t, view(a), view(b));
  }
  [[nodiscard]] int expected_winding(std::size_t p, double t) const {
    return exact::winding_number(segment(), faces, from[p], to[p], t);
  }
};

// Returns the winding number of a point just before time t: the winding number `start` at t = 0, changed by all
// crossings before t.
int winding_before(int start, std::span<const Crossing> crossings, double t) {
  for (const Crossing& crossing : crossings) start += crossing.t < t ? (crossing.inward ? 1 : -1) : 0;
  return start;
}

std::span<const Crossing> of_point(const std::vector<Crossing>& crossings, std::size_t p) {
  const auto is_before = [](const Crossing& crossing, std::size_t point) { return crossing.point < point; };
  return {std::lower_bound(crossings.begin(), crossings.end(), p, is_before),
          std::lower_bound(crossings.begin(), crossings.end(), p + 1, is_before)};
}

Vec3f lattice_point(Random& random, std::size_t half) {
  const auto coordinate = [&] {
    return static_cast<float>(static_cast<int>(random.below(2 * half + 1)) - static_cast<int>(half));
  };
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

// Returns random points of a lattice to which the vertices at `points` move. In most cases, either many vertices stay
// in place, or all move by the same vector.
std::vector<Vec3f> moved_on_lattice(const std::vector<Vec3f>& points, Random& random) {
  const std::size_t kind = random.below(4);
  const Vec3f shift = lattice_point(random, 4);
  std::vector<Vec3f> result = points;
  for (Vec3f& p : result) {
    if (kind == 1) p = p + shift;
    if (kind == 2 && random.below(2) == 0) p = p + lattice_point(random, 4);
    if (kind == 3) p = lattice_point(random, 8);
  }
  return result;
}

// Draws a position at t = 1/2, which is often on a vertex, an edge or a face of the mesh, and returns it doubled. The
// position is doubled so that its coordinates are integers.
Vec3f twice_a_place(const Scene& scene, Random& random) {
  const auto twice = [&](std::uint32_t v) { return scene.segment().from[v] + scene.segment().to[v]; };
  const Corners& face = scene.faces[random.below(scene.faces.size())];
  const Vec3f a = twice(face[0]), b = twice(face[1]), c = twice(face[2]);
  switch (random.below(4)) {
    case 0:
      return a;
    case 1:
      return 0.5F * (a + b);
    case 2:
      return 0.25F * (a + a + b + c);
    default:
      return 2.0F * lattice_point(random, 6);
  }
}

void add_lattice_points(Scene& scene, std::size_t count, Random& random) {
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f twice = twice_a_place(scene, random);
    Vec3f from = lattice_point(random, 10), to = twice - from;
    switch (random.below(6)) {
      case 0:  // at rest
        from = to = 0.5F * twice;
        break;
      case 1:  // from a vertex to a vertex, sometimes along edges
        from = scene.segment().from[random.below(scene.segment().from.count)];
        to = scene.segment().to[random.below(scene.segment().to.count)];
        break;
      case 2:  // the point begins at this position
        from = 0.5F * twice;
        break;
      default:;
    }
    scene.from.push_back(from);
    scene.to.push_back(to);
  }
}

// Tells whether a point touches an edge at t without crossing it: just before and just after t, the winding number must
// be `winding`.
bool is_touch(const Scene& scene, std::size_t p, double t, int winding) {
  constexpr double kBeside = 0x1p-44;
  return scene.expected_winding(p, t - kBeside) == winding && scene.expected_winding(p, t + kBeside) == winding;
}

// Compares the winding number of each point at both ends of the segment, and at a time in between, with the oracle and
// with a count of the crossings up to that time.
void judge_windings(const Scene& scene, Random& random, const std::string& what) {
  const std::vector<Crossing> all = scene.crossings();
  const double t = static_cast<double>(random.below(15) * 2 + 1) / 32;
  const std::vector<std::int32_t> starts = scene.windings(0), between = scene.windings(t), ends = scene.windings(1);
  for (std::size_t p = 0; p < scene.from.size(); ++p) {
    const std::span<const Crossing> crossings = of_point(all, p);
    const int expected = scene.expected_winding(p, t), told = winding_before(starts[p], crossings, t);
    ASSERT_EQ(starts[p], scene.expected_winding(p, 0)) << what << ", point " << p;
    ASSERT_EQ(between[p], expected) << what << ", point " << p;
    ASSERT_EQ(ends[p], winding_before(starts[p], crossings, 2)) << what << ", point " << p;
    const bool is_clear =
        std::none_of(crossings.begin(), crossings.end(), [t](const Crossing& c) { return std::fabs(c.t - t) < 1e-12; });
    if (is_clear && expected != told) {
      ASSERT_TRUE(is_touch(scene, p, t, told))
          << what << ", point " << p << ", at t = " << t << ": " << expected << ", and by crossings " << told;
    }
  }
}

TEST(ExactContainment, windings_between_crossings_are_those_of_whole_numbers) {
  Random random(kSeed);
  const std::size_t wanted = test::wanted_cases();
  std::size_t cases = 0;
  for (std::size_t i = 0; cases < wanted; ++i) {
    const std::size_t shape = i % kMeshes.size();
    const std::vector<Vec3f> start = moved_on_lattice(kShapes[shape], random);
    Scene scene(kMeshes[shape], start, moved_on_lattice(start, random));
    add_lattice_points(scene, 50, random);
    judge_windings(scene, random, "seed " + std::to_string(kSeed) + ", mesh " + std::to_string(i));
    if (HasFatalFailure()) return;
    cases += scene.from.size();
  }
  std::cout << "seed " << kSeed << ": " << cases << " cases\n";
}

// Makes a scene with arbitrary floats as coordinates. Some faces are needles, and points come arbitrarily close to
// edges.
Scene hard_scene(Random& random, std::size_t shape) {
  const double size = std::ldexp(1, static_cast<int>(random.below(60)) - 30);
  const auto any = [&](double scale) {
    const fixtures::Point p = random.in_cube(scale);
    return Vec3f{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
  };
  std::vector<Vec3f> start, end;
  for (const Vec3f& p : kShapes[shape]) {
    const auto scale = static_cast<float>(size * std::ldexp(1, -static_cast<int>(random.below(12))));
    start.push_back(scale * p + any(size));
    end.push_back(start.back() + any(size * std::ldexp(1, -static_cast<int>(random.below(20)))));
  }
  Scene scene(kMeshes[shape], start, end);
  for (int i = 0; i < 8; ++i) {
    const Corners& face = scene.faces[random.below(scene.faces.size())];
    const auto share = static_cast<float>(random.uniform(0, 1));
    const float beside = std::ldexp(1.0F, -static_cast<int>(random.below(30))) * (random.below(2) == 0 ? 1.0F : -1.0F);
    const auto near = [&](const std::vector<Vec3f>& at) {
      const Vec3f a = at[face[0]], b = at[face[1]], c = at[face[2]];
      return a + share * (b - a) + beside * (c - a);
    };
    const Vec3f away = any(size * std::ldexp(1, -static_cast<int>(random.below(24))));
    scene.from.push_back(near(start) + away);
    scene.to.push_back(near(end) - away);
  }
  return scene;
}

TEST(ExactContainment, crossings_are_the_roots_in_rationals) {
  Random random(kSeed + 1);
  const std::size_t wanted = test::wanted_cases() / 200;
  std::size_t cases = 0, found = 0, special = 0;
  for (std::size_t i = 0; cases < wanted; ++i) {
    const Scene scene = hard_scene(random, i % kMeshes.size());
    const std::vector<Crossing> all = scene.crossings();
    for (std::size_t p = 0; p < scene.from.size(); ++p, ++cases) {
      auto expected = exact::find_crossings(scene.segment(), scene.faces, scene.from[p], scene.to[p]);
      if (!expected.is_general) {
        ++special;
        continue;
      }
      std::sort(expected.list.begin(), expected.list.end(), [](const auto& a, const auto& b) { return a.low < b.low; });
      const std::span<const Crossing> crossings = of_point(all, p);
      ASSERT_EQ(crossings.size(), expected.list.size()) << "seed " << kSeed + 1 << ", mesh " << i << ", point " << p;
      for (std::size_t k = 0; k < crossings.size(); ++k) {
        EXPECT_EQ(crossings[k].face, expected.list[k].face) << "mesh " << i << ", point " << p;
        EXPECT_EQ(crossings[k].inward, expected.list[k].inward) << "mesh " << i << ", point " << p;
        EXPECT_LE(std::fabs(mpq_class(crossings[k].t - expected.list[k].low).get_d()), 0x1p-44);
      }
      found += crossings.size();
    }
  }
  EXPECT_LT(special, cases / 20);
  EXPECT_GT(found, cases / 2);
  std::cout << "seed " << kSeed + 1 << ": " << cases << " cases, " << found << " crossings, " << special
            << " touch something\n";
}

// Makes a cube from (0, 0, 0) to (1, 1, 1) that stands still, with its faces outwards.
Scene resting_cube() {
  std::vector<Vec3f> corners = kShapes[2];
  for (Vec3f& p : corners) p = 0.0625F * (p + Vec3f{8, 8, 8});
  return {kMeshes[2], corners, corners};
}

TEST(Containment, a_point_on_the_surface_is_taken_as_moved_along_x_then_y_then_z) {
  Scene cube = resting_cube();
  const std::vector<std::pair<Vec3f, int>> cases = {
      {{0, 0.25F, 0.5F}, 1}, {{1, 0.25F, 0.5F}, 0}, {{0.25F, 0, 0.5F}, 1}, {{0.25F, 1, 0.5F}, 0},
      {{0.25F, 0.5F, 0}, 1}, {{0.25F, 0.5F, 1}, 0}, {{0, 0, 0}, 1},        {{1, 0, 0}, 0},
      {{0, 1, 0}, 0},        {{0, 0, 1}, 0},        {{0, 0, 0.5F}, 1},     {{0.5F, 1, 1}, 0},
      {{0, 0.5F, 0.5F}, 1},  {{1, 1, 1}, 0},        {{0.5F, 0, 1}, 0},     {{0.5F, 0.5F, 0.5F}, 1}};
  for (const auto& [point, winding] : cases) cube.from.push_back(point);
  cube.to = cube.from;
  const std::vector<std::int32_t> windings = cube.windings(0);
  for (std::size_t i = 0; i < cases.size(); ++i) EXPECT_EQ(windings[i], cases[i].second) << i;
  EXPECT_TRUE(cube.crossings().empty()) << "what rests crosses nothing";
}

TEST(Containment, a_path_through_an_edge_or_a_vertex_crosses_once_each_way) {
  Scene scene(kMeshes[1], kShapes[1], kShapes[1]);
  scene.from = {{-16, 0, 0}, {-8, -8, 0}, {8, -8, -8}, {-16, 0, 8}, {-16, 8, 0}};
  scene.to = {{16, 0, 0}, {8, 8, 0}, {-8, 8, 8}, {16, 0, 8}, {16, 8, 0}};
  const std::vector<Crossing> all = scene.crossings();
  // Point 0 passes through a vertex, point 1 through an edge, and point 2 through the middle of a face. Points 3 and 4
  // touch a vertex.
  const std::vector<double> times = {0.25, 0.25, 1.0 / 3};
  for (std::size_t p = 0; p < 5; ++p) {
    const std::span<const Crossing> crossings = of_point(all, p);
    ASSERT_EQ(crossings.size(), p < 3 ? 2 : 0) << p;  // the last two points touch a vertex from outside
    if (p >= 3) continue;
    EXPECT_TRUE(crossings[0].inward);
    EXPECT_FALSE(crossings[1].inward);
    EXPECT_NEAR(crossings[0].t, times[p], 0x1p-44);
    EXPECT_NEAR(crossings[1].t, 1 - times[p], 0x1p-44);
  }
}

TEST(Containment, the_surface_may_pass_points_that_rest) {
  // The cube doubles its size while the points rest. The normal of a crossing must be the normal of the crossed face at
  // the time of the crossing.
  Scene scene = resting_cube();
  for (float& x : scene.mesh_to) x = 2 * x;
  scene.from = scene.to = {{1.5F, 0.25F, 0.125F}, {0.5F, 0.75F, 0.25F}, {2.5F, 1, 1}};
  const std::vector<Crossing> crossings = scene.crossings();
  ASSERT_EQ(crossings.size(), 1U);
  EXPECT_EQ(crossings[0].point, 0U);
  EXPECT_NEAR(crossings[0].t, 0.5, 0x1p-44);
  EXPECT_TRUE(crossings[0].inward);
  EXPECT_EQ(crossings[0].normal, (Vec3d{1, 0, 0}));
  EXPECT_TRUE(crossings[0].face == 10 || crossings[0].face == 11) << crossings[0].face;
}

TEST(Containment, a_touch_changes_the_winding_number_for_a_moment_only) {
  // At t = 15/32 only, the point is on the edge between vertices 5 and 6, but crosses no face.
  Scene scene(kMeshes[2],
              {{3, 2, 1}, {-1, -6, -5}, {-5, -4, -2}, {8, -7, -4}, {4, 5, 3}, {-2, 6, -7}, {7, -8, -6}, {-3, -1, 5}},
              {{6, 0, -8}, {8, 0, 0}, {7, 1, -6}, {3, -2, -6}, {2, 4, 8}, {0, -6, 6}, {8, 1, -4}, {-1, 5, -8}});
  scene.from = {{4, -5, -3}};
  scene.to = {{-2.25F, 4.25F, -0.75F}};
  constexpr double kTouch = 15.0 / 32;
  const std::vector<Crossing> crossings = scene.crossings();
  const int told = winding_before(scene.windings(0)[0], crossings, kTouch);
  EXPECT_EQ(told, -1);
  for (const double t : {kTouch - 0x1p-20, kTouch - 0x1p-44, kTouch, kTouch + 0x1p-44, kTouch + 0x1p-20}) {
    EXPECT_EQ(scene.windings(t)[0], t == kTouch ? 0 : told) << t - kTouch;
    EXPECT_EQ(scene.expected_winding(0, t), t == kTouch ? 0 : told) << t - kTouch;
  }
  EXPECT_TRUE(std::none_of(crossings.begin(), crossings.end(),
                           [](const Crossing& c) { return std::fabs(c.t - kTouch) < 0x1p-20; }));
}

TEST(Containment, winding_numbers_of_a_cube_that_is_turned_inside_out_are_negative) {
  Scene scene = resting_cube();
  for (std::size_t i = 0; i < scene.mesh_to.size(); i += 3) scene.mesh_to[i] = 1 - scene.mesh_to[i];
  scene.from = scene.to = {{0.25F, 0.5F, 0.5F}};
  EXPECT_EQ(scene.windings(0)[0], 1);
  EXPECT_EQ(scene.windings(1)[0], -1);
  const std::vector<Crossing> crossings = scene.crossings();
  ASSERT_EQ(crossings.size(), 2U);
  EXPECT_FALSE(crossings[0].inward || crossings[1].inward);
}

TEST(Containment, faces_of_any_number_of_corners_and_seams_are_closed) {
  // The cube consists of quads that do not share vertices.
  const Scene cube = resting_cube();
  constexpr std::array<std::array<std::size_t, 4>, 6> kQuads{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<std::uint32_t> offsets = {0}, corners;
  Points points;
  std::vector<float> xyz;
  for (const auto& quad : kQuads) {
    for (const std::size_t v : quad) {
      corners.push_back(static_cast<std::uint32_t>(corners.size()));
      points.point_of_vertex.push_back(static_cast<std::uint32_t>(v));
      xyz.insert(xyz.end(), cube.mesh_from.begin() + static_cast<std::ptrdiff_t>(3 * v),
                 cube.mesh_from.begin() + static_cast<std::ptrdiff_t>(3 * v + 3));
    }
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  points.count = 8;
  const Topology topology = fixtures::make_polygons(24, std::move(offsets), std::move(corners));
  const Result<Containment> containment = Containment::make(topology, points, view(xyz));
  ASSERT_TRUE(containment.ok()) << containment.error().text();
  const Segment segment{&topology, view(xyz), view(xyz)};
  const std::vector<float> from = {0.5F, 0.5F, 0.5F}, to = {0.5F, 0.5F, 2};
  EXPECT_EQ(containment.value().winding_numbers(segment, 0, view(from), view(from)), std::vector<std::int32_t>{1});
  const std::vector<Crossing> crossings = containment.value().crossings(segment, view(from), view(to));
  ASSERT_EQ(crossings.size(), 1U);  // the points cross on the diagonal of the quad
  EXPECT_EQ(crossings[0].face, 1U);
  EXPECT_EQ(crossings[0].normal, (Vec3d{0, 0, 1}));

  const Result<Containment> apart = Containment::make(topology, separate_points(24), view(xyz));
  ASSERT_FALSE(apart.ok());
  EXPECT_EQ(apart.error().text(),
            "face 0: the mesh is not closed, so points cannot be inside it; 24 edges have a face on one side only "
            "(fill such holes)");
}

TEST(Containment, a_mesh_that_is_not_closed_is_refused_with_its_edges_counted) {
  const auto refusal = [](std::vector<std::uint32_t> corners) {
    const std::vector<float> xyz(12);
    const Result<Containment> made =
        Containment::make(fixtures::make_triangles(4, std::move(corners)), separate_points(4), view(xyz));
    EXPECT_FALSE(made.ok());
    EXPECT_EQ(made.error().code, ErrorCode::kInvalidInput);
    return made.error().text();
  };
  EXPECT_EQ(refusal({0, 2, 1, 0, 1, 3, 1, 2, 3}),
            "face 0: the mesh is not closed, so points cannot be inside it; 3 edges have a face on one side only (fill "
            "such holes)");
  EXPECT_EQ(
      refusal({0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 2, 3}),
      "face 0: the mesh is not closed, so points cannot be inside it; 3 edges lie between two faces whose corners "
      "run in opposite orders (flip one of the two)");
  EXPECT_EQ(
      refusal({0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 2, 0, 3}),
      "face 0: the mesh is not closed, so points cannot be inside it; 3 edges lie between two faces whose corners "
      "run in opposite orders (flip one of the two)");
  EXPECT_EQ(refusal({0, 1, 2, 1, 0, 3, 0, 1, 3}).find("2 edges have a face on one side only (fill such holes)"),
            std::string("face 0: the mesh is not closed, so points cannot be inside it; ").size());
}

TEST(Containment, results_are_the_same_on_any_number_of_threads) {
  Random random(kSeed + 2);
  Scene scene(kMeshes[1], kShapes[1], moved_on_lattice(kShapes[1], random));
  add_lattice_points(scene, 1000, random);
  const ThreadLimit one(1);
  const std::vector<Crossing> alone = scene.crossings();
  const ThreadLimit four(4);
  EXPECT_EQ(scene.crossings(), alone);
  EXPECT_GT(alone.size(), 100U);
}

}  // namespace
}  // namespace chronormal::containment_test
