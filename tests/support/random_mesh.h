/// Makes random meshes, which tests write to files and read back.
#ifndef CHRONORMAL_TESTS_SUPPORT_RANDOM_MESH_H_
#define CHRONORMAL_TESTS_SUPPORT_RANDOM_MESH_H_

#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "chronormal/core/views.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal::test {

/// Makes a mesh of 1 to 20 vertices and 1 to 20 faces with 3 to 6 corners. Each coordinate has random bits, so it may
/// be any finite float32. One mesh in four has only triangles.
[[nodiscard]] inline MeshFrame random_mesh() {
  const auto vertex_count = *rc::gen::inRange<std::size_t>(1, 21);
  const auto any_bits = rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint32_t>());
  MeshFrame frame;
  for (std::size_t i = 0; i < 3 * vertex_count; ++i) {
    const auto value = std::bit_cast<float>(*any_bits);
    frame.positions.push_back(std::isfinite(value) ? value : 0.1F);
  }
  const auto face_count = *rc::gen::inRange<std::size_t>(1, 21);
  const auto most_corners = *rc::gen::inRange<std::size_t>(4, 8);
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::size_t f = 0; f < face_count; ++f) {
    const auto corner_count = *rc::gen::inRange<std::size_t>(3, most_corners);
    for (std::size_t c = 0; c < corner_count; ++c)
      corners.push_back(*rc::gen::inRange<std::uint32_t>(0, static_cast<std::uint32_t>(vertex_count)));
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  frame.topology = Topology::polygons(vertex_count, std::move(offsets), std::move(corners)).value();
  return frame;
}

/// Tells whether two lists of coordinates have the same bits. The bits of -0 and 0 differ.
[[nodiscard]] inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i])) return false;
  }
  return true;
}

[[nodiscard]] inline VectorView<const float> positions_of(const MeshFrame& frame) {
  return VectorView<const float>::packed(frame.positions.data(), frame.topology.vertex_count());
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_RANDOM_MESH_H_
