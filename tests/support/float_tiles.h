/// Compares control normals in tiles that were computed in float32 with control normals in double, and checks that the
/// differences do not exceed the error bounds of the tiles.
#ifndef CHRONORMAL_TESTS_SUPPORT_FLOAT_TILES_H_
#define CHRONORMAL_TESTS_SUPPORT_FLOAT_TILES_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <limits>
#include <string>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "normals/control/kernels/control_tile.h"
#include "tests/support/fixtures.h"

namespace chronormal::test {

/// Changes the positions at the end of the motion, so that n(t) has degree 1 or 0. With `kind` 0, each point moves
/// along z by a different distance; with 1, all points move by the same vector; with 2, the mesh is stretched along x;
/// with 3, nothing moves.
[[nodiscard]] inline Motion of_low_degree(Motion motion, int kind) {
  const auto& from = motion.keyframes[0].positions;
  auto& to = motion.keyframes[1].positions;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const float ends[] = {i % 3 == 2 ? to[i] : from[i], from[i] + 0.1F, i % 3 == 0 ? 1.7F * from[i] : from[i], from[i]};
    to[i] = ends[kind];
  }
  return motion;
}

/// Changes the positions at the end of the motion: every coordinate moves by only a share of its original displacement,
/// plus a small random amount.
[[nodiscard]] inline Motion of_small_steps(Motion motion, double share, fixtures::Random& random) {
  const auto& from = motion.keyframes[0].positions;
  auto& to = motion.keyframes[1].positions;
  for (std::size_t i = 0; i < from.size(); ++i)
    to[i] = static_cast<float>(from[i] + share * (double{to[i]} - from[i] + random.uniform(-1, 1)));
  return motion;
}

/// The results of comparing the elements of float32 tiles with control normals in double. `fault` describes the last
/// fault, or is "".
struct FloatTileFaults {
  std::size_t elements = 0;
  std::size_t bending = 0;           ///< elements with a stated degree of 2
  std::size_t straight = 0;          ///< elements with a lower stated degree
  double largest_share = 0;          ///< largest error divided by its bound
  double largest_share_of_line = 0;  ///< likewise for curves that are stored as lines
  double largest_bound = 0;          ///< the largest error bound, relative to the sum of absolute products
  std::string fault;

  /// Checks one element of a tile. `right` has the true control normals of the element. A component of a control normal
  /// is a sum of products. `products` must be at least the sum of the absolute values of these products, and `count` is
  /// the number of cross products that are added.
  void look_at(const ControlTile& tile, std::size_t lane, const ControlNormals& right, double products,
               std::size_t count) {
    const std::string place = "element " + std::to_string(elements++);
    const double bound = tile.magnitude[lane], unit_roundoff = 0x1p-24;
    const bool in_range = bound <= std::numeric_limits<float>::max() && products > 1e-30;
    if (in_range && !(bound >= unit_roundoff * static_cast<double>(count + 5) * products))
      fault = "the bound of " + place + " is too small";
    if (in_range) largest_bound = std::max(largest_bound, bound / products);
    std::size_t k = 0;
    for (const Vec3d& v : {right.n0, right.m, right.n1}) {
      for (const double component : {v.x, v.y, v.z}) {
        const double off = std::fabs(double{tile.normals[k++][lane]} - component);
        if (off > 0 && in_range) largest_share = std::max(largest_share, off / bound);
        // Errors of up to 2^-140, which is below the smallest normal float, do not matter. NaN counts as a fault unless
        // the bound is infinite.
        if (!(off <= bound + 0x1p-140) && bound <= std::numeric_limits<float>::max())
          fault = place + " is off by " + std::to_string(off / bound) + " of its bound";
      }
    }
    if (tile.degree[lane] == 2) {
      ++bending;
      if (in_range && degree(right) != 2) fault = "a line is taken for a curve, " + place;
    } else if (tile.degree[lane] == 0 || tile.degree[lane] == 1) {
      ++straight;
      const double share = share_of_line(tile, lane, right);
      if (in_range) largest_share_of_line = std::max(largest_share_of_line, share);
      if (in_range && !(share <= 1)) fault = place + ", kept as a line, is off by " + std::to_string(share);
    } else {
      fault = "there is no degree, " + place;
    }
  }

 private:
  /// Returns the largest difference between n(t) and the curve that is stored without m, divided by the bound. Without
  /// m, the curve is the line between n0 and n1, or n0 alone.
  [[nodiscard]] static double share_of_line(const ControlTile& tile, std::size_t lane, const ControlNormals& right) {
    const double n0[3] = {right.n0.x, right.n0.y, right.n0.z}, m[3] = {right.m.x, right.m.y, right.m.z},
                 n1[3] = {right.n1.x, right.n1.y, right.n1.z};
    constexpr int kSteps = 64;
    double off = 0;
    for (int step = 0; step <= kSteps; ++step) {
      const double t = tile.degree[lane] == 0 ? 0 : static_cast<double>(step) / kSteps;
      const double s = static_cast<double>(step) / kSteps, r = 1 - s;
      for (std::size_t k = 0; k < 3; ++k) {
        const double kept = (1 - t) * tile.normals[k][lane] + t * tile.normals[6 + k][lane];
        off = std::max(off, std::fabs(kept - (r * r * n0[k] + 2 * r * s * m[k] + s * s * n1[k])));
      }
    }
    return off > 0 ? off / double{tile.magnitude[lane]} : 0;
  }
};

/// Checks that elements that hardly move are stored as lines or as single normals, and that the error bound of a tile
/// includes the error of this simplification. look(seen, motion) compares the tiles of a motion and adds the result to
/// `seen`.
template <class Look>
void expect_lines_within_their_errors(const Motion& motion, const Look& look) {
  constexpr std::uint64_t kSeed = 20261126;
  fixtures::Random random(kSeed);
  FloatTileFaults seen;
  for (int step = 0; step < 24; ++step) {
    look(seen, of_small_steps(motion, std::ldexp(1, -3 - step), random));
    ASSERT_EQ(seen.fault, "") << "step " << step << ", seed " << kSeed;
  }
  std::cout << "  seed " << kSeed << ": " << seen.straight << " of " << seen.elements << " as lines, " << seen.bending
            << " that bend; largest error of a line: " << seen.largest_share_of_line << " of its bound\n";
  EXPECT_GT(seen.straight, seen.elements / 4);
  EXPECT_GT(seen.bending, seen.elements / 10);
  EXPECT_GT(seen.largest_share_of_line, 0.3);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_FLOAT_TILES_H_
