// Tests bounds of meshlets (clusters of faces) over an interval in which the mesh deforms. With these bounds,
// meshoptimizer's culling tests must not reject a meshlet with a face that is front-facing at some instant of the
// interval. Exact integer arithmetic decides whether a face is front-facing. Bounds from the positions at a single
// instant would fail this test. The mesh is a sheet of 512 faces; ./test --full exact adds the built-in morphs.

#include "chronormal/analysis/cones.h"

#include <gmpxx.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/input.h"
#include "tests/support/cone_oracle.h"
#include "tests/support/exact_cases.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"

namespace chronormal::cluster_bounds_test {
namespace {

using test::IntegerNormals;
using test::IntegerTime;
using test::IntegerVector;

static_assert(sizeof(ClusterBounds) == sizeof(meshopt_Bounds));
static_assert(offsetof(ClusterBounds, radius) == offsetof(meshopt_Bounds, radius));
static_assert(offsetof(ClusterBounds, cone_apex) == offsetof(meshopt_Bounds, cone_apex));
static_assert(offsetof(ClusterBounds, cone_axis) == offsetof(meshopt_Bounds, cone_axis));
static_assert(offsetof(ClusterBounds, cone_cutoff) == offsetof(meshopt_Bounds, cone_cutoff));
static_assert(offsetof(ClusterBounds, cone_axis_s8) == offsetof(meshopt_Bounds, cone_axis_s8));
static_assert(offsetof(ClusterBounds, cone_cutoff_s8) == offsetof(meshopt_Bounds, cone_cutoff_s8));

meshopt_Bounds as_meshopt(const ClusterBounds& bounds) {
  meshopt_Bounds result;
  std::memcpy(&result, &bounds, sizeof(result));
  return result;
}

// The functions below compute in float32 the culling tests that the comments of meshoptimizer.h describe. Only sums of
// squares are computed in double. In float32, squares of lengths below 1e-19 underflow, and for this reason alone every
// test that needs a length would fail.
Vec3f vector_of(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
float length_of(const Vec3f& v) { return static_cast<float>(std::sqrt(dot(to_double(v), to_double(v)))); }
Vec3f normalized_of(const Vec3f& v) { return (1 / length_of(v)) * v; }
bool rejects_by_apex(const meshopt_Bounds& b, const Vec3f& camera) {
  return dot(normalized_of(vector_of(b.cone_apex) - camera), vector_of(b.cone_axis)) >= b.cone_cutoff;
}
bool rejects_by_apex_s8(const meshopt_Bounds& b, const Vec3f& camera) {
  const Vec3f axis{b.cone_axis_s8[0] / 127.0F, b.cone_axis_s8[1] / 127.0F, b.cone_axis_s8[2] / 127.0F};
  return dot(normalized_of(vector_of(b.cone_apex) - camera), axis) >= b.cone_cutoff_s8 / 127.0F;
}
bool rejects_by_center(const meshopt_Bounds& b, const Vec3f& camera) {
  const Vec3f to_center = vector_of(b.center) - camera;
  return dot(to_center, vector_of(b.cone_axis)) >= b.cone_cutoff * length_of(to_center) + b.radius;
}
bool rejects_view(const meshopt_Bounds& b, const Vec3f& view) {
  return dot(normalized_of(view), vector_of(b.cone_axis)) >= b.cone_cutoff;
}

struct Meshlets {
  Motion motion;  // the faces are sorted by meshlet
  std::vector<std::vector<std::uint32_t>> faces;

  [[nodiscard]] std::vector<ClusterBounds> bounds(double t0, double t1) const {
    std::vector<ClusterBounds> all;
    for (const auto& of_one : faces) all.push_back(cluster_bounds(motion.segment(0), of_one, t0, t1));
    return all;
  }

  [[nodiscard]] Meshlets every(std::size_t step) const {
    Meshlets some{motion, {}};
    for (std::size_t m = 0; m < faces.size(); m += step) some.faces.push_back(faces[m]);
    return some;
  }
};

// Divides a motion into meshlets, built from the positions at the start of a segment.
Meshlets meshlets_of(Motion motion, std::size_t segment) {
  constexpr std::size_t kVertices = 32, kTriangles = 32;
  const auto corners = motion.topology.corners();
  const Segment s = motion.segment(segment);
  const std::size_t most = meshopt_buildMeshletsBound(corners.size(), kVertices, kTriangles);
  std::vector<meshopt_Meshlet> meshlets(most);
  std::vector<unsigned> vertices(most * kVertices);
  std::vector<unsigned char> triangles(most * kTriangles * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), triangles.data(), corners.data(),
                                        corners.size(), s.from.x, s.from.count, 3 * sizeof(float), kVertices,
                                        kTriangles, 0.5F));
  Meshlets result;
  std::vector<std::uint32_t> in_order;
  for (const meshopt_Meshlet& meshlet : meshlets) {
    std::vector<std::uint32_t> faces;
    for (unsigned f = 0; f < meshlet.triangle_count; ++f) {
      faces.push_back(static_cast<std::uint32_t>(in_order.size() / 3));
      for (unsigned c = 0; c < 3; ++c)
        in_order.push_back(vertices[meshlet.vertex_offset + triangles[meshlet.triangle_offset + 3 * f + c]]);
    }
    result.faces.push_back(faces);
  }
  const auto keys = motion.segments.at(segment);
  result.motion.topology = Topology::triangles(s.from.count, in_order).value();
  result.motion.keyframes = {motion.keyframes[keys.from], motion.keyframes[keys.to]};
  result.motion.connect_as_sequence();
  return result;
}

// The normal and the first corner of each face at one instant, as integers with a common scale.
struct Instant {
  std::vector<IntegerVector> normals, corners;
  mpz_class unit;  // the unit of the integers in `corners`, as a multiple of the unit of floats

