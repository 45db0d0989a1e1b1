/// Computes unit normals in double, a few at a time, for the elements for which float32 does not suffice. Elements for
/// which double does not suffice either are reported to the caller.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "normals/control/kernels/control_tile.h"

namespace chronormal::inline internal {

/// The control normals of an element, multiplied by a power of two. Their largest component is then at least 1 and
/// below 4, and n(t) is in the range of float32.
struct FlaggedNormals {
  ControlNormals normals;
  /// The control values of a quadratic. n(t) has a certain direction if its largest component is above this quadratic.
  /// Each value is smallest_certain() times the size of a control normal, and so large that float32 can hold the square
  /// of n(t). A value is infinite if the element cannot be scaled.
  std::array<float, 3> limits{};
  std::int16_t exponent = 0;  ///< `normals` are those of the element times 2^-exponent

  /// Scales the control normals of an element. n(t) has a certain direction if its largest component is above `certain`
  /// times sum w_k max_abs(c_k) (certificate.h).
  [[nodiscard]] static FlaggedNormals scaled(const ControlNormals& normals, double certain) noexcept;
};

/// Sixteen FlaggedNormals side by side: the planes of ControlTile in double, and planes of the limits. Unused lanes are
/// zero.
struct alignas(64) FlaggedTile {
  double normals[9][kTile]{};
  float limits[3][kTile]{};

  void set(std::size_t lane, const FlaggedNormals& flagged) noexcept {
    std::size_t k = 0;
    for (const Vec3d* const v : {&flagged.normals.n0, &flagged.normals.m, &flagged.normals.n1}) {
      for (const double component : {v->x, v->y, v->z}) normals[k++][lane] = component;
    }
    for (k = 0; k < 3; ++k) limits[k][lane] = flagged.limits[k];
  }
  /// Copies `count` lanes of another tile, from its lane `first` on. The first copied lane goes to lane `lane` of this
  /// tile.
  void set_lanes(std::size_t lane, const FlaggedTile& from, std::size_t first, std::size_t count) noexcept {
    for (std::size_t k = 0; k < 9; ++k) std::copy_n(from.normals[k] + first, count, normals[k] + lane);
    for (std::size_t k = 0; k < 3; ++k) std::copy_n(from.limits[k] + first, count, limits[k] + lane);
  }
  [[nodiscard]] FlaggedNormals element(std::size_t lane, std::int16_t exponent) const noexcept {
    return {element_of(normals, lane), {limits[0][lane], limits[1][lane], limits[2][lane]}, exponent};
  }
};

/// The factor by which FlaggedNormals::limits are rounded up, and the smallest value of such a limit.
inline constexpr double kLimitUp = 1 + 0x1p-20, kLeastLimit = 0x1p-50;

/// The unit normals of the elements of a tile, in float32.
struct alignas(64) FlaggedUnits {
  float xyz[3 * kTile];     ///< x, y and z of the unit normal of each element
  std::uint32_t uncertain;  ///< bit i is set if the direction of element i is uncertain

  [[nodiscard]] Vec3f operator[](std::size_t lane) const noexcept {
    return {xyz[3 * lane], xyz[3 * lane + 1], xyz[3 * lane + 2]};
  }
};

/// Evaluates n(t) in double, and rounds its direction to float32, with an error of at most 2^-22 rad. Preconditions: t
/// is the result of local_time(), and results has a place for each tile.
void flagged_unit_normals(std::span<const FlaggedTile> tiles, const LocalTime& t,
                          std::span<FlaggedUnits> results) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_
