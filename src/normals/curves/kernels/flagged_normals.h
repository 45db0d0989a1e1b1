/// Unit normals in double, a few at a time: for the elements that float32 cannot carry. What double cannot carry either
/// it hands back.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"
#include "normals/control/kernels/control_tile.h"

namespace chronormal::inline internal {

struct FlaggedNormals {
  ControlNormals normals;
  double certain = 0;  ///< the share of sum w_k max_abs(c_k) above which n(t) has a direction (certificate.h)
};

/// Sixteen of them side by side: the planes of ControlTile in double, and `certain`. Lanes that are not used are zero.
struct alignas(64) FlaggedTile {
  double normals[9][kTile]{};
  double certain[kTile]{};

  void set(std::size_t lane, const FlaggedNormals& flagged) noexcept {
    std::size_t k = 0;
    for (const Vec3d* const v : {&flagged.normals.n0, &flagged.normals.m, &flagged.normals.n1}) {
      for (const double component : {v->x, v->y, v->z}) normals[k++][lane] = component;
    }
    certain[lane] = flagged.certain;
  }
};

/// Unit normals of a tile.
struct alignas(64) FlaggedUnits {
  float xyz[3 * kTile];     ///< (kTile, 3)
  std::uint32_t uncertain;  ///< bit i: n(t) of element i is not certain

  [[nodiscard]] Vec3f operator[](std::size_t lane) const noexcept {
    return {xyz[3 * lane], xyz[3 * lane + 1], xyz[3 * lane + 2]};
  }
};

/// Evaluates n(t) in double, and rounds its direction to float32: within 2^-22 rad.
/// t in [0, 1]; results must have a place for each tile
void flagged_unit_normals(std::span<const FlaggedTile> tiles, double t, std::span<FlaggedUnits> results) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_