  Instant(const Segment& segment, double t) {
    const IntegerTime time = IntegerTime::of(t);
    normals = IntegerNormals(segment).at(time);
    unit = mpz_class(1) << time.e;
    for (std::size_t f = 0; f < normals.size(); ++f) {
      const std::uint32_t v = segment.topology->face(f)[0];
      const Vec3f a = segment.from[v], b = segment.to[v];
      const auto at = [&](float x, float y) {
        return mpz_class((unit - time.t) * test::integer_of(x) + time.t * test::integer_of(y));
      };
      corners.push_back({at(a.x, b.x), at(a.y, b.y), at(a.z, b.z)});
    }
  }

  [[nodiscard]] bool is_front_facing(std::size_t f, const Vec3f& camera) const {
    const IntegerVector c{test::integer_of(camera.x), test::integer_of(camera.y), test::integer_of(camera.z)};
    mpz_class sum;
    for (std::size_t k = 0; k < 3; ++k) sum += normals[f][k] * (unit * c[k] - corners[f][k]);
    return sum > 0;
  }
  [[nodiscard]] bool is_front_facing_along(std::size_t f, const Vec3f& view) const {
    return test::exact_dot(normals[f], {test::integer_of(view.x), test::integer_of(view.y), test::integer_of(view.z)}) <
           0;
  }
};

struct Count {
  std::size_t rejected = 0, wrong = 0;
};
using Rejects = std::function<bool(const meshopt_Bounds&, const Vec3f&)>;

// Counts the pairs of a meshlet and a camera for which rejects() says that no face is front-facing. Also counts the
// wrong rejections, for which some face is front-facing at some instant.
Count judged(const Meshlets& meshlets, const std::vector<meshopt_Bounds>& bounds, const std::vector<Instant>& instants,
             const std::vector<Vec3f>& cameras, const Rejects& rejects, bool is_view) {
  Count result;
  for (std::size_t m = 0; m < bounds.size(); ++m) {
    for (const Vec3f& camera : cameras) {
      if (!rejects(bounds[m], camera)) continue;
      ++result.rejected;
      bool is_seen = false;
      for (const Instant& instant : instants) {
        for (const std::uint32_t f : meshlets.faces[m]) {
          is_seen =
              is_seen || (is_view ? instant.is_front_facing_along(f, camera) : instant.is_front_facing(f, camera));
        }
      }
      result.wrong += is_seen ? 1U : 0U;
    }
  }
  return result;
}

std::vector<meshopt_Bounds> bounds_of_an_instant(const Meshlets& meshlets, double t) {
  std::vector<float> positions;
  const Segment segment = meshlets.motion.segment(0);
  for (std::size_t v = 0; v < segment.from.count; ++v) {
    const Vec3d p = lerp(to_double(segment.from[v]), to_double(segment.to[v]), t);
    for (const double x : {p.x, p.y, p.z}) positions.push_back(static_cast<float>(x));
  }
  std::vector<meshopt_Bounds> result;
  for (const auto& faces : meshlets.faces) {
    std::vector<unsigned> indices;
    for (const std::uint32_t f : faces) {
      for (const std::uint32_t v : segment.topology->face(f)) indices.push_back(v);
    }
    result.push_back(meshopt_computeClusterBounds(indices.data(), indices.size(), positions.data(),
                                                  positions.size() / 3, 3 * sizeof(float)));
  }
  return result;
}

struct Interval {
  double t0, t1;
};

TEST(ExactClusterBounds, never_reject_a_meshlet_that_is_seen_at_any_instant) {
  fixtures::Random random(911);
  Count apex, apex_s8, center, view, rival;
  std::vector<Meshlets> meshes{meshlets_of(fixtures::smooth_morph(16), 0)};
  if (test::wanted_cases() > 100000) {
    for (const char* const name : {"cloth", "bend", "twist"})
      meshes.push_back(meshlets_of(make_builtin_morph(name).value(), 0).every(8));
  }
  for (const Meshlets& meshlets : meshes) {
    const Segment segment = meshlets.motion.segment(0);
    for (const auto& [t0, t1] : {Interval{0, 1}, Interval{0.3, 0.55}}) {
      std::vector<meshopt_Bounds> bounds;
      for (const ClusterBounds& b : meshlets.bounds(t0, t1)) bounds.push_back(as_meshopt(b));
      std::vector<Instant> instants;
      for (int i = 0; i <= 8; ++i) instants.emplace_back(segment, t0 + (t1 - t0) * i / 8);
      std::vector<Vec3f> cameras;
      for (int i = 0; i < 60; ++i) {
        const fixtures::Point p = random.in_cube(i % 3 == 0 ? 1 : 4);
        cameras.push_back(to_float({p[0], p[1], p[2]}));
      }
      // Puts some cameras just behind the apexes of the cones, where a small error of the bounds changes the result of
      // the test.
      for (std::size_t m = 0; m < bounds.size(); m += 5)
        cameras.push_back(vector_of(bounds[m].cone_apex) - 0.01F * vector_of(bounds[m].cone_axis));
      const auto add = [&](Count& to, const Rejects& rejects, bool is_view, const std::vector<meshopt_Bounds>& of) {
        const Count found = judged(meshlets, of, instants, cameras, rejects, is_view);
        to.rejected += found.rejected;
        to.wrong += found.wrong;
      };
      add(apex, rejects_by_apex, false, bounds);
      add(apex_s8, rejects_by_apex_s8, false, bounds);
      add(center, rejects_by_center, false, bounds);
      add(view, rejects_view, true, bounds);
      add(rival, rejects_by_apex, false, bounds_of_an_instant(meshlets, 0.5 * (t0 + t1)));
    }
  }
  const auto print = [](const char* what, const Count& c) {
    std::cout << "  " << what << ": " << c.rejected << " rejected, " << c.wrong << " of them seen\n";
  };
  print("apex", apex);
  print("apex, 8 bits", apex_s8);
  print("center", center);
  print("direction of view", view);
  print("meshoptimizer's bounds in the middle of the interval", rival);
  for (const Count& c : {apex, apex_s8, center, view}) {
    EXPECT_EQ(c.wrong, 0u);
    EXPECT_GT(c.rejected, 100u);
  }
  EXPECT_LE(apex_s8.rejected, apex.rejected);
  EXPECT_GT(rival.wrong, 20u);  // shows that the test detects wrong bounds
}

// Tests motions of one or a few faces from each family of hard motions, seen by cameras all around.
TEST(ExactClusterBounds, never_reject_hard_faces_that_are_seen) {
  fixtures::Random random(912);
  std::size_t rejected = 0;
  for (const test::HardMotions& family : test::hard_motions()) {
    for (int round = 0; round < 12; ++round) {
      const Motion motion = family.make(random);
      const Segment segment = motion.segment(0);
      const double t0 = round % 3 == 0 ? 0 : random.uniform(0, 1), t1 = round % 3 == 0 ? 1 : random.uniform(t0, 1);
      std::vector<Instant> instants;
      for (const double share : {0.0, 0.25, 0.5, 0.8, 1.0}) instants.emplace_back(segment, t0 + share * (t1 - t0));
      const std::size_t count = motion.topology.face_count();
      for (std::uint32_t f = 0; f < std::min<std::size_t>(count, 8); ++f) {
        const std::vector<std::uint32_t> faces =
            f % 4 == 0 && f + 1 < count ? std::vector<std::uint32_t>{f, f + 1} : std::vector<std::uint32_t>{f};
        const meshopt_Bounds bounds = as_meshopt(cluster_bounds(segment, faces, t0, t1));
        for (int i = 0; i < 12; ++i) {
          const fixtures::Point p = random.in_cube(1);
          const float size = bounds.radius * static_cast<float>(test::random_decade(random, -3, 3));
          const Vec3f camera = vector_of(bounds.center) + size * to_float({p[0], p[1], p[2]});
          if (!std::isfinite(camera.x + camera.y + camera.z)) continue;
          const bool by_apex = rejects_by_apex(bounds, camera), by_center = rejects_by_center(bounds, camera),
                     by_s8 = rejects_by_apex_s8(bounds, camera);
          if (!by_apex && !by_center && !by_s8) continue;
          ++rejected;
          for (const std::uint32_t face : faces) {
            for (const Instant& instant : instants)
              EXPECT_FALSE(instant.is_front_facing(face, camera)) << family.name << ", face " << face;
          }
        }
      }
    }
  }
  std::cout << "  " << rejected << " rejected\n";
  EXPECT_GT(rejected, 500u);
}

TEST(ClusterBounds, have_every_vertex_in_their_sphere_at_any_instant) {
  fixtures::Random random(913);
  for (const test::HardMotions& family : test::hard_motions()) {
    const Motion motion = family.make(random);
    const Segment segment = motion.segment(0);
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < motion.topology.face_count(); ++f) faces.push_back(f);
    const double t0 = random.uniform(0, 0.5), t1 = random.uniform(0.5, 1);
    const ClusterBounds bounds = cluster_bounds(segment, faces, t0, t1);
    const mpq_class radius(double{bounds.radius});
    for (const double t : {t0, t1, 0.5}) {
      for (const std::uint32_t v : motion.topology.corners()) {
        const Vec3f a = segment.from[v], b = segment.to[v];
        const auto off = [&](float x, float y, float c) {
          return mpq_class((1 - mpq_class(t)) * mpq_class(x) + mpq_class(t) * mpq_class(y) - mpq_class(c));
        };
        const mpq_class x = off(a.x, b.x, bounds.center[0]), y = off(a.y, b.y, bounds.center[1]),
                        z = off(a.z, b.z, bounds.center[2]);
        EXPECT_LE(mpq_class(x * x + y * y + z * z), mpq_class(radius * radius)) << family.name;
      }
    }
  }
}

