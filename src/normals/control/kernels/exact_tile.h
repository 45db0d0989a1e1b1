/// The control normals of sixteen faces in double, from which tiles in float32 and sums are computed.
#ifndef CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/polygon_normals.h"

namespace chronormal::inline internal {

/// The control normals of sixteen faces in double, in planes as in ControlTile. They have the same bits as the control
/// normals that face_control_normals() computes.
struct alignas(64) ExactTile {
  double normals[9][kTile];
  float magnitude[kTile];
};

/// The control normals of sixteen elements in double, and bounds of their errors, as in BoundedNormals.
struct BoundedTile : ExactTile {
  double errors[3][kTile];     ///< bounds of the errors of all components of n0, of m and of n1
  std::uint32_t left_out = 0;  ///< bits of the elements that are left to other code
};

/// The control normals of sixteen faces, and bounds of the components of their edges.
struct EdgedTile : ExactTile {
  /// For each face, a bound of every component of the edges from its first corner, at both ends of the segment. The
  /// bound is infinity if the face is not a triangle.
  float longest[kTile];
};

/// Writes the control normals of an element into a lane of a tile.
void put(BoundedTile& tile, std::size_t lane, const BoundedNormals& c) noexcept;

/// An upper bound of twice the rounding error of a control normal of a triangle in double, relative to the magnitude of
/// the triangle.
inline constexpr double kErrorAbove = 0x1p-47;

/// Returns a float that is not less than a magnitude, and 0 for the magnitude 0.
[[nodiscard]] float magnitude_above(double magnitude) noexcept;

/// Writes the control normals of one face, with any number of corners, into one lane of a tile.
void set_polygon(const Segment& segment, std::size_t face, std::size_t lane, ExactTile& tile) noexcept;

/// The size of a control normal, relative to the magnitude of its triangle, above which the rounding error of the
/// control normal is certainly at most kLargestRounding.
inline constexpr double kCertainAbove = 0x1p-22;

/// Writes the control normals of one triangle into one lane of a tile. Components that are only rounding error become
/// zero, and integers compute a control normal if double is not precise enough. A finite magnitude in the lane stays as
/// it is.
void set_without_rounding(const Segment& segment, const std::uint32_t* corners, std::size_t lane,
                          ExactTile& tile) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_
