/// Deltas that every viewer shows alike: from the base normal N to other unit normals. Private to workflow.
///
/// One viewer adds N + D, another keeps only its direction, a third cuts the components of D at 1. Where |N + D| = 1 and
/// no component of D is beyond 1 these are the same, so that u - N, with unit vectors u, is all that an author's target
/// and an extra one may add (docs/theory.md, section 16).
///
/// Vectors    base and u have length 1; base may be (0, 0, 0), from which any u is reached.
/// Threads    pure
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_UNIT_TARGETS_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_UNIT_TARGETS_H_

#include <array>
#include <optional>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The stored normal of a vertex.
struct BaseNormal {
  static constexpr double kShortest = 1e-3;  ///< shorter ones point nowhere

  Vec3d direction;    ///< (0, 0, 0) where it is too short
  double length = 1;  ///< 1 where it is too short
  Vec3d stored;

  explicit BaseNormal(const Vec3d& normal) noexcept : stored(normal) {
    if (chronormal::length(normal) < kShortest) return;
    direction = unit(normal);
    length = chronormal::length(normal);
  }
};

/// Whether no component of u - base is beyond 1.
[[nodiscard]] bool fits(const Vec3d& base, const Vec3d& u) noexcept;

/// The last unit vector on the arc from base to u that fits.
[[nodiscard]] Vec3d farthest_that_fits(const Vec3d& base, const Vec3d& u) noexcept;

/// The unit vector u that fits and for which shown + weight (u - base) has the direction `right`, which has length 1.
/// It has no choice of length, but that of the sum is free: there are two such vectors, of which the longer sum is
/// taken where that fits (eq. 46). Where none fits, the nearest that does. Nothing where the sum would be nearly zero.
/// weight must not be 0
[[nodiscard]] std::optional<Vec3d> turning_unit(const Vec3d& base, const Vec3d& shown, const Vec3d& right,
                                                double weight) noexcept;

/// The delta u - base of a unit vector u that fits and whose part across base is this vector, as far as that goes.
[[nodiscard]] Vec3d unit_delta(const Vec3d& base, const Vec3d& vector) noexcept;

/// Two unit vectors that fit and for which u + v - 2 base is this vector (eq. 47). Nothing where there are none: they
/// cannot make a normal longer.
[[nodiscard]] std::optional<std::array<Vec3d, 2>> two_units(const Vec3d& base, const Vec3d& vector) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_UNIT_TARGETS_H_