// Polynomials with rational coefficients, as arrays of the coefficients of 1, x, x^2 and x^3.
using Rational = mpq_class;
using Powers = std::array<Rational, 4>;

Powers product(const Powers& a, const Powers& b) {
  Powers result;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; i + j < a.size(); ++j) result[i + j] += a[i] * b[j];
  return result;
}
Powers difference(const Powers& a, const Powers& b) {
  Powers result;
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}
Powers dot_of(const std::array<Powers, 3>& a, const std::array<Powers, 3>& b) {
  Powers result;
  for (std::size_t k = 0; k < 3; ++k) {
    const Powers term = product(a[k], b[k]);
    for (std::size_t i = 0; i < term.size(); ++i) result[i] += term[i];
  }
  return result;
}

// Returns the Bernstein coefficients of a cubic, given its coefficients of 1, x, x^2 and x^3. Each Bernstein
// coefficient is a weighted sum of the given coefficients, and the weights are ratios of binomial coefficients.
std::array<Rational, 4> bernstein_of(const Powers& p) {
  return {p[0], p[0] + p[1] / 3, p[0] + p[1] * 2 / 3 + p[2] / 3, p[0] + p[1] + p[2] + p[3]};
}

// The normal and the first corner of a triangle over [t0, t1], as cubics in a parameter that goes from 0 to 1.
struct MovingPlane {
  std::array<Powers, 3> normal, corner;

