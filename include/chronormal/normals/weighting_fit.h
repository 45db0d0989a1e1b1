/// Quadratics in place of weighted normals that are none.
///
/// Weighted by anything but area, the normal of a vertex is no polynomial in time. Here it is replaced, element by
/// element and segment by segment, by a quadratic that NormalCurves plays like the exact ones: the one that has the
/// weighted direction at t = 0, 1/2 and 1, with the area-weighted length there. It is an approximation, so each element
/// carries a bound.
///
/// Bound      An angle in radians that the quadratic is nowhere in [0, 1] further from the weighted normal, proven in
///            interval arithmetic: Taylor polynomials of degree 4 with their remainders over pieces of the segment, as
///            many (to some 256) as come within twice the largest sampled error, or 1e-9 rad. It is pi
///            where nothing could be proven: where a face of the element loses its area on the way (the weighted normal
///            jumps there, unless it is area-angle), where the sum vanishes, or where the quadratic is off by more than
///            a right angle. Where corners are nearly straight, or edges nearly without length, bounds by angle and
///            area-angle are looser. NormalCurves adds its own 1e-6 rad. Elements without any area have zero control
///            normals and the bound 0; those of a single triangle have its direction, which is exact, and the bound 0.
/// Source     Moore, Interval Analysis (1966), for Taylor coefficients in intervals.
#ifndef CHRONORMAL_NORMALS_WEIGHTING_FIT_H_
#define CHRONORMAL_NORMALS_WEIGHTING_FIT_H_

#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"

namespace chronormal {

struct WeightingFit {
  std::vector<ControlNormals> normals;  ///< of each element
  std::vector<double> bounds;           ///< of each element, radians, in [0, pi]
};

/// Fits all elements of a segment. For area the control normals are those of group_normals.h, and the bounds are 0.
/// On all cores; some 0.1 ms per element of mild motion, up to 1.5 ms where it is strong. The same bits for every
/// number of threads.
[[nodiscard]] WeightingFit fit_weighting(const Segment& segment, const NormalGroups& groups, Weighting weighting);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_FIT_H_
