/// Control normals of sixteen faces in double: what tiles and sums are made from.
#ifndef CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/polygon_normals.h"

namespace chronormal::inline internal {

/// Planes as in ControlTile; the bits of face_control_normals().
struct alignas(64) ExactTile {
  double normals[9][kTile];
  float magnitude[kTile];
};

/// Sixteen elements as BoundedNormals has one: control normals in double, with bounds on their errors.
struct BoundedTile : ExactTile {
  double errors[3][kTile];     ///< how far any component of n0, m and n1 may be from the exact one
  std::uint32_t left_out = 0;  ///< the elements that are not here but left to others, as bits
};

/// Sixteen faces with the longest of their edges from the first corner.
struct EdgedTile : ExactTile {
  /// Not less than any component of such an edge at either end of the segment; infinity where a face is no triangle.
  float longest[kTile];
};

/// Writes an element into a lane of a tile.
void put(BoundedTile& tile, std::size_t lane, const BoundedNormals& c) noexcept;

/// Of the magnitude of a triangle: its rounding error is below half of it.
inline constexpr double kErrorAbove = 0x1p-47;

/// A float that is not less than a magnitude, and 0 for 0.
[[nodiscard]] float magnitude_above(double magnitude) noexcept;

/// Writes one face into one lane, whatever its corners.
void set_polygon(const Segment& segment, std::size_t face, std::size_t lane, ExactTile& tile) noexcept;

/// Of the magnitude of a triangle as well: a control normal above it is hardly touched by rounding (kLargestRounding).
inline constexpr double kCertainAbove = 0x1p-22;

/// Writes one triangle into one lane, with zero for what is nothing but rounding, and control normals made of integers
/// where double is not enough. Keeps the magnitude where it is finite.
void set_without_rounding(const Segment& segment, const std::uint32_t* corners, std::size_t lane,
                          ExactTile& tile) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_
