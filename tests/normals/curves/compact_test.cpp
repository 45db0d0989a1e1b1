// Tests compact curves: every element must keep CurveOptions::tolerance, and curves must be stored in the formats that
// are documented for this tolerance.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/evaluate.h"
#include "normals/curves/kernels/pack.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/float_tiles.h"
#include "tests/support/hard_normals.h"

namespace chronormal::compact_test {
namespace {

using test::angle_to;
using test::largest_of;

constexpr std::array<double, 13> kTolerances{1e-6, 2e-6, 1e-5, 6e-5, 1e-4, 1.7e-4, 2e-4,
                                             5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 0.1};

// The smallest |n(t)| that the tests judge, as a share of the sum of the lengths of the terms of n(t). If n(t) is
// shorter, n(t) in double is not accurate enough for the tolerances of this file.
constexpr double kBelowDouble = 1e-9;

std::vector<Vec3f> unit_normals(const NormalCurves& curves, double t) {
  std::vector<float> packed(3 * curves.size());
  (void)curves.unit_normals(t, VectorView<float>::packed(packed.data(), curves.size()));
  std::vector<Vec3f> result;
  for (std::size_t i = 0; i < curves.size(); ++i)
    result.push_back({packed[3 * i], packed[3 * i + 1], packed[3 * i + 2]});
  return result;
}

bool has_direction(const ControlNormals& c, double t) {
  const test::Real s = 1 - test::Real{t};
  const test::Real terms = s * s * max_abs(c.n0) + 2 * t * s * max_abs(c.m) + test::Real{t} * t * max_abs(c.n1);
  return test::length(test::normal_in_long_double(c, t)) > kBelowDouble * terms;
}

void expect_unit_length(const Vec3f& u, double t) {
  const double square = double{u.x} * u.x + double{u.y} * u.y + double{u.z} * u.z;
  EXPECT_NEAR(std::sqrt(square), 1, 2.5e-7) << "t = " << t;
}

void describe(const ControlNormals& c, double t) {
  const auto show = [](const Vec3d& v) { std::cout << "{" << v.x << ", " << v.y << ", " << v.z << "}"; };
  const auto precision = std::cout.precision(17);
  std::cout << "  {";
  show(c.n0);
  std::cout << ", ";
  show(c.m);
  std::cout << ", ";
  show(c.n1);
  std::cout << "}, t = " << t << "\n";
  std::cout.precision(precision);
}

// Prepares each element without neighbours. Otherwise, neighbours that need more accuracy could give the block of the
// element a more precise format.
TEST(CompactCurves, keep_the_tolerance_of_every_element_alone) {
  for (const test::HardFamily& family : test::hard_families()) {
    SCOPED_TRACE(family.name);
    std::map<std::size_t, double> share_of_bytes;
    std::size_t judged = 0, left_out = 0;
    fixtures::Random random(71);
    for (int i = 0; i < 200; ++i) {
      const ControlNormals c = family.make(random);
      const auto times = test::hard_times(c, random);
      for (const double tolerance : kTolerances) {
        const NormalCurves curves(std::span(&c, 1), {tolerance});
        const std::size_t bytes = curves.flagged_count() == 1 ? 72 : curves.byte_counts().front().bytes;
        for (const double t : times) {
          if (!has_direction(c, t)) {
            ++left_out;
            continue;
          }
          ++judged;
          const Vec3f u = unit_normals(curves, t).front();
          const double error = angle_to(u, c, t);
          expect_unit_length(u, t);
          if (!(error <= tolerance)) {
            ADD_FAILURE() << "tolerance " << tolerance << ", off by " << error << " in " << bytes << " bytes";
            describe(c, t);
            return;
          }
          share_of_bytes[bytes] = std::max(share_of_bytes[bytes], error / tolerance);
        }
      }
    }
    EXPECT_GT(judged, 10 * left_out);
    std::cout << "  " << family.name << ": error / tolerance";
    for (const auto& [bytes, share] : share_of_bytes) std::cout << ", in " << bytes << " bytes " << share;
    std::cout << "\n";
  }
}

TEST(CompactCurves, keep_the_tolerance_among_neighbours_of_any_size_kind_and_degree) {
  for (const std::uint64_t seed : {72u, 73u, 74u}) {
    fixtures::Random random(seed);
    std::vector<ControlNormals> normals;
    // Adds runs of elements of one family, with lengths from one element to a few blocks. Some elements are zero.
    while (normals.size() < 3000) {
      const auto& family = test::hard_families()[random.below(test::hard_families().size())];
      const double scale =
          // The scale is 1 or, in a quarter of the cases, a random power of two between 1e-271 and 1e301.
          random.below(4) == 0 ? std::ldexp(1, static_cast<int>(random.below(1900)) - 900) : 1;
      for (std::size_t left = random.below(3) == 0 ? random.below(90) : 1; left > 0; --left)
        normals.push_back(random.below(40) == 0 ? ControlNormals{} : test::scaled_by(scale, family.make(random)));
    }
    for (const double tolerance : kTolerances) {
      const NormalCurves curves(normals, {tolerance});
      EXPECT_EQ(curves.keeps_lengths(), tolerance <= kExactTolerance);
      for (const double t : {0.0, 1e-6, 1e-3, 0.25, 1.0 / 3, 0.5, 0.7, 1.0}) {
        const auto result = unit_normals(curves, t);
        for (std::size_t i = 0; i < normals.size(); ++i) {
          if (largest_of(normals[i]) == 0) {
            ASSERT_EQ(result[i], Vec3f{}) << i;
          } else if (has_direction(normals[i], t)) {
            ASSERT_LE(angle_to(result[i], normals[i], t), tolerance)
                << "element " << i << ", t = " << t << ", seed " << seed;
            expect_unit_length(result[i], t);
          }
        }
      }
    }
  }
}

TEST(CompactCurves, keep_the_tolerance_at_every_scale_that_double_has) {
  fixtures::Random random(75);
  for (int exponent = -1010; exponent <= 1010; exponent += 20) {
    for (const test::HardFamily& family : test::hard_families()) {
      const ControlNormals c = test::scaled_by(std::ldexp(1, exponent), family.make(random));
      for (const double tolerance : {1e-6, 2e-4, 1e-3, 1e-2, 0.1}) {
        const NormalCurves curves(std::span(&c, 1), {tolerance});
        for (const double t : {0.0, 0.3, test::hardest_time(c), 1.0}) {
          // Control normals that are so small that double has lost some of their digits are skipped.
          if (!has_direction(c, t) || largest_of(c) < 0x1p-960) continue;
          const Vec3f u = unit_normals(curves, t).front();
          ASSERT_LE(angle_to(u, c, t), tolerance) << family.name << " times 2^" << exponent << ", t = " << t;
          expect_unit_length(u, t);
        }
      }
    }
  }
}

// The normals of all vertices of a triangle mesh at one t, and for each vertex the sum of the lengths of the normals
// that were added. All sums are made face by face, in long double.
struct VerticesAt {
  std::vector<std::array<long double, 3>> normals;
  std::vector<long double> lengths;

