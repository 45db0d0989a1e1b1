/// The control normals of sixteen elements, which one kernel computes and another kernel packs into NormalCurves.
///
///     normals     n0.x of 16 elements, n0.y of 16, n0.z, m.x, m.y, m.z, n1.x, n1.y, n1.z
///     magnitude   for each element, at least the sum of the absolute products that went into any one component
///     degree      for each element, as degree() in control_normals.h finds it
///
/// In tiles that are computed entirely in float32, `magnitude` bounds the error of every component, and `degree` may be
/// smaller than the true degree. The bound then includes the error of leaving out m, or m and n1.
///
/// All other tiles are computed in double and rounded once. In such a tile, a component that is smaller than the
/// rounding error of its products (far below 2^-26 of `magnitude`) may be noise. The code that reads the tile must not
/// trust such a component, and computes the element in double instead, where noise becomes zero. Lanes beyond the last
/// element repeat the last element.
#ifndef CHRONORMAL_NORMALS_CONTROL_KERNELS_CONTROL_TILE_H_
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_CONTROL_TILE_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kTile = 16;

struct alignas(64) ControlTile {
  float normals[9][kTile];
  float magnitude[kTile];
  std::int32_t degree[kTile];
};

/// Writes the control normals of an element, rounded to float32, into a lane of a tile.
inline void put(ControlTile& tile, std::size_t lane, const ControlNormals& c) noexcept {
  std::size_t plane = 0;
  for (const Vec3d* const v : {&c.n0, &c.m, &c.n1}) {
    for (const double component : {v->x, v->y, v->z}) tile.normals[plane++][lane] = static_cast<float>(component);
  }
}

/// Returns the control normals of the element in a lane of nine planes of doubles.
[[nodiscard]] inline ControlNormals element_of(const double (&planes)[9][kTile], std::size_t lane) noexcept {
  const auto vector = [&planes, lane](std::size_t k) {
    return Vec3d{planes[k][lane], planes[k + 1][lane], planes[k + 2][lane]};
  };
  return {vector(0), vector(3), vector(6)};
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_CONTROL_TILE_H_
