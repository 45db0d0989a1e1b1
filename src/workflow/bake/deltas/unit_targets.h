/// Deltas that every viewer renders alike: from the base normal N to other unit normals. Private to workflow.
///
/// One viewer adds N + D, another keeps only its direction, and a third clamps the components of D to 1. If |N + D| = 1
/// and no component of D is beyond 1, all three are the same. So a target of the author and a correction target may
/// only add u - N, with unit vectors u (docs/theory.md, section 16).
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
  static constexpr double kShortest = 1e-3;  ///< shorter ones have no definite direction

  Vec3d direction;    ///< (0, 0, 0) if the normal is too short
  double length = 1;  ///< 1 if it is too short
  Vec3d stored;

  explicit BaseNormal(const Vec3d& normal) noexcept : stored(normal) {
    if (chronormal::length(normal) < kShortest) return;
    direction = unit(normal);
    length = chronormal::length(normal);
  }
};

/// Tells whether no component of u - base is beyond 1.
[[nodiscard]] bool fits(const Vec3d& base, const Vec3d& u) noexcept;

/// Returns the last unit vector on the arc from base to u that fits.
[[nodiscard]] Vec3d farthest_that_fits(const Vec3d& base, const Vec3d& u) noexcept;

/// Returns the unit vector u that fits and for which shown + weight (u - base) has the direction `right`, which has
/// length 1. The length of u is given but that of the sum is free, so there are two such vectors; the longer sum is
/// taken if it fits (eq. 46). If none fits, returns the nearest vector that does; nothing if the sum would be nearly
/// zero. weight must not be 0
[[nodiscard]] std::optional<Vec3d> turning_unit(const Vec3d& base, const Vec3d& shown, const Vec3d& right,
                                                double weight) noexcept;

/// Returns the delta u - base of a unit vector u that fits and whose part across base is this vector, as far as
/// possible.
[[nodiscard]] Vec3d unit_delta(const Vec3d& base, const Vec3d& vector) noexcept;

/// Returns two unit vectors that fit and for which u + v - 2 base is this vector (eq. 47). Returns nothing if there are
/// none: they cannot make a normal longer.
[[nodiscard]] std::optional<std::array<Vec3d, 2>> two_units(const Vec3d& base, const Vec3d& vector) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_UNIT_TARGETS_H_
