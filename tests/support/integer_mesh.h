/// Makes a moving grid from integers and powers of two alone. The coordinates therefore have the same bits with every
/// compiler and mathematics library. The grid is for tests that compare results with a constant, and for tests that
/// need large meshes quickly.
#ifndef CHRONORMAL_TESTS_SUPPORT_INTEGER_MESH_H_
#define CHRONORMAL_TESTS_SUPPORT_INTEGER_MESH_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/fixtures.h"

namespace chronormal::test {

/// Makes a grid of cells x cells squares, each of two triangles. Bands of rows rest, translate, turn in their plane,
/// shrink to a point, or move freely, so the grid has elements of every degree and in every packed format, and elements
/// that are flagged because float32 is not accurate enough for them.
[[nodiscard]] inline Motion integer_grid(std::size_t cells, std::uint64_t seed = 91) {
  std::mt19937_64 engine(seed);
  // Returns a random signed integer of `bits` bits, divided by 2^12.
  const auto noise = [&engine](unsigned bits) {
    return static_cast<float>(static_cast<std::int64_t>(engine() & ((1u << bits) - 1)) - (1 << bits) / 2) * 0x1p-12F;
  };
  const std::size_t row = cells + 1;
  Motion motion;
  motion.keyframes.resize(2);
  motion.keyframes[1].time = 1;
  for (std::size_t y = 0; y < row; ++y) {
    for (std::size_t x = 0; x < row; ++x) {
      const std::array<float, 3> from{static_cast<float>(x), static_cast<float>(y) + noise(9), noise(11)};
      std::array<float, 3> to = from;
      const std::array<float, 3> moved{from[0] + noise(11), from[1] + noise(11), from[2] + noise(12)};
      switch (y * 12 / row) {
        case 0:
          break;
        case 1:
          to = {from[0] + 0.25F, from[1] - 8, from[2] + 0.5F};
          break;
        case 2:
          to = {-from[1], from[0], from[2]};
          break;
        case 3:  // shrinks to a point
          to = {7, 7, 7};
          break;
        case 4:  // shrinks almost to a point
          to = {7 + from[0] * 0x1p-12F, 7 + from[1] * 0x1p-12F, from[2]};
          break;
        case 5:  // turns inside out
          to = {-from[0], from[1] + noise(6), -from[2]};
          break;
        case 6:  // moves freely
          to = {noise(16), noise(16), noise(16)};
          break;
        default:
          to = moved;
      }
      auto& p = motion.keyframes[0].positions;
      auto& q = motion.keyframes[1].positions;
      p.insert(p.end(), from.begin(), from.end());
      q.insert(q.end(), to.begin(), to.end());
    }
  }
  std::vector<std::uint32_t> corners;
  for (std::size_t y = 0; y < cells; ++y) {
    for (std::size_t x = 0; x < cells; ++x) {
      const auto a = static_cast<std::uint32_t>(y * row + x), b = a + 1;
      const auto c = static_cast<std::uint32_t>(a + row), d = c + 1;
      corners.insert(corners.end(), {a, b, d, a, d, c});
    }
  }
  motion.topology = fixtures::make_triangles(row * row, std::move(corners));
  motion.connect_as_sequence();
  return motion;
}

/// Returns the grid of integer_grid(), with its vertices and faces in random order.
[[nodiscard]] inline Motion shuffled_grid(std::size_t cells, std::uint64_t seed = 91) {
  Motion motion = integer_grid(cells, seed);
  fixtures::Random random(seed);
  std::vector<std::uint32_t> place(motion.topology.vertex_count());
  for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
  for (std::size_t v = place.size(); v > 1; --v) std::swap(place[v - 1], place[random.below(v)]);
  for (Motion::Keyframe& key : motion.keyframes) {
    const std::vector<float> ordered = key.positions;
    for (std::size_t v = 0; v < place.size(); ++v) {
      for (std::size_t c = 0; c < 3; ++c) key.positions[3 * place[v] + c] = ordered[3 * v + c];
    }
  }
  std::vector<std::uint32_t> corners(motion.topology.corners().begin(), motion.topology.corners().end());
  for (std::uint32_t& corner : corners) corner = place[corner];
  for (std::size_t f = corners.size() / 3; f > 1; --f) {
    const std::size_t other = random.below(f);
    for (std::size_t c = 0; c < 3; ++c) std::swap(corners[3 * (f - 1) + c], corners[3 * other + c]);
  }
  motion.topology = fixtures::make_triangles(place.size(), std::move(corners));
  return motion;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_INTEGER_MESH_H_
