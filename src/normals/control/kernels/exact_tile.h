/// Control normals of sixteen faces in double, from which tiles and sums are computed.
#ifndef CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/polygon_normals.h"

namespace chronormal::inline internal {

/// The normals of sixteen faces in double: planes as in ControlTile, with the bits of face_control_normals().
struct alignas(64) ExactTile {
  double normals[9][kTile];
  float magnitude[kTile];
};

/// Sixteen elements like BoundedNormals: control normals in double, with bounds on their errors.
struct BoundedTile : ExactTile {
  double errors[3][kTile];     ///< bound of the error of any component of n0, m and n1
  std::uint32_t left_out = 0;  ///< bits of elements that are left to others
};

/// Sixteen faces with the length of the longest of their edges from the first corner.
struct EdgedTile : ExactTile {
  /// A bound of every component of these edges at both ends of the segment; infinity if a face is not a triangle.
  float longest[kTile];
};

/// Writes an element into a lane of a tile.
void put(BoundedTile& tile, std::size_t lane, const BoundedNormals& c) noexcept;

/// The share of the magnitude of a triangle that is more than twice its rounding error.
inline constexpr double kErrorAbove = 0x1p-47;

/// Returns a float that is not less than a magnitude, and 0 for 0.
[[nodiscard]] float magnitude_above(double magnitude) noexcept;

/// Writes one face into one lane, with any number of corners.
void set_polygon(const Segment& segment, std::size_t face, std::size_t lane, ExactTile& tile) noexcept;

/// The share of the magnitude of a triangle above which a control normal is hardly changed by rounding
/// (kLargestRounding).
inline constexpr double kCertainAbove = 0x1p-22;

/// Writes one triangle into one lane. Sets components to zero that are only rounding error, and computes control
/// normals in integers if double is not enough. Keeps the magnitude if it is finite.
void set_without_rounding(const Segment& segment, const std::uint32_t* corners, std::size_t lane,
                          ExactTile& tile) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_EXACT_TILE_H_
