/// The arc with the least mean error, for many elements at a time: what quaternion:optimal looks for.
///
/// The arcs from u0 to u1 that turn by half a turn at most are one family (eq. 6). Measured by how far the middle of an
/// arc stands off the great one, in half chords, the mean error is nearly convex; and the circle through the exact normal
/// in the middle is nearly the best. So a search starts there, with three arcs around, and goes on by parabolas until
/// convexity says that what is left to gain does not count.
///
/// That holds where the element turns mildly: by less than a radian over the segment and by 0.15 between neighbouring
/// samples, with an arc of less than 150 degrees, and a normal that vanishes nowhere. Other elements are left to a search
/// over the whole family.
#ifndef CHRONORMAL_SCHEMES_KERNELS_OPTIMAL_ARCS_H_
#define CHRONORMAL_SCHEMES_KERNELS_OPTIMAL_ARCS_H_

#include <span>

#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// Writes phi of eq. 6 for each element, and NaN for those that are left to others. The mean error is that of
/// ExactSamples (mean_error.h), within 0.01 percent of the least. The same bits on every instruction set.
/// Both must have the same size.
void find_optimal_arcs(std::span<const ControlNormals> normals, std::span<double> phis) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_KERNELS_OPTIMAL_ARCS_H_