  MovingPlane(const Segment& segment, std::size_t f, double t0, double t1) {
    std::array<std::array<Powers, 3>, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = segment.topology->face(f)[c];
      const Vec3f a = segment.from[v], b = segment.to[v];
      const std::array<float, 3> from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
      for (std::size_t k = 0; k < 3; ++k) {
        const Rational start{from[k]}, by = Rational(to[k]) - start;
        corners[c][k][0] = start + Rational(t0) * by;
        corners[c][k][1] = (Rational(t1) - Rational(t0)) * by;
      }
    }
    std::array<Powers, 3> e, g;
    for (std::size_t k = 0; k < 3; ++k) {
      e[k] = difference(corners[1][k], corners[0][k]);
      g[k] = difference(corners[2][k], corners[0][k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      normal[k] = difference(product(e[i], g[j]), product(e[j], g[i]));
    }
    corner = corners[0];
  }
};

std::array<Powers, 3> constant(const float (&v)[3]) {
  std::array<Powers, 3> result;
  for (std::size_t k = 0; k < 3; ++k) result[k][0] = Rational(v[k]);
  return result;
}

// The library moves the apex of a cone back from the center of the meshlet only as far as the Bernstein coefficients of
// all its faces require. The test makes sure that each of the four coefficients decides in some cases.
TEST(ClusterBounds, have_the_nearest_apex_that_bernstein_coefficients_put_behind_all_faces) {
  constexpr std::uint64_t kSeed = 914;
  fixtures::Random random(kSeed);
  std::array<std::size_t, 4> decided{};
  for (int round = 0; round < 600; ++round) {
    const Motion motion = fixtures::soup(
        {.face_count = 1 + random.below(2), .seed = kSeed + random.below(100000), .motion = random.uniform(0.1, 1)});
    const Segment segment = motion.segment(0);
    const double t0 = round % 3 == 0 ? 0 : random.uniform(0, 0.5), t1 = round % 3 == 0 ? 1 : random.uniform(0.5, 1);
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < motion.topology.face_count(); ++f) faces.push_back(f);
    const ClusterBounds bounds = cluster_bounds(segment, faces, t0, t1);
    if (!(bounds.cone_cutoff < 1)) continue;
    const std::array<Powers, 3> center = constant(bounds.center), axis = constant(bounds.cone_axis);
    Rational s = 0;
    std::size_t deciding = 4;
    for (const std::uint32_t f : faces) {
      const MovingPlane plane(segment, f, t0, t1);
      std::array<Powers, 3> to_center;
      for (std::size_t k = 0; k < 3; ++k) to_center[k] = difference(center[k], plane.corner[k]);
      const std::array<Rational, 4> height = bernstein_of(dot_of(plane.normal, to_center)),
                                    along = bernstein_of(dot_of(plane.normal, axis));
      for (std::size_t k = 0; k < along.size(); ++k) {
        ASSERT_GT(along[k], 0) << "seed " << kSeed << ", round " << round;
        const Rational back = height[k] / along[k];
        if (back > s) deciding = k;
        s = std::max(s, back);
      }
    }
    if (deciding < 4) ++decided[deciding];
    double off = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Rational expected = center[k][0] - s * axis[k][0];
      off = std::fmax(off, std::fabs(Rational(Rational(bounds.cone_apex[k]) - expected).get_d()));
    }
    EXPECT_LE(off, 1e-4 * (1 + s.get_d())) << "seed " << kSeed << ", round " << round << ", coefficient " << deciding;
  }
  std::cout << "  seed " << kSeed << ", cases that each coefficient decides:";
  for (const std::size_t count : decided) {
    std::cout << ' ' << count;
    EXPECT_GT(count, 20u);
  }
  std::cout << '\n';
}

