// Compares the sides that faces show over time with the signs of polynomials whose coefficients are integers of any
// size.

#include "chronormal/analysis/signs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "analysis/signs/kernels/facing_lanes.h"
#include "simd/targets.h"
#include "tests/support/exact_cases.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/whole_polynomial.h"

namespace chronormal::facing_test {
namespace {

using test::WholePolynomial;

// Returns a vector as integers in units of 2^-1074, the smallest positive double.
test::WholeVector whole(const Vec3d& v) {
  const auto one = [](double x) {
    int exponent = 0;
    const test::Whole mantissa(std::ldexp(std::frexp(x, &exponent), 53));
    const int shift = exponent - 53 + 1074;
    const auto by = static_cast<mp_bitcnt_t>(std::abs(shift));
    return shift >= 0 ? test::Whole(mantissa << by) : test::Whole(mantissa >> by);
  };
  return {one(v.x), one(v.y), one(v.z)};
}
test::WholeVector whole(const Vec3f& v) { return whole(to_double(v)); }

// Returns the polynomial n(t) . w(t), where w(t) points from the first corner of the face to the viewer. Uses positions
// alone: the values at t = -1, 0, 1 and 2, where the corners are integers, determine the polynomial.
WholePolynomial facing_polynomial(const Segment& segment, std::size_t face, const View& view) {
  const auto vertices = segment.topology->face(face);
  std::array<test::Whole, 4> values;
  for (const long t : {-1L, 0L, 1L, 2L}) {
    const test::WholeVector a = test::on_line(whole(segment.from[vertices[0]]), whole(segment.to[vertices[0]]), t);
    // The places of the viewer on its path at t = 0 and at t = 1 are fractions with two different denominators.
    // Multiplying by both denominators makes them integers.
    const auto time = [](double difference) { return test::Whole(std::ldexp(difference, 60)); };
    const test::WholeVector n = test::whole_normal(segment, vertices, t), from = whole(view.from), to = whole(view.to);
    const test::Whole first = time(view.start.end - view.start.start), second = time(view.end.end - view.end.start);
    const test::Whole start = time(view.start.time - view.start.start) * second,
                      end = time(view.end.time - view.end.start) * first, part = start + t * (end - start);
    test::WholeVector way;
    for (std::size_t k = 0; k < 3; ++k) {
      way[k] = first * second * from[k] + part * (to[k] - from[k]);
      if (view.is_eye) way[k] -= first * second * a[k];
    }
    values[static_cast<std::size_t>(t + 1)] = test::dot_of(n, way);
  }
  return WholePolynomial::through(values[0], values[1], values[2], values[3]);
}

int sign_of(Side side) { return static_cast<int>(side); }

// Checks the changes of side that the library found for one face against f, the polynomial whose sign is the side.
// Describes the first fault, or returns "".
std::string fault_of(const Facing& facing, const WholePolynomial& f, test::Random& random) {
  if (f.is_zero()) return facing.count == 0 && facing.side == Side::kNone ? "" : "zero throughout";
  const std::size_t roots = f.count_roots();
  std::size_t inside = 0;
  double last = -1;
  int side = facing.count == 0 ? sign_of(facing.side) : 0;
  std::vector<std::pair<double, int>> parts = {{0, side}};  // each with a time and the sign of f from this time on
  for (const FacingChange& change : facing.changes()) {
    if (last > change.lower || change.lower > change.upper) return "not ascending";
    if (change.upper - change.lower > kWidestBracket) return "a wide bracket";
    if (change.lower == change.upper) {
      if (f.sign_at(change.lower) != 0) return "no root at a double";
      ++inside;
    } else {
      const int below = f.sign_at(change.lower), above = f.sign_at(change.upper);
      // A root that is exactly a double has its own bracket, of width zero. The bracket of another root may begin at
      // this double.
      const bool follows_a_root = below == 0 && change.lower == last;
      if (below == 0 && change.lower > 0 && !follows_a_root) return "lower end is a root";
      const bool crosses = below * above < 0;
      inside += crosses ? 1 : f.count_roots(change.lower, change.upper) - (follows_a_root ? 1 : 0);
      if (below != 0 && below != sign_of(change.before)) return "side before";
      if (above != 0 && above != sign_of(change.after)) return "side after";
    }
    if (parts.back().second != 0 && parts.back().second != sign_of(change.before)) return "sides do not meet";
    if (parts.size() == 1) parts[0].second = sign_of(change.before);
    parts.emplace_back(change.upper, sign_of(change.after));
    last = change.upper;
  }
  if (inside != roots) return std::to_string(roots) + " roots, found " + std::to_string(inside);
  // Compares the side with the exact sign of f at many instants, some of which are close to the brackets.
  const std::size_t times = test::wanted_times(random);
  for (std::size_t i = 0; i < times; ++i) {
    double t = random.uniform(0, 1);
    if (facing.count > 0 && i % 2 == 1) {
      const FacingChange& change = facing.at[random.below(facing.count)];
      const double step = std::ldexp(random.uniform(0.5, 1), -static_cast<int>(random.below(54)));
      t = std::clamp(random.below(2) == 0 ? change.lower - step : change.upper + step, 0.0, 1.0);
    }
    bool is_inside = false;
    int expected = parts[0].second;
    for (const FacingChange& change : facing.changes()) {
      is_inside |= change.lower <= t && t <= change.upper;
      if (change.upper < t) expected = sign_of(change.after);
    }
    if (!is_inside && f.sign_at(t) != expected) return "side at t = " + std::to_string(t);
  }
  return "";
}

// Makes a viewer. Usually, the coordinates of the viewer's place are not floats. In some cases, the face is seen
// edge-on from this place at a t such as 0 or 1.
View some_view(const Segment& segment, std::size_t face, test::Random& random) {
  const auto vertices = segment.topology->face(face);
  const Vec3d a = to_double(segment.from[vertices[0]]), b = to_double(segment.to[vertices[1]]),
              c = to_double(segment.to[vertices[2]]);
  const auto lattice = [&random] {
    const auto one = [&random] { return static_cast<double>(random.below(7)) - 3; };
    const double x = one(), y = one();
    return Vec3d{x, y, one()};
  };
  const auto somewhere = [&random](double size) {
    const auto p = random.in_cube(size);
    return Vec3d{p[0], p[1], p[2]};
  };
  const auto clamped = [](const Vec3d& v) {
    return Vec3d{std::clamp(v.x, -3e38, 3e38), std::clamp(v.y, -3e38, 3e38), std::clamp(v.z, -3e38, 3e38)};
  };
  switch (random.below(12)) {
    case 0:
      return View::of_direction(lattice());
    case 1:
      return View::of_direction(somewhere(1));
    case 2:  // looks along an edge, so the face is edge-on at t = 1
      return View::of_direction(clamped(c - b));
    case 3:
      return View::of_eye(lattice());
    case 4:
      return View::of_eye(somewhere(3));
    case 5:
      return View::of_eye(a);
    case 6:
      return View::of_moving_eye(lattice(), lattice());
    case 7: {  // one component is far below the smallest float
      const Vec3d p = somewhere(1), q = lattice();
      return View::of_direction({std::ldexp(p.x, -static_cast<int>(random.below(1000))), q.y, q.z});
    }
    case 9:
    case 10: {  // the segment is a part of the viewer's path, and its ends need not be doubles
      const double before = static_cast<double>(random.below(9)), here = 1 + static_cast<double>(random.below(9)),
                   all = before + here + static_cast<double>(random.below(9));
      const Vec3d p = random.below(2) == 0 ? lattice() : clamped(a + somewhere(1)), q = somewhere(3);
      return View::of_moving_eye(p, q, LocalTime::between(0, before, all), LocalTime::between(0, before + here, all));
    }
    case 8:  // the eye is closer to a corner than a float can be
      return View::of_eye(a + std::ldexp(1.0, -static_cast<int>(random.below(300))) * somewhere(1));
    default:
      return View::of_moving_eye(clamped(a + somewhere(1)), clamped(c + somewhere(1)));
  }
}

TEST(ExactFacing, no_side_is_wrong_in_any_family) {
  const std::size_t wrong =
      test::judge_cases(20260, [](const Segment& segment, std::size_t face, test::Random& random) {
        const View view = some_view(segment, face, random);
        return fault_of(find_facing(segment, face, view), facing_polynomial(segment, face, view), random);
      });
  EXPECT_EQ(wrong, 0U);
}

TEST(ExactFacing, what_a_shutter_may_cull_shows_no_front) {
  const std::size_t wrong = test::judge_cases(
      4711,
      [](const Segment& segment, std::size_t face, test::Random& random) {
        const View view = some_view(segment, face, random);
        const double p = random.uniform(0, 1), q = random.below(4) == 0 ? 1 : random.uniform(0, 1);
        const double t0 = random.below(4) == 0 ? 0 : std::min(p, q), t1 = std::max(p, q);
        ControlNormals normals;
        face_control_normals(segment, {face, 1}, {&normals, 1});
        ShutterSide side{};
        sides_over(segment, {face, 1}, {&normals, 1}, view, t0, t1, {&side, 1});
        const WholePolynomial f = facing_polynomial(segment, face, view);
        bool is_front = false, is_back = false;
        const std::size_t steps = test::wanted_times(random) + 1;
        for (std::size_t i = 0; i <= steps; ++i) {
          const double t = t0 + (t1 - t0) * (static_cast<double>(i) / static_cast<double>(steps));
          const int sign = f.sign_at(std::min(t, t1));
          is_front |= sign > 0;
          is_back |= sign < 0;
        }
        if (is_front && side == ShutterSide::kBack) return std::string("culled, and shows its front");
        if (is_back && side == ShutterSide::kFront) return std::string("said to show its front alone");
        // sides_over() may return kBoth without seeing both sides if it cannot decide, but only if f has a root.
        if (side == ShutterSide::kBoth && f.count_roots() == 0) return std::string("undecided without a root");
        return std::string();
      },
      5);
  EXPECT_EQ(wrong, 0U);
}

std::string text_of(const Facing& facing) {
  std::string text = std::to_string(sign_of(facing.side));
  for (const FacingChange& change : facing.changes()) {
    std::array<char, 80> line;
    std::snprintf(line.data(), line.size(), ", %a to %a: %d %d", change.lower, change.upper, sign_of(change.before),
                  sign_of(change.after));
    text += line.data();
  }
  return text;
}

TEST(Facing, a_face_among_others_has_the_bits_of_the_face_alone_on_every_instruction_set) {
  constexpr std::size_t kFaces = 203;
  std::map<std::size_t, std::size_t> faces_by_changes;
  for (const Motion& motion : {fixtures::moderate_soup(kFaces), fixtures::large_soup(kFaces),
                               fixtures::soup({.face_count = kFaces, .seed = 43, .needle = 1e-6})}) {
    const Segment segment = motion.segment(0);
    std::vector<ControlNormals> normals(kFaces);
    face_control_normals(segment, {0, kFaces}, normals);
    for (const View& view : {View::of_direction({1, 2, -1}), View::of_moving_eye({1, -1, 0.5F}, {-1, 0.5F, 1})}) {
      std::vector<std::string> alone;
      for (std::size_t f = 0; f < kFaces; ++f) {
        const Facing facing = find_facing(segment, f, view);
        ++faces_by_changes[facing.count];
        alone.push_back(text_of(facing));
      }
      for (const auto target : supported_targets()) {
        const ScopedTarget scope(target);
        for (const IndexRange range : {IndexRange{0, kFaces}, IndexRange{1, 32}, IndexRange{7, 101}, {200, 3}}) {
          std::vector<Facing> found(range.count);
          find_facings(segment, range, std::span(normals).subspan(range.first, range.count), view, found);
          for (std::size_t i = 0; i < range.count; ++i)
            ASSERT_EQ(text_of(found[i]), alone[range.first + i]) << range.first + i << ", " << target_name(target);
        }
      }
    }
  }
  for (const std::size_t count : {0U, 1U, 2U}) EXPECT_GT(faces_by_changes[count], 30U) << count;
}

// Returns the exact value of a polynomial, given its Bernstein coefficients.
exact::Rational exact_value(const std::vector<double>& p, double at) {
  std::vector<exact::Rational> row(p.begin(), p.end());
  const exact::Rational t(at), s = 1 - t;
  for (std::size_t level = p.size() - 1; level > 0; --level) {
    for (std::size_t k = 0; k < level; ++k) row[k] = s * row[k] + t * row[k + 1];
  }
  return row[0];
}

TEST(Facing, a_bracket_is_right_for_coefficients_that_are_off_by_nothing) {
  // The coefficients have no errors here, so only rounding errors of the search itself could make a bracket (the
  // interval around a root) wrong.
  constexpr std::size_t kBlocks = 200;
  fixtures::Random random(4711);
  std::size_t found = 0;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    for (const std::size_t degree : {2U, 3U}) {
      SingleRoots roots{};
      for (std::size_t lane = 0; lane < kFacingBlock; ++lane) {
        for (std::size_t k = 0; k <= degree; ++k) roots.p[k][lane] = random.uniform(-1, 1);
        // In every fourth lane, the first or the last coefficient is made small, so that its sign is hardly certain.
        if (lane % 4 == 0)
          roots.p[lane % 8 == 0 ? 0 : degree][lane] *= std::ldexp(1, -static_cast<int>(random.below(50)));
      }
      find_single_roots(degree, kFacingBlock, roots);
      for (std::size_t lane = 0; lane < kFacingBlock; ++lane) {
        if (roots.before[lane] == 0) continue;
        ++found;
        std::vector<double> p;
        for (std::size_t k = 0; k <= degree; ++k) p.push_back(roots.p[k][lane]);
        const exact::Rational below = exact_value(p, roots.lower[lane]), above = exact_value(p, roots.upper[lane]);
        EXPECT_TRUE(roots.before[lane] > 0 ? below > 0 && above < 0 : below < 0 && above > 0)
            << "block " << block << ", degree " << degree << ", lane " << lane;
        EXPECT_LT(roots.upper[lane] - roots.lower[lane], 1e-4);
      }
    }
  }
  EXPECT_GT(found, kBlocks * kFacingBlock / 2);
}

// Makes a triangle in the plane z = 0 whose corner c moves from `from` to `to`.
Motion moving_corner(const fixtures::Point& from, const fixtures::Point& to) {
  return fixtures::make_motion(fixtures::make_soup(1), {{0, 0, 0}, {1, 0, 0}, from}, {{0, 0, 0}, {1, 0, 0}, to});
}

TEST(Facing, a_face_that_is_hidden_at_both_ends_may_be_seen_between) {
  // n(t) . z = (1 - 4 t)(3 - 4 t), so a viewer above sees the front, then the back, then the front again.
  const Motion motion = fixtures::make_motion(fixtures::make_soup(1), {{0, 0, 0}, {1, 0, 0}, {0, 3, 0}},
                                              {{0, 0, 0}, {-3, 0, 0}, {0, -1, 0}});
  const Facing below = find_facing(motion.segment(0), 0, View::of_direction({0, 0, -1}));
  ASSERT_EQ(below.count, 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const double root = i == 0 ? 0.25 : 0.75;
    EXPECT_LE(below.at[i].lower, root);
    EXPECT_GE(below.at[i].upper, root);
    EXPECT_LE(below.at[i].upper - below.at[i].lower, kWidestBracket);
  }
  EXPECT_EQ(below.first(), Side::kBack);
  EXPECT_EQ(below.at[0].after, Side::kFront);
  EXPECT_EQ(below.last(), Side::kBack);
  const View view = View::of_direction({0, 0, -1});
  ControlNormals normals;
  face_control_normals(motion.segment(0), {0, 1}, {&normals, 1});
  const auto over = [&](double t0, double t1) {
    ShutterSide side{};
    sides_over(motion.segment(0), {0, 1}, {&normals, 1}, view, t0, t1, {&side, 1});
    return side;
  };
  EXPECT_EQ(over(0, 1), ShutterSide::kBoth);
  EXPECT_EQ(over(0, 0.249), ShutterSide::kBack);
  EXPECT_EQ(over(0.251, 0.749), ShutterSide::kFront);
  EXPECT_EQ(over(0.5, 0.76), ShutterSide::kBoth);
  EXPECT_EQ(over(0.751, 1), ShutterSide::kBack);
}

TEST(Facing, a_face_that_only_touches_edge_on_keeps_its_side) {
  // n(t) . z = (1 - 2 t)^2 is zero only at t = 1/2 and does not change its sign.
  const Motion motion = fixtures::make_motion(fixtures::make_soup(1), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                              {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}});
  const Facing facing = find_facing(motion.segment(0), 0, View::of_direction({0, 0, 1}));
  ASSERT_EQ(facing.count, 1U);
  EXPECT_EQ(facing.at[0].lower, 0.5);
  EXPECT_EQ(facing.at[0].upper, 0.5);
  EXPECT_EQ(facing.at[0].before, Side::kFront);
  EXPECT_EQ(facing.at[0].after, Side::kFront);
}

