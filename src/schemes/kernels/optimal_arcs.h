/// Finds the arc with the least mean error for many elements at a time, for the scheme quaternion:optimal.
///
/// The arcs from u0 to u1 that turn by at most half a turn are one family (eq. 6). The arcs can be ordered by the
/// distance of an arc's middle from the great circle, in units of half the chord. As a function of this distance, the
/// mean error is nearly convex, and the circle through the exact normal in the middle is nearly the best arc. So a
/// search starts with three arcs around that circle, and continues with parabolas until convexity shows that a better
/// arc could gain hardly anything.
///
/// The search works if the normal of the element turns mildly. The normal must turn by less than a radian over the
/// segment and by less than 0.15 radians between neighbouring samples, on an arc of less than 150 degrees, and must not
/// vanish. Other elements are left to a search over the whole family.
#ifndef CHRONORMAL_SCHEMES_KERNELS_OPTIMAL_ARCS_H_
#define CHRONORMAL_SCHEMES_KERNELS_OPTIMAL_ARCS_H_

#include <span>

#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// Writes phi of eq. 6 for each element, and NaN for elements that are left to the slower search over the whole family
/// of arcs. The mean error of the arc, as ExactSamples (mean_error.h) defines it, is within 0.01 percent of the least.
/// Results have the same bits on every instruction set. Precondition: normals and phis have the same size.
void find_optimal_arcs(std::span<const ControlNormals> normals, std::span<double> phis) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_KERNELS_OPTIMAL_ARCS_H_