  VerticesAt(const Segment& segment, double t) : normals(segment.from.count), lengths(segment.from.count) {
    using Real3 = std::array<long double, 3>;
    const auto at = [&](std::uint32_t v) {
      const Vec3f from = segment.from[v], to = segment.to[v];
      const auto lerp = [t](long double a, long double b) { return a + t * (b - a); };
      return Real3{lerp(from.x, to.x), lerp(from.y, to.y), lerp(from.z, to.z)};
    };
    for (std::size_t f = 0; f < segment.topology->face_count(); ++f) {
      const auto face = segment.topology->face(f);
      const Real3 a = at(face[0]), b = at(face[1]), c = at(face[2]);
      Real3 cross;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        cross[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
      }
      for (const std::uint32_t v : face) {
        for (std::size_t k = 0; k < 3; ++k) normals[v][k] += cross[k];
        lengths[v] += std::hypot(cross[0], cross[1], cross[2]);
      }
    }
  }

  // Returns the angle in radians between the normal of vertex v and a direction, or 0 if the vertex has no normal.
  [[nodiscard]] double angle_to(const Vec3f& u, std::size_t v) const {
    const auto& n = normals[v];
    const long double length = std::hypot(n[0], n[1], n[2]);
    if (!(length > kBelowDouble * lengths[v])) return 0;
    const long double along = (u.x * n[0] + u.y * n[1] + u.z * n[2]) / length;
    const long double across =
        std::hypot(u.y * n[2] - u.z * n[1], u.z * n[0] - u.x * n[2], u.x * n[1] - u.y * n[0]) / length;
    return static_cast<double>(std::atan2(across, along));
  }
};

// The library sums the normals of vertices in float32 if float32 is accurate enough. The faces here become flatter and
// flatter, down to needles and slivers. In one of two variants, faces in the middle of the mesh are less flat than
// faces at its ends, so float32 is accurate enough only for some of sixteen neighbours.
TEST(CompactCurves, keep_the_tolerance_of_vertices_whatever_they_are_added_up_in) {
  for (int flat = 0; flat <= 24; flat += 2) {
    for (const bool along : {false, true}) {
      const Motion motion = test::with_positions(fixtures::smooth_morph(24), [&](const fixtures::Point& p) {
        const double share = std::pow(0.5, flat * (along ? std::fabs(p[0]) : 1));
        // The mesh is slanted, so its cross products are sums of large terms that cancel.
        return fixtures::Point{p[0] + 3, share * p[1] + p[0] - 5, share * p[2] - p[0]};
      });
      const Segment segment = motion.segment(0);
      const NormalGroups groups =
          NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
      for (const double tolerance : {2.4e-4, 2.5e-4, 1e-3, 1e-2, 0.2}) {
        const NormalCurves curves = NormalCurves::of_groups(segment, groups, {tolerance});
        for (int step = 0; step <= 32; ++step) {
          const double t = step / 32.0;
          const VerticesAt right(segment, t);
          const std::vector<Vec3f> shown = unit_normals(curves, t);
          for (std::size_t v = 0; v < shown.size(); ++v) {
            ASSERT_LE(right.angle_to(shown[v], v), tolerance) << "vertex " << v << ", t = " << t << ", flat " << flat;
          }
        }
      }
    }
  }
}

// Vertices that hardly move are stored as straight curves, which take fewer bytes, unless float32 proves that their
// curves bend.
TEST(CompactCurves, keep_the_tolerance_of_vertices_that_hardly_move) {
  fixtures::Random random(20261126);
  std::cout << "  seed 20261126\n";
  std::size_t straight = 0, bending = 0;
  for (int round = 0; round < 24; ++round) {
    const double flat = std::ldexp(1, -static_cast<int>(random.below(10)));
    const Motion whole = test::with_positions(fixtures::smooth_morph(16), [&](const fixtures::Point& p) {
      return fixtures::Point{p[0] + 3, flat * p[1] + p[0] - 5, flat * p[2] - p[0]};
    });
    const Motion motion = test::of_small_steps(whole, std::ldexp(1, -2 - round), random);
    const Segment segment = motion.segment(0);
    const NormalGroups groups =
        NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
    for (const double tolerance : {2.5e-4, 1e-3, 1e-2}) {
      const NormalCurves curves = NormalCurves::of_groups(segment, groups, {tolerance});
      straight += curves.degree_counts()[0] + curves.degree_counts()[1];
      bending += curves.degree_counts()[2];
      for (int step = 0; step <= 16; ++step) {
        const double t = step / 16.0;
        const VerticesAt right(segment, t);
        const std::vector<Vec3f> shown = unit_normals(curves, t);
        for (std::size_t v = 0; v < shown.size(); ++v)
          ASSERT_LE(right.angle_to(shown[v], v), tolerance) << "vertex " << v << ", t = " << t << ", round " << round;
      }
    }
  }
  EXPECT_GT(straight, 5000U);
  EXPECT_GT(bending, 5000U);
}

TEST(CompactCurves, keep_tolerances_without_measure) {
  fixtures::Random random(76);
  for (const double tolerance : {0.2, 0.3, 0.5, 1.0, 1.5, 2.5, 100.0, std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 2000; ++i) {
      const ControlNormals c = test::hard_element(random, false);
      const NormalCurves curves(std::span(&c, 1), {tolerance});
      const double t = i % 2 == 0 ? random.uniform(0, 1) : test::hardest_time(c);
      if (!has_direction(c, t)) continue;
      const Vec3f u = unit_normals(curves, t).front();
      ASSERT_LE(angle_to(u, c, t), tolerance);
      expect_unit_length(u, t);
    }
  }
}

TEST(CompactCurves, no_tolerance_at_all_is_the_exact_one) {
  fixtures::Random random(77);
  std::vector<ControlNormals> normals;
  for (int i = 0; i < 500; ++i) normals.push_back(test::hard_element(random, true));
  const NormalCurves exact(normals);
  for (const double tolerance : {0.0, -1.0, 1e-9, std::numeric_limits<double>::quiet_NaN()}) {
    const NormalCurves curves(normals, {tolerance});
    EXPECT_TRUE(curves.keeps_lengths()) << tolerance;
    EXPECT_EQ(curves.bytes(), exact.bytes()) << tolerance;
    EXPECT_EQ(unit_normals(curves, 0.3), unit_normals(exact, 0.3)) << tolerance;
  }
}

// ---- the worst elements that a search finds ------------------------------------------------------------------------

// Evaluates one element in the given kind of block, by calling the kernels directly. Returns its unit normal at t. The
// components of the control normals must be floats of moderate size.
Vec3f kept_as(BlockKind kind, const ControlNormals& c, double t) {
  ControlTile tile{};
  std::size_t plane = 0;
  for (const Vec3d* const v : {&c.n0, &c.m, &c.n1}) {
    for (const double component : {v->x, v->y, v->z}) {
      std::fill_n(tile.normals[plane], kTile, static_cast<float>(component));
      ++plane;
    }
  }
  alignas(64) std::byte block[kTile * 36 + 4096] = {};
  pack_tiles(std::span(&tile, 1), kind, block);
  float xyz[3 * kTile];
  evaluate_blocks({block, kind, kTile}, CurveWeights::at(t, true), PackedResult{xyz});
  return {xyz[0], xyz[1], xyz[2]};
}

struct Candidate {
  ControlNormals c;
  double t = 0;
};

struct Format {
  const char* name;
  BlockKind kind;
  double tolerance;
};

// Returns the error of the candidate's element divided by the tolerance, or 0 if the curves do not store the element in
// the given format.
double used_up(const Format& format, const Candidate& candidate) {
  const NormalCurves curves(std::span(&candidate.c, 1), {format.tolerance});
  if (curves.flagged_count() != 0 || curves.byte_counts().front().bytes != bytes_of(format.kind)) return 0;
  if (curves.degree_counts()[format.kind == BlockKind::kLinear16 || format.kind == BlockKind::kLinear32 ? 1 : 2] == 0)
    return 0;
  const Vec3f u = unit_normals(curves, candidate.t).front();
  // Two kinds of blocks take 20 bytes per element. Returns 0 if the curves have chosen the kind that is not
  // format.kind.
  if (bytes_of(format.kind) == 20 && !(u == kept_as(format.kind, candidate.c, candidate.t))) return 0;
  return angle_to(u, candidate.c, candidate.t) / format.tolerance;
}

Candidate near_the_limit(const Format& format, fixtures::Random& random) {
  const bool linear = format.kind == BlockKind::kLinear16 || format.kind == BlockKind::kLinear32;
  for (;;) {
    Candidate result{test::hard_families()[random.below(test::hard_families().size())].make(random), 0};
    if (linear) result.c.m = 0.5 * (result.c.n0 + result.c.n1);
    result.t = random.below(3) == 0 ? random.uniform(0, 1) : test::hardest_time(result.c);
    if (used_up(format, result) > 0) return result;
  }
}

Candidate changed(Candidate candidate, bool linear, fixtures::Random& random) {
  const double size = largest_of(candidate.c), step = std::ldexp(size, -static_cast<int>(random.below(26)));
  const std::size_t what = random.below(5);
  if (what == 0) {
    candidate.t =
        std::clamp(candidate.t + std::ldexp(random.uniform(-1, 1), -static_cast<int>(random.below(26))), 0.0, 1.0);
  } else if (what == 1) {
    candidate.t = test::hardest_time(candidate.c);
  } else {
    Vec3d* const vectors[] = {&candidate.c.n0, &candidate.c.m, &candidate.c.n1};
    for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) {
      Vec3d& v = *vectors[random.below(3)];
      double* const components[] = {&v.x, &v.y, &v.z};
      double& x = *components[random.below(3)];
      // Rounds the component to float32, so that only the format rounds it further.
      x = static_cast<float>(x + step * random.uniform(-1, 1));
    }
  }
  if (linear) candidate.c.m = 0.5 * (candidate.c.n0 + candidate.c.n1);
  return candidate;
}

TEST(CompactCurves, keep_the_tolerance_in_the_worst_cases_that_a_search_finds) {
  constexpr int kStarts = 6, kSteps = 1500;
  for (const Format& format :
       {Format{"12 bytes, 11 bits", BlockKind::kQuadratic11, 5e-3},
        Format{"12 bytes, 11 bits", BlockKind::kQuadratic11, 0.1},
        Format{"12 bytes, linear", BlockKind::kLinear16, 2e-4}, Format{"12 bytes, linear", BlockKind::kLinear16, 1e-3},
        Format{"20 bytes", BlockKind::kQuadratic16, 2e-4}, Format{"20 bytes", BlockKind::kQuadratic16, 1e-3},
        Format{"20 bytes, scaled", BlockKind::kScaled16, 1.7e-4},
        Format{"20 bytes, scaled", BlockKind::kScaled16, 1e-3}, Format{"24 bytes", BlockKind::kLinear32, 1e-6},
        Format{"36 bytes", BlockKind::kQuadratic32, 1e-6}, Format{"36 bytes", BlockKind::kQuadratic32, 1e-5}}) {
    const bool linear = format.kind == BlockKind::kLinear16 || format.kind == BlockKind::kLinear32;
    fixtures::Random random(78);
    double worst = 0;
    Candidate worst_candidate;
    for (int start = 0; start < kStarts; ++start) {
      Candidate best = near_the_limit(format, random);
      double share = used_up(format, best);
      for (int step = 0; step < kSteps; ++step) {
        const Candidate candidate = changed(best, linear, random);
        const double other = used_up(format, candidate);
        if (other >= share) {
          share = other;
          best = candidate;
        }
      }
      if (share > worst) {
        worst = share;
        worst_candidate = best;
      }
    }
    std::cout << "  " << format.name << " at " << format.tolerance << ": " << worst << " of the tolerance\n";
    EXPECT_LE(worst, 1);
    EXPECT_GT(worst, 0.05);  // shows that the search finds large errors
    if (!(worst <= 1)) describe(worst_candidate.c, worst_candidate.t);
  }
}

// ---- the choice of a format of blocks -------------------------------------------------------------------------------

std::vector<ControlNormals> faces_of(const Motion& motion) {
  std::vector<ControlNormals> normals(motion.topology.face_count());
  face_control_normals(motion.segment(0), {0, normals.size()}, normals);
  return normals;
}

double share_in(std::size_t bytes, const NormalCurves& curves) {
  for (const auto& count : curves.byte_counts()) {
    if (count.bytes == bytes) return static_cast<double>(count.elements) / static_cast<double>(curves.size());
  }
  return 0;
}

TEST(CompactCurves, a_smooth_mesh_takes_20_bytes_at_a_thousandth_and_12_at_five) {
  const auto normals = faces_of(fixtures::smooth_morph());
  EXPECT_EQ(share_in(36, NormalCurves(normals)), 1);
  EXPECT_GT(share_in(20, NormalCurves(normals, {1e-3})), 0.9);
  EXPECT_GT(share_in(12, NormalCurves(normals, {5e-3})), 0.6);
}

std::vector<ControlNormals> repeated(const ControlNormals& c, std::size_t count) { return {count, c}; }

const ControlNormals kStill{{0, 0, 2}, {0, 0, 2}, {0, 0, 2}};
const ControlNormals kLinear{{0, 0, 2}, {0, 0.5, 1.5}, {0, 1, 1}};
const ControlNormals kQuadratic{{0, 0, 1}, {0.5, 0, 1}, {1, 0, 0.2}};

TEST(CompactCurves, low_degrees_take_12_bytes) {
  for (const double tolerance : {1e-3, 5e-3}) {
    EXPECT_EQ(share_in(12, NormalCurves(repeated(kStill, 100), {tolerance})), 1);
    EXPECT_EQ(share_in(12, NormalCurves(repeated(kLinear, 100), {tolerance})), 1);
  }
  EXPECT_EQ(share_in(12, NormalCurves(repeated(kStill, 100), {1e-5})), 1);
  EXPECT_EQ(share_in(16, NormalCurves(repeated(kStill, 100))), 1);
  EXPECT_EQ(share_in(24, NormalCurves(repeated(kLinear, 100))), 1);
}

TEST(CompactCurves, slivers_take_20_bytes_with_scales_of_their_own) {
  // n0 has a length of about 2^-20. An int16 without a scale for each control normal would round n0 to zero.
  const ControlNormals sliver{{0x1p-20, 0, 0x1p-22}, {0x1p-11, 0x1p-13, 0x1p-12}, {1, 0.25, 0.5}};
  const NormalCurves curves(repeated(sliver, 100), {1e-3});
  EXPECT_EQ(share_in(20, curves), 1);
  EXPECT_EQ(curves.flagged_count(), 0u);
  EXPECT_EQ(unit_normals(curves, 0.25)[99], kept_as(BlockKind::kScaled16, sliver, 0.25));
  EXPECT_FALSE(angle_to(kept_as(BlockKind::kQuadratic16, sliver, 0), sliver, 0) <= 0.1);
}

TEST(CompactCurves, short_runs_join_a_neighbour_that_can_hold_them) {
  // Two blocks that could be stored in fewer bytes do not become a separate run between blocks of 20 bytes, but eight
  // blocks do.
  const auto among = [](const ControlNormals& other, std::size_t blocks) {
    auto normals = repeated(kQuadratic, 16 * 10);
    const auto middle = repeated(other, 16 * blocks), rest = repeated(kQuadratic, 16 * 10);
    normals.insert(normals.end(), middle.begin(), middle.end());
    normals.insert(normals.end(), rest.begin(), rest.end());
    return NormalCurves(normals, {1e-3});
  };
  for (const ControlNormals& other : {kStill, kLinear}) {
    EXPECT_EQ(share_in(20, among(other, 2)), 1);
    EXPECT_LT(share_in(20, among(other, 8)), 0.8);
  }
  // A short run is never stored with fewer bytes than its elements need.
  const ControlNormals hard{{1, 0, 0}, {0, 1e-3, 0}, {-1, 0, 0}};
  const NormalCurves curves = among(hard, 1);
  EXPECT_GT(share_in(36, curves) + static_cast<double>(curves.flagged_count()), 0);
}

TEST(CompactCurves, bytes_are_those_of_the_blocks_and_little_more) {
  const NormalCurves curves(repeated(kQuadratic, 16 * 1000), {1e-3});
  EXPECT_GE(curves.bytes(), 20u * 16 * 1000);
  EXPECT_LT(curves.bytes(), 20u * 16 * 1000 + 200);
  std::size_t elements = 0;
  for (const auto& count : NormalCurves(repeated(kQuadratic, 1001), {1e-3}).byte_counts()) elements += count.elements;
  EXPECT_EQ(elements, 1001u);
}

TEST(CompactCurves, lengths_are_kept_at_the_exact_tolerance_alone) {
  const auto normals = repeated(kQuadratic, 20);
  EXPECT_TRUE(NormalCurves(normals).keeps_lengths());
  EXPECT_TRUE(NormalCurves(normals, {kExactTolerance}).keeps_lengths());
  EXPECT_FALSE(NormalCurves(normals, {1.1e-6}).keeps_lengths());
  EXPECT_FALSE(NormalCurves(normals, {kCompactTolerance}).keeps_lengths());
  EXPECT_TRUE(NormalCurves().keeps_lengths());
}

// ---- weights as integers --------------------------------------------------------------------------------------------

TEST(CurveWeights, as_integers_stay_within_the_error_that_the_bounds_assume) {
  fixtures::Random random(79);
  double worst = 0, worst_low = 0;
  for (int i = 0; i < 200000; ++i) {
    double t = random.uniform(0, 1);
    if (i % 4 == 1) t = std::ldexp(t, -static_cast<int>(random.below(40)));
    if (i % 4 == 2) t = static_cast<double>(i % 1025) / 1024;
    if (i % 4 == 3) t = 1 - std::ldexp(t, -static_cast<int>(random.below(40)));
    const double s = 1 - t;
    const CurveWeights w = CurveWeights::at(t, true);
    const auto low = [](std::int32_t pair) { return static_cast<std::int16_t>(pair & 0xFFFF); };
    const auto high = [](std::int32_t pair) { return static_cast<std::int16_t>(pair >> 16); };
    const auto judge = [&](std::span<const double> exact, std::span<const std::int32_t> integers) {
      std::int64_t sum = 0;
      for (const std::int32_t v : integers) {
        ASSERT_GE(v, 0) << t;
        ASSERT_LE(v, 32767) << t;
        sum += v;
      }
      // The components of the control normals are at most 32767 here, so their weighted sum fits into 32 bits.
      ASSERT_LE(sum * 32767, std::numeric_limits<std::int32_t>::max()) << t;
      // Only the ratios of the weights matter. The test therefore compares the weights at each scale at which one of
      // them is exact, and takes the smallest error.
      double smallest = 2;
      for (std::size_t j = 0; j < exact.size(); ++j) {
        if (integers[j] == 0) continue;
        double error = 0;
        for (std::size_t k = 0; k < exact.size(); ++k)
          error += std::fabs(exact[j] / integers[j] * integers[k] - exact[k]);
        smallest = std::min(smallest, error);
      }
      worst = std::max(worst, smallest);
    };
    judge(std::array{s, t}, std::array<std::int32_t, 2>{low(w.linear16), high(w.linear16)});
    judge(std::array{s * s, 2 * t * s, t * t}, std::array<std::int32_t, 3>{low(w.ends16), w.middle16, high(w.ends16)});
    worst_low = std::max(worst_low, std::fabs(w.middle_low - w.middle16 / 32.0));
  }
  std::cout << "  error of the weights: " << worst * 32767 << " / 32767\n";
  EXPECT_LE(worst, kWeightError);
  EXPECT_LE(worst_low, 0.5);
}

}  // namespace
}  // namespace chronormal::compact_test