TEST(Facing, an_eye_may_pass_the_plane_of_a_face_three_times) {
  // The face turns over twice, and the eye moves down through the plane of the face. The polynomial whose sign is the
  // visible side is then a cubic with three roots.
  const Motion motion = fixtures::make_motion(fixtures::make_soup(1), {{0, 0, 0}, {1, 0, 0}, {0, 3, 0}},
                                              {{0, 0, 0}, {-3, 0, 0}, {0, -1, 0}});
  const Facing facing = find_facing(motion.segment(0), 0, View::of_moving_eye({0.25F, 0.25F, 1}, {0.25F, 0.25F, -1}));
  ASSERT_EQ(facing.count, 3U);
  EXPECT_NEAR(facing.at[0].lower, 0.25, 1e-13);
  EXPECT_NEAR(facing.at[1].lower, 0.5, 1e-13);
  EXPECT_NEAR(facing.at[2].upper, 0.75, 1e-13);
  EXPECT_EQ(facing.first(), Side::kFront);
  EXPECT_EQ(facing.at[0].after, Side::kBack);
  EXPECT_EQ(facing.at[1].after, Side::kFront) << "the eye has passed the plane";
  EXPECT_EQ(facing.last(), Side::kBack);
}

TEST(Facing, a_face_without_area_has_no_side) {
  const Motion motion = moving_corner({2, 0, 0}, {3, 0, 0});
  const Facing facing = find_facing(motion.segment(0), 0, View::of_eye({0, 0, 1}));
  EXPECT_EQ(facing.count, 0U);
  EXPECT_EQ(facing.side, Side::kNone);
}

