/// The inner loops of BlendNormals, on rows of four doubles: terms added up, points moved, and unit normals.
///
/// A row is x y z and a fourth number. In a sum of terms that is a bound, in units of kFloatUnitRoundoff; in a point it
/// is 0. Every loop gives the same bits on all instruction sets.
#ifndef CHRONORMAL_NORMALS_BLEND_KERNELS_BLEND_ROWS_H_
#define CHRONORMAL_NORMALS_BLEND_KERNELS_BLEND_ROWS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "normals/groups/rings.h"

namespace chronormal::inline internal {

/// A row has so many numbers, and so has a coefficient in float32.
inline constexpr std::size_t kBlendLanes = 4;
using RowWeights = std::array<double, kBlendLanes>;

/// Adds to the row of each element of a target `linear` times its first four coefficients and `square` times the other
/// four. rows begin with that of element `first`.
/// coefficients must have eight for each element
void add_target_rows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& linear,
                     const RowWeights& square, std::size_t first, double* rows) noexcept;
/// Adds to the row of each element of a pair `weight` times its four coefficients.
void add_pair_rows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& weight,
                   std::size_t first, double* rows) noexcept;

/// Adds to the point of each vertex `weight` times its delta. deltas must have three floats for each vertex
void move_points(std::span<const std::uint32_t> vertices, const float* deltas, double weight, double* points) noexcept;
/// Puts a range of points back to the base, (V, 3). base must not end before the last of them
void reset_points(std::span<const float> base, IndexRange vertices, double* points) noexcept;

/// The same two in float32: points are rows of four floats.
void move_points(std::span<const std::uint32_t> vertices, const float* deltas, float weight, float* points) noexcept;
void reset_points(std::span<const float> base, IndexRange vertices, float* points) noexcept;

/// Which rows become unit normals.
struct UnitLimits {
  double smallest_square, largest_square;  ///< of n
  double largest_error;                    ///< the most that the error of n may be, times |n|
};

/// Writes the unit normals of the elements whose bits are set in word `place` of all, from a row for each element, whose
/// fourth component is its error. Returns the bits of those that are beyond the limits, of which nothing is written.
std::uint64_t unit_normals_of_rows(std::uint64_t elements, std::size_t place, const double* rows,
                                   const UnitLimits& limits, VectorView<float> result) noexcept;

/// The same from the points on the path around each element. `moved` is how far an edge may be off by the rounding of
/// its points, or the distance between two of them. With u = 2^-53, c the number of points of the longest of sixteen paths
/// with the centre, and m the largest component of the edges e from the centre and of half the distances d between
/// neighbours whose products e x d are added up, the error is at most that of a polygon with c corners,
///
///     u (10 + c) (c - 2) (3 m)^2 + moved (3 m (2 c - 3) + c moved)
///
/// which is about ten times the bound of an ordinary element, and less than a billionth of its normal. Since c is that of
/// sixteen elements, whether one is beyond the limits may depend on its neighbours.
std::uint64_t unit_normals_of_rings(const RingSlices& slices, std::uint64_t elements, std::size_t place,
                                    const double* points, double moved, const UnitLimits& limits,
                                    VectorView<float> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_KERNELS_BLEND_ROWS_H_
