// PathCurves: normals of degree 6 in float32 against the positions of the curves, the elements that it evaluates in
// double, and the same bits on every instruction set.

#include "chronormal/normals/path_curves.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "simd/targets.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"
#include "tests/support/reference_elements.h"

namespace chronormal::path_curves_test {
namespace {

using Controls = PolynomialNormals<3>;

// A grid whose vertices move on cubics that bend as much as they are long.
struct Bending {
  Topology topology;
  PolynomialSegment<3> segment;

  explicit Bending(std::size_t cells, double size, double scale = 1) : topology(fixtures::box_grid(cells).topology) {
    fixtures::Random random(17);
    segment.topology = &topology;
    for (const auto& p : fixtures::box_grid(cells).points) {
      for (std::vector<Vec3d>& control : segment.control)
        control.push_back(scale * Vec3d{p[0] + random.uniform(-size, size), p[1] + random.uniform(-size, size),
                                        p[2] + random.uniform(-size, size)});
    }
  }
  // The positions at t, by the cubics of the textbook in long double.
  [[nodiscard]] reference::Mesh at(double time) const {
    const reference::Real t = time, s = 1 - t;
    const reference::Real weights[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    reference::Mesh mesh;
    for (std::size_t f = 0; f < topology.face_count(); ++f)
      mesh.faces.emplace_back(topology.face(f).begin(), topology.face(f).end());
    for (std::size_t v = 0; v < topology.vertex_count(); ++v) {
      reference::Vector p{};
      for (std::size_t k = 0; k < 4; ++k)
        p = reference::add(p, reference::scaled(weights[k], test::to_real(segment.control[k][v])));
      mesh.from.push_back(p);
    }
    mesh.to = mesh.from;
    return mesh;
  }
};

std::vector<float> evaluated(const PathCurves& curves, double t, Threads threads = Threads::kOne) {
  std::vector<float> result(3 * curves.size());
  (void)curves.unit_normals(t, VectorView<float>::packed(result), threads);
  return result;
}

Vec3d vector(const std::vector<float>& packed, std::size_t i) {
  return to_double(VectorView<const float>::packed(std::span(packed))[i]);
}

constexpr double kTimes[] = {0, 1e-30, 0.125, 0.34375, 0.5, 0.8, 1};

TEST(PathCurves, faces_and_vertices_are_within_their_angle_of_recomputing) {
  for (const double scale : {1.0, 1e-12, 1e15}) {
    const Bending mesh(6, 0.1, scale);
    const NormalGroups groups = NormalGroups::of_vertices(mesh.topology, separate_points(mesh.topology.vertex_count()));
    const PathCurves faces(all_path_normals(mesh.segment)), vertices(all_path_normals(mesh.segment, groups));
    EXPECT_LT(faces.flagged_count(), faces.size());
    for (const double t : kTimes) {
      const reference::Mesh truth = mesh.at(t);
      const auto corners = test::reference_corners(truth, groups);
      const std::vector<float> of_faces = evaluated(faces, t), of_vertices = evaluated(vertices, t);
      for (std::size_t f = 0; f < faces.size(); ++f)
        EXPECT_LT(static_cast<double>(
                      reference::angle(test::to_real(vector(of_faces, f)), reference::vector_area(truth, f, 0))),
                  kPathAngle)
            << f << " at " << t << " scale " << scale;
      for (std::size_t e = 0; e < groups.size(); ++e)
        EXPECT_LT(static_cast<double>(reference::angle(test::to_real(vector(of_vertices, e)),
                                                       reference::element_normal(truth, corners[e], "area", 0))),
                  kPathAngle)
            << e << " at " << t;
    }
  }
}

// Seven control normals whose curve nearly vanishes at t = 1/2: |n| is as long as `rest` there, and turns fast.
Controls nearly_vanishing(double rest) {
  Controls n;
  for (std::size_t k = 0; k < n.size(); ++k) {
    const double along = static_cast<double>(k) / 3 - 1;
    n[k] = {along, rest, 0.3 * rest * along};
  }
  return n;
}

TEST(PathCurves, elements_that_float32_cannot_carry_are_evaluated_in_double) {
  for (const double rest : {1.0, 0.5, 0.2, 1e-2, 1e-4, 1e-7}) {
    const std::vector<Controls> normals(1, nearly_vanishing(rest));
    const PathCurves curves(normals);
    EXPECT_EQ(curves.flagged_count(), rest < 0.1 ? 1U : 0U) << rest;
    double worst = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double t = i / 1000.0;
      const Vec3d right = unit_normal_at(normals[0], t).vector, found = vector(evaluated(curves, t), 0);
      worst = std::max(worst, length(cross(right, found)));
    }
    EXPECT_LT(worst, kPathAngle) << rest;
  }
}

TEST(PathCurves, many_random_elements_keep_their_angle_at_every_t) {
  fixtures::Random random(23);
  std::vector<Controls> normals(3000);
  for (Controls& n : normals) {
    // Directions lie in narrow cones or anywhere, and lengths differ by factors of up to 2^60.
    const double spread = std::pow(2.0, random.uniform(-8, 4)), lengths = random.uniform(0, 30);
    for (Vec3d& c : n)
      c = std::exp2(random.uniform(-lengths, lengths)) *
          Vec3d{1 + random.uniform(-spread, spread), random.uniform(-spread, spread), random.uniform(-spread, spread)};
  }
  const PathCurves curves(normals);
  EXPECT_GT(curves.flagged_count(), 100U);
  EXPECT_LT(curves.flagged_count(), 2500U);
  for (int i = 0; i <= 64; ++i) {
    const double t = i / 64.0;
    const std::vector<float> found = evaluated(curves, t);
    for (std::size_t e = 0; e < normals.size(); ++e) {
      const UnitNormal right = unit_normal_at(normals[e], t);
      const double angle = std::asin(std::min(1.0, length(cross(right.vector, vector(found, e)))));
      EXPECT_LT(angle, kPathAngle) << e << " at " << t;
    }
  }
}

TEST(PathCurves, elements_without_a_normal_are_zero_and_counted) {
  std::vector<Controls> normals(20, nearly_vanishing(1));
  normals[3] = normals[18] = Controls{};
  const PathCurves curves(normals);
  std::vector<float> result(60, 7.0F);
  EXPECT_EQ(curves.unit_normals(0.3, VectorView<float>::packed(result)), 2U);
  EXPECT_EQ(vector(result, 3), Vec3d{});
  EXPECT_EQ(vector(result, 18), Vec3d{});
  EXPECT_NEAR(length(vector(result, 19)), 1, 1e-6);
  EXPECT_EQ(curves.unit_normals(std::nan(""), VectorView<float>::packed(result)), 20U);
  EXPECT_EQ(vector(result, 19), Vec3d{});
  EXPECT_EQ(evaluated(curves, -1), evaluated(curves, 0)) << "what lies outside is moved to the nearer end";
  EXPECT_EQ(evaluated(curves, 7), evaluated(curves, 1));
  EXPECT_EQ(PathCurves().unit_normals(0.5, {}), 0U);
}

TEST(PathCurves, are_the_same_bits_on_every_instruction_set_and_number_of_threads_and_in_every_layout) {
  // There are more than two pieces, the last of which ends within a block.
  const Bending mesh(60, 0.02);
  const std::vector<Controls> normals = all_path_normals(mesh.segment);
  ASSERT_GT(normals.size(), 2U * 8192);
  std::vector<std::vector<float>> first;
  for (const std::int64_t target : supported_targets()) {
    const ScopedTarget scoped(target);
    for (const std::size_t threads : {1U, 3U}) {
      const ThreadLimit limit(threads);
      const std::span<const Controls> some = std::span(normals).first(normals.size() - 5);
      const PathCurves curves(some, Threads::kAll);
      const std::size_t n = curves.size();
      std::vector<std::vector<float>> found;
      for (const double t : kTimes) {
        found.push_back(evaluated(curves, t, Threads::kAll));
        std::vector<float> planes(3 * n), spread(4 * n);
        float* const p = planes.data();
        (void)curves.unit_normals(t, VectorView<float>::planes(p, p + n, p + 2 * n, n), Threads::kAll);
        float* const s = spread.data();
        (void)curves.unit_normals(t, VectorView<float>{s, s + 1, s + 2, n, 4}, Threads::kAll);
        for (std::size_t i = 0; i < n; ++i) {
          for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(found.back()[3 * i + c], p[c * n + i]) << i;
            ASSERT_EQ(found.back()[3 * i + c], s[4 * i + c]) << i;
          }
        }
      }
      if (first.empty()) first = found;
      EXPECT_EQ(found, first) << target_name(target) << " with " << threads << " threads";
    }
  }
}

TEST(PathCurves, of_a_segment_are_those_of_all_of_its_control_normals) {
  const Bending mesh(60, 0.05);  // in three pieces, and bent so far that some elements are flagged
  const NormalGroups groups = NormalGroups::of_vertices(mesh.topology, separate_points(mesh.topology.vertex_count()));
  ASSERT_GT(groups.size(), 2U * 8192);
  std::vector<Controls> of_faces(mesh.topology.face_count()), of_vertices(groups.size());
  polynomial_face_normals<3>(mesh.segment, {0, of_faces.size()}, of_faces);
  polynomial_group_normals<3>(groups, of_faces, {0, of_vertices.size()}, of_vertices);
  const std::vector<Controls> all_of_faces = all_path_normals(mesh.segment),
                              all_of_vertices = all_path_normals(mesh.segment, groups);
  const auto are_equal = [](const Controls& a, const Controls& b) { return a == b; };
  EXPECT_TRUE(std::equal(of_faces.begin(), of_faces.end(), all_of_faces.begin(), all_of_faces.end(), are_equal));
  EXPECT_TRUE(
      std::equal(of_vertices.begin(), of_vertices.end(), all_of_vertices.begin(), all_of_vertices.end(), are_equal));
  const PathCurves faces{std::span<const Controls>(of_faces)}, vertices{std::span<const Controls>(of_vertices)};
  EXPECT_GT(faces.flagged_count(), 10U);
  EXPECT_GT(vertices.flagged_count(), 10U);
  const auto expect_right = [](const PathCurves& curves, const std::vector<Controls>& normals) {
    const std::vector<float> found = evaluated(curves, 0.34375);
    for (std::size_t i = 0; i < normals.size(); ++i)
      ASSERT_LT(length(vector(found, i) - unit_normal_at(normals[i], 0.34375).vector), 1.1e-6) << i;
  };
  expect_right(faces, of_faces);
  expect_right(vertices, of_vertices);
  for (const std::size_t threads : {1U, 3U}) {
    const ThreadLimit limit(threads);
    const PathCurves made_of_faces(mesh.segment, Threads::kAll), made_of_vertices(mesh.segment, groups, Threads::kAll);
    EXPECT_EQ(made_of_faces.flagged_count(), faces.flagged_count());
    EXPECT_EQ(made_of_vertices.flagged_count(), vertices.flagged_count());
    for (const double t : kTimes) {
      EXPECT_EQ(evaluated(made_of_faces, t), evaluated(faces, t)) << t << " with " << threads << " threads";
      EXPECT_EQ(evaluated(made_of_vertices, t), evaluated(vertices, t)) << t << " with " << threads << " threads";
    }
  }
}

// A double as a whole number of 2^-400, which all control positions of these stars are.
mpz_class whole(double value) {
  int exponent = 0;
  mpz_class result(std::ldexp(std::frexp(value, &exponent), 53));
  return result << static_cast<unsigned>(std::max(exponent - 53 + 400, 0));
}

// The sum of the normals of some faces at t, in whole numbers.
test::IntegerVector exact_sum(const PolynomialSegment<3>& path, std::span<const std::uint32_t> faces, double time) {
  const test::IntegerTime t = test::IntegerTime::of(time);
  const mpz_class s = (mpz_class(1) << t.e) - t.t;
  const mpz_class weights[4] = {s * s * s, 3 * s * s * t.t, 3 * s * t.t * t.t, t.t * t.t * t.t};
  const auto at = [&](std::uint32_t v) {
    test::IntegerVector p;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3d& c = path.control[k][v];
      for (std::size_t i = 0; i < 3; ++i) p[i] += weights[k] * whole(i == 0 ? c.x : i == 1 ? c.y : c.z);
    }
    return p;
  };
  test::IntegerVector sum;
  for (const std::uint32_t f : faces) {
    const auto face = path.topology->face(f);
    const test::IntegerVector a = at(face[0]), b = at(face[1]), c = at(face[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      sum[k] += (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
    }
  }
  return sum;
}

TEST(PathCurves, of_vertices_whose_faces_cancel_are_exact) {
  constexpr std::uint64_t kSeed = 4952;
  fixtures::Random random(kSeed);
  for (int star = 0; star < 40; ++star) {
    const Motion motion = test::cancelling_star(random);
    const Segment straight = motion.segment(0);
    PolynomialSegment<3> path{&motion.topology, {}, 0, 1};
    // In eighths, so that control positions are whole numbers as well.
    const double ways[] = {0, static_cast<double>(random.below(17)) / 8 - 1, 0.75, 1};
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t v = 0; v < straight.from.count; ++v)
        path.control[k].push_back(lerp(to_double(straight.from[v]), to_double(straight.to[v]), ways[k]));
    }
    const NormalGroups groups =
        NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
    const PathCurves curves(path, groups);
    for (const double t : {0.0, 1.0, 0.5, random.uniform(0, 1)}) {
      const std::vector<float> found = evaluated(curves, t);
      for (std::size_t e = 0; e < groups.size(); ++e) {
        const test::IntegerVector n = exact_sum(path, groups.faces(e), t);
        if (test::is_zero(n)) continue;
        const Vec3f u{found[3 * e], found[3 * e + 1], found[3 * e + 2]};
        EXPECT_LE(test::angle_between(u, test::direction_of(n)), 2e-6)
            << "star " << star << " from seed " << kSeed << ", vertex " << e << " at " << t;
      }
    }
  }
}

}  // namespace
}  // namespace chronormal::path_curves_test
