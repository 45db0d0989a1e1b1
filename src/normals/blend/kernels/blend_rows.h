/// The inner loops of BlendNormals, on rows of four doubles. The loops add up terms, move points, and compute unit
/// normals.
///
/// A row is x, y, z and a fourth number. In a row of a sum of terms, the fourth number is an error bound in units of
/// kFloatUnitRoundoff; in a point it is 0. Every loop gives the same bits on all instruction sets.
#ifndef CHRONORMAL_NORMALS_BLEND_KERNELS_BLEND_ROWS_H_
#define CHRONORMAL_NORMALS_BLEND_KERNELS_BLEND_ROWS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "normals/groups/rings.h"

namespace chronormal::inline internal {

/// The number of lanes of a row, and of a coefficient in float32.
inline constexpr std::size_t kBlendLanes = 4;
using RowWeights = std::array<double, kBlendLanes>;

/// Adds the terms of a target to the rows of its elements: `linear` times the first four coefficients of each element,
/// plus `square` times the other four. The first of `rows` is the row of element `first`. Precondition: coefficients
/// has eight numbers for each element.
void add_target_rows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& linear,
                     const RowWeights& square, std::size_t first, double* rows) noexcept;
/// Adds the term of a pair of targets to the rows of its elements: `weight` times the four coefficients of each
/// element.
void add_pair_rows(std::span<const std::uint32_t> elements, const float* coefficients, const RowWeights& weight,
                   std::size_t first, double* rows) noexcept;

/// Adds `weight` times the delta of each vertex to the point of the vertex. Precondition: deltas has three floats for
/// each vertex.
void move_points(std::span<const std::uint32_t> vertices, const float* deltas, double weight, double* points) noexcept;
/// Sets a range of points back to the base, which has three floats for each vertex of the mesh.
void reset_points(std::span<const float> base, IndexRange vertices, double* points) noexcept;

/// Move points in float32, which are rows of four floats, and set them back to the base.
void move_points(std::span<const std::uint32_t> vertices, const float* deltas, float weight, float* points) noexcept;
void reset_points(std::span<const float> base, IndexRange vertices, float* points) noexcept;

/// The limits within which the unit normal of a row may be computed in lanes.
struct UnitLimits {
  double smallest_square, largest_square;  ///< the limits of n . n
  double largest_error;                    ///< the largest allowed error of n, relative to |n|
};

/// Writes the unit normals of the elements whose bits are set in `elements`, which is word number `place` of a set.
/// Each element has a row, whose fourth component is its error bound. Returns the bits of the elements beyond the
/// limits, for which nothing is written.
std::uint64_t unit_normals_of_rows(std::uint64_t elements, std::size_t place, const double* rows,
                                   const UnitLimits& limits, VectorView<float> result) noexcept;

/// Computes unit normals from the points on the path around each element. `moved` bounds the error that the rounding of
/// points causes in an edge, or in the distance between two points. Let u = 2^-53, and let c be the number of points,
/// including the centre, of the longest of sixteen paths. Let m be the largest component of the edges e from the centre
/// and of half the distances d between neighbours whose products e x d are added up. Then the error is at most that of
/// a polygon with c corners,
///
///     u (10 + c) (c - 2) (3 m)^2 + moved (3 m (2 c - 3) + c moved)
///
/// which is about ten times the error of an ordinary element, and less than a billionth of its normal. Since c depends
/// on sixteen elements, the neighbours of an element may decide whether the element is beyond the limits.
std::uint64_t unit_normals_of_rings(const RingSlices& slices, std::uint64_t elements, std::size_t place,
                                    const double* points, double moved, const UnitLimits& limits,
                                    VectorView<float> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_KERNELS_BLEND_ROWS_H_