TEST(Facing, time_that_runs_back_mirrors_the_changes) {
  const Motion motion = fixtures::large_soup(2000, 5);
  Motion back = motion;
  std::swap(back.keyframes[0].positions, back.keyframes[1].positions);
  std::size_t changes = 0;
  for (std::size_t f = 0; f < 2000; ++f) {
    const Facing there = find_facing(motion.segment(0), f, View::of_moving_eye({1, 2, 3}, {-1, 0, 2}));
    const Facing here = find_facing(back.segment(0), f, View::of_moving_eye({-1, 0, 2}, {1, 2, 3}));
    ASSERT_EQ(there.count, here.count);
    for (std::size_t i = 0; i < there.count; ++i) {
      const FacingChange &p = there.at[i], &q = here.at[there.count - 1 - i];
      EXPECT_LE(p.lower, 1 - q.lower + 1e-16);
      EXPECT_GE(p.upper, 1 - q.upper - 1e-16);
      EXPECT_LE(p.upper - p.lower, kWidestBracket);
      EXPECT_EQ(p.before, q.after);
    }
    changes += there.count;
  }
  EXPECT_GT(changes, 500U);
}

// Makes a grid of triangles. Each vertex moves up or down independently.
Motion crumpling_grid(std::uint32_t size) {
  test::Random random(11);
  std::vector<fixtures::Point> from, to;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i <= size; ++i) {
    for (std::uint32_t k = 0; k <= size; ++k) {
      from.push_back({i / 10.0, k / 10.0, random.uniform(-0.2, 0.2)});
      to.push_back({i / 10.0, k / 10.0, random.uniform(-0.2, 0.2)});
      if (i == size || k == size) continue;
      const std::uint32_t a = i * (size + 1) + k, b = a + size + 1;
      corners.insert(corners.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  }
  const std::size_t count = from.size();
  return fixtures::make_motion(fixtures::make_triangles(count, std::move(corners)), from, to);
}

// Compares the silhouettes that the library finds with the exact sides of the two faces at every edge, at random
// instants.
TEST(Silhouettes, are_the_edges_whose_faces_show_different_sides) {
  const Motion motion = crumpling_grid(40);
  const Segment segment = motion.segment(0);
  const std::size_t faces = motion.topology.face_count();
  std::vector<ControlNormals> normals(faces);
  face_control_normals(segment, {0, faces}, normals);
  const View view = View::of_moving_eye({4, -5, 2}, {5, -4, 1});
  const std::vector<Silhouette> silhouettes = find_silhouettes(segment, normals, view);
  EXPECT_GT(silhouettes.size(), 100U);
  test::Random random(3);
  std::size_t open = 0, differing = 0;
  std::vector<WholePolynomial> polynomials;
  for (std::size_t f = 0; f < faces; ++f) polynomials.push_back(facing_polynomial(segment, f, view));
  for (int i = 0; i < 3; ++i) {
    const double t = random.uniform(0, 1);
    std::vector<int> signs;
    for (const WholePolynomial& f : polynomials) signs.push_back(f.sign_at(t));
    for (const Silhouette& one : silhouettes) {
      if (!(one.from[1] < t && t < one.to[0])) continue;
      ++open;
      EXPECT_LT(signs[one.faces[0]] * signs[one.faces[1]], 0);
    }
    // Counts, with a map of edges, the edges whose faces show different sides. The library must find the same number.
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<int>> edges;
    for (std::size_t f = 0; f < faces; ++f) {
      const auto face = motion.topology.face(f);
      for (std::size_t c = 0; c < face.size(); ++c) {
        const std::uint32_t p = face[c], q = face[(c + 1) % face.size()];
        edges[{std::min(p, q), std::max(p, q)}].push_back(signs[f]);
      }
    }
    for (const auto& [edge, own] : edges) differing += own.size() == 2 && own[0] * own[1] < 0 ? 1U : 0U;
  }
  EXPECT_EQ(open, differing);
  EXPECT_GT(open, 100U);
}

}  // namespace
}  // namespace chronormal::facing_test
