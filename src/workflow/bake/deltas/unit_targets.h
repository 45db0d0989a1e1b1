/// Computes deltas that every viewer renders alike. The deltas lead from the base normal N to other unit normals.
/// Private to workflow.
///
/// Some viewers render N + D, some keep only the direction of N + D, and some clamp the components of D to 1. If |N +
/// D| = 1 and no component of D is beyond 1, all of these viewers render the same normal. For this reason each delta of
/// the author's targets and of correction targets is u - N with a unit vector u (docs/theory.md, section 16). Such a u
/// "fits" if no component of u - N is beyond 1.
///
/// Vectors    base and u have length 1. base may also be (0, 0, 0), and then every u fits.
/// Threads    All functions are pure.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_UNIT_TARGETS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_UNIT_TARGETS_H_

#include <array>
#include <optional>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The stored normal of a vertex.
struct BaseNormal {
  static constexpr double kShortest = 1e-3;  ///< the shortest length of a normal whose direction is used

  Vec3d direction;    ///< unit vector; (0, 0, 0) if the normal is too short
  double length = 1;  ///< the length of `stored`; 1 if that is too short
  Vec3d stored;

  explicit BaseNormal(const Vec3d& normal) noexcept : stored(normal) {
    if (chronormal::length(normal) < kShortest) return;
    direction = unit(normal);
    length = chronormal::length(normal);
  }
};

/// Returns true if each component of u - base is from -1 to 1, so that u fits.
[[nodiscard]] bool fits(const Vec3d& base, const Vec3d& u) noexcept;

/// Returns the last unit vector on the arc from base to u whose difference from base has no component beyond 1.
[[nodiscard]] Vec3d farthest_that_fits(const Vec3d& base, const Vec3d& u) noexcept;

/// Returns a unit vector u that fits (no component of u - base is beyond 1), for which shown + weight (u - base) has
/// the direction `right`. `right` must have length 1, and weight must not be 0. The sum may have any length, so two
/// vectors u are possible. Returns the u with the longer sum if this u fits (eq. 46 of docs/theory.md), and otherwise
/// the other u if it fits. If neither fits, returns the nearest vector that fits. Returns nothing if the sum would be
/// nearly zero.
[[nodiscard]] std::optional<Vec3d> turning_unit(const Vec3d& base, const Vec3d& shown, const Vec3d& right,
                                                double weight) noexcept;

/// Returns the delta u - base of a unit vector u that fits (no component of the delta is beyond 1). The part of this
/// delta perpendicular to base is `vector`, or as near to `vector` as possible.
[[nodiscard]] Vec3d unit_delta(const Vec3d& base, const Vec3d& vector) noexcept;

/// Returns two unit vectors u and v that fit (no component of u - base and v - base is beyond 1), for which u + v - 2
/// base is `vector` (eq. 47 of docs/theory.md). Returns nothing if there are no such vectors. For example, u and v
/// cannot make the normal `base` longer.
[[nodiscard]] std::optional<std::array<Vec3d, 2>> two_units(const Vec3d& base, const Vec3d& vector) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_UNIT_TARGETS_H_
