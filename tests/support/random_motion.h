/// Makes random motions, which tests write to files and read back.
#ifndef CHRONORMAL_TESTS_SUPPORT_RANDOM_MOTION_H_
#define CHRONORMAL_TESTS_SUPPORT_RANDOM_MOTION_H_

#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/random_mesh.h"

namespace chronormal::test {

/// Makes a motion with 2 to 5 keyframes whose times are float32. Each coordinate has random bits, so it may be any
/// finite float32. All faces have the same number of corners.
[[nodiscard]] inline Motion random_motion(bool equal_steps) {
  const MeshFrame mesh = random_mesh();
  const auto corners = *rc::gen::inRange<std::size_t>(3, 6);
  std::vector<std::uint32_t> offsets = {0}, indices;
  for (std::size_t f = 0; f < mesh.topology.face_count(); ++f) {
    for (std::size_t c = 0; c < corners; ++c) indices.push_back(mesh.topology.face(f)[c % 3]);
    offsets.push_back(static_cast<std::uint32_t>(indices.size()));
  }
  Motion motion;
  const std::size_t vertices = mesh.topology.vertex_count();
  motion.topology = corners == 3 ? Topology::triangles(vertices, std::move(indices)).value()
                                 : Topology::polygons(vertices, std::move(offsets), std::move(indices)).value();
  const auto any_bits = rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint32_t>());
  const auto count = *rc::gen::inRange<int>(2, 6);
  double time = *rc::gen::inRange<int>(-100, 100);
  const double step = 0.25 * *rc::gen::inRange<int>(1, 40);
  for (int k = 0; k < count; ++k) {
    motion.keyframes.push_back({mesh.positions, time, ""});
    for (float& coordinate : motion.keyframes.back().positions) {
      const auto value = std::bit_cast<float>(*any_bits);
      if (std::isfinite(value)) coordinate = value;
    }
    time += equal_steps ? step : 0.25 * *rc::gen::inRange<int>(1, 40);
  }
  motion.connect_as_sequence();
  return motion;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_RANDOM_MOTION_H_
