/// Makes random motions of meshes with one or two polygons that have many corners. Every vertex belongs to one of these
/// large polygons.
#ifndef CHRONORMAL_TESTS_SUPPORT_LARGE_POLYGONS_H_
#define CHRONORMAL_TESTS_SUPPORT_LARGE_POLYGONS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "tests/support/fixtures.h"

namespace chronormal::test {

enum class LargePolygons {
  kAlone,  ///< a single polygon
  /// Two polygons back to back. At each vertex, the normals of the two polygons cancel almost completely, so only exact
  /// arithmetic finds the direction of their sum.
  kPillow,
  kPrism,  ///< two polygons, joined by a band of quadrilaterals
};

/// Makes a motion of one or two wavy polygons, each with `corners` corners. The motion has `keyframes` keyframes.
[[nodiscard]] inline Motion large_polygons(LargePolygons kind, std::uint32_t corners, fixtures::Random& random,
                                           int keyframes = 2) {
  const double height = kind == LargePolygons::kPrism ? std::ldexp(random.uniform(1, 2), -40) : 0;
  std::vector<std::uint32_t> offsets{0}, around;
  const auto add_face = [&](auto first, auto last) {
    around.insert(around.end(), first, last);
    offsets.push_back(static_cast<std::uint32_t>(around.size()));
  };
  std::vector<std::uint32_t> rim(corners);
  for (std::uint32_t v = 0; v < corners; ++v) rim[v] = v;
  add_face(rim.begin(), rim.end());
  std::uint32_t vertices = corners;
  if (kind == LargePolygons::kPillow) {
    rim.push_back(vertices++);  // so that the normals of the two polygons do not cancel exactly
    add_face(rim.rbegin(), rim.rend());
  } else if (kind == LargePolygons::kPrism) {
    vertices = 2 * corners;
    for (std::uint32_t& v : rim) v += corners;
    add_face(rim.rbegin(), rim.rend());
    for (std::uint32_t v = 0; v < corners; ++v) {
      const std::uint32_t next = (v + 1) % corners;
      const std::array<std::uint32_t, 4> side{v, corners + v, corners + next, next};
      add_face(side.begin(), side.end());
    }
  }
  Motion motion;
  motion.topology = Topology::polygons(vertices, std::move(offsets), std::move(around)).value();
  for (int k = 0; k < keyframes; ++k) {
    Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
    keyframe.time = k;
    const auto add_vertex = [&keyframe](double x, double y, double z) {
      for (const double p : {x, y, z}) keyframe.positions.push_back(static_cast<float>(p));
    };
    for (std::uint32_t v = 0; v < corners; ++v) {
      const double angle = 2 * std::numbers::pi * v / corners, r = random.uniform(0.99, 1.01);
      add_vertex(r * std::cos(angle), r * std::sin(angle), 0.3 * k * std::cos(angle + k) + random.uniform(0, 0.01));
    }
    if (kind == LargePolygons::kPillow) add_vertex(1 + random.uniform(0, 0x1p-20), -0x1p-20, 0.3 * k * std::cos(k));
    for (std::uint32_t v = 0; v < corners && kind == LargePolygons::kPrism; ++v) {
      const float* const top = keyframe.positions.data() + 3 * std::size_t{v};
      add_vertex(top[0], top[1], top[2] - height);
    }
  }
  motion.connect_as_sequence();
  return motion;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_LARGE_POLYGONS_H_