TEST(ClusterBounds, say_what_can_always_and_what_can_never_be_seen) {
  const fixtures::Point o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, minus_y{0, -1, 0};
  const Motion motion = test::soup_of({{{o, x, minus_y}, {o, x, y}}, {{o, x, x}, {o, y, y}}, {{o, x, y}, {o, x, y}}});
  const Segment segment = motion.segment(0);
  const auto of = [&](const std::vector<std::uint32_t>& faces) {
    return as_meshopt(cluster_bounds(segment, faces, 0, 1));
  };
  const meshopt_Bounds turning = of({0}), line = of({1}), still = of({2}), both = of({1, 2}), none = of({});
  for (const Vec3f& camera : {Vec3f{0, 0, 9}, Vec3f{0, 0, -9}, Vec3f{3, 2, -1}}) {
    EXPECT_FALSE(rejects_by_apex(turning, camera));
    EXPECT_FALSE(rejects_by_apex_s8(turning, camera));
    EXPECT_FALSE(rejects_by_center(turning, camera));
    EXPECT_TRUE(rejects_by_apex(line, camera));
    EXPECT_EQ(rejects_by_apex(still, camera), camera.z < 0);
    EXPECT_EQ(rejects_by_apex(both, camera), camera.z < 0);
  }
  EXPECT_EQ(turning.cone_cutoff_s8, 127);
  EXPECT_LT(still.cone_cutoff, 2e-6F);
  EXPECT_EQ(still.cone_axis_s8[2], 127);
  EXPECT_LE(still.cone_cutoff_s8, 1);
  EXPECT_EQ(none.radius, 0);
}

}  // namespace
}  // namespace chronormal::cluster_bounds_test
