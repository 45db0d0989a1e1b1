// Compares the sums of vector areas that a bake of a sequence computes with plain loops over faces and elements, on
// every instruction set and for every number of threads.

#include "workflow/bake/sequence/area_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include "chronormal/core/parallel.h"
#include "simd/targets.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"

namespace chronormal::area_sums_test {
namespace {

using Vector = std::array<double, 3>;

PointRows rows_of(const Motion::Keyframe& keyframe) {
  PointRows rows(keyframe.positions.size() / 3 * 4);
  for (std::size_t i = 0; i < keyframe.positions.size(); ++i)
    rows[i / 3 * 4 + i % 3] = double{keyframe.positions[i]} * 1.1;  // a number with more digits than float32 holds
  for (std::size_t v = 0; v < rows.size() / 4; ++v) rows[4 * v + 3] = std::nan("");
  return rows;
}

// A sum of terms, together with the sum of the absolute values of the terms. settled() replaces a component of the sum
// by 0 if the component may be only rounding error.
struct Sum {
  Vector value{}, magnitude{};
  double terms = 0;

  [[nodiscard]] Vector settled(double roundings) const {
    Vector result = value;
    for (std::size_t k = 0; k < 3; ++k)
      if (std::fabs(value[k]) <= roundings * 0x1p-53 * terms * magnitude[k]) result[k] = 0;
    return result;
  }
};

Vector area_of(std::span<const std::uint32_t> face, const PointRows& rows) {
  const auto edge = [&](std::size_t c, std::size_t k) { return rows[4 * face[c] + k] - rows[4 * face[0] + k]; };
  Sum sum;
  for (std::size_t c = 2; c < face.size(); ++c, ++sum.terms) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      const double a = edge(c - 1, i) * edge(c, j), b = edge(c - 1, j) * edge(c, i);
      sum.value[k] += a - b;
      sum.magnitude[k] += std::fabs(a) + std::fabs(b);
    }
  }
  return sum.settled(8);
}

std::vector<Vector> sums_of(const Topology& topology, const NormalGroups& groups, const PointRows& rows) {
  std::vector<Vector> result;
  for (std::size_t e = 0; e < groups.size(); ++e) {
    Sum sum;
    for (const std::uint32_t f : groups.faces(e)) {
      const Vector area = area_of(topology.face(f), rows);
      for (std::size_t k = 0; k < 3; ++k) {
        sum.value[k] += area[k];
        sum.magnitude[k] += std::fabs(area[k]);
      }
      ++sum.terms;
    }
    result.push_back(sum.settled(4));
  }
  return result;
}

// Compares the sums of all elements with the expected bits. Describes the first element that differs, or returns "".
std::string difference(const Motion& motion, const NormalGroups& groups) {
  const PointRows a = rows_of(motion.keyframes[0]), b = rows_of(motion.keyframes[1]);
  const std::vector<Vector> of_a = sums_of(motion.topology, groups, a), of_b = sums_of(motion.topology, groups, b);
  const auto same = [](const Vector& expected, const Vec3d& found) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = k == 0 ? found.x : k == 1 ? found.y : found.z;
      if (std::memcmp(&value, &expected[k], sizeof value) != 0) return false;
    }
    return true;
  };
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    const AreaSums sums(motion.topology, groups);
    for (const PointRows* const second : {&b, static_cast<const PointRows*>(nullptr)}) {
      std::vector<int> wrong(groups.size(), 1);
      sums.each_block(a, second, [&](IndexRange some, std::span<const Vec3d> x, std::span<const Vec3d> y) {
        for (std::size_t i = 0; i < some.count; ++i) {
          const std::size_t e = some.first + i;
          const bool second_is_right = second == nullptr ? y.empty() : same(of_b[e], y[i]);
          wrong[e] = same(of_a[e], x[i]) && second_is_right ? 0 : 1;
        }
      });
      const auto found = std::find(wrong.begin(), wrong.end(), 1);
      if (found != wrong.end())
        return "element " + std::to_string(found - wrong.begin()) + " on " + target_name(current_target());
    }
  }
  return "";
}

TEST(AreaSums, have_the_bits_of_plain_loops_over_the_hardest_motions) {
  fixtures::Random random(20261128);
  for (int round = 0; round < 20; ++round) {
    for (const test::HardMotions& family : test::hard_motions()) {
      const Motion motion = family.make(random);
      ASSERT_EQ(difference(motion,
                           NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()))),
                "")
          << family.name;
    }
  }
}

TEST(AreaSums, are_the_same_in_many_blocks_and_in_no_order) {
  Motion motion = fixtures::smooth_morph(100);
  const std::size_t vertices = motion.topology.vertex_count();
  const std::vector<std::uint32_t> corners(motion.topology.corners().begin(), motion.topology.corners().end());
  std::vector<std::size_t> order(motion.topology.face_count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (const bool is_shuffled : {false, true}) {
    if (is_shuffled) {
      fixtures::Random random(5);
      for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    }
    std::vector<std::uint32_t> sorted;
    for (const std::size_t f : order)
      sorted.insert(sorted.end(), {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]});
    motion.topology = Topology::triangles(vertices, sorted).value();
    for (const std::size_t threads : {1U, 3U}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(difference(motion, NormalGroups::of_vertices(motion.topology, separate_points(vertices))), "");
    }
  }
}

}  // namespace
}  // namespace chronormal::area_sums_test
