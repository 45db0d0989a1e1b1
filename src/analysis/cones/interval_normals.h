/// The control normals of a part [t0, t1] of a segment, and a bound of their error.
#ifndef CHRONORMAL_ANALYSIS_CONES_INTERVAL_NORMALS_H_
#define CHRONORMAL_ANALYSIS_CONES_INTERVAL_NORMALS_H_

#include "analysis/cones/kernels/cones_of_three.h"
#include "chronormal/normals/control_normals.h"
#include "normals/control/exact_curve.h"

namespace chronormal::inline internal {

/// Three control normals, and a bound of their error. Each vector is exactly zero, or has an error of at most `unknown`
/// times its largest component.
struct IntervalNormals {
  ControlNormals normals;
  double unknown = kNormalShare;

  [[nodiscard]] bool is_known() const noexcept { return unknown <= kLargestUnknown; }
};

/// Restricts the control normals of an element to a part of the segment. The relative errors of the given control
/// normals must be at most kNormalShare. If control normals cancel in this part, their error is a large share of the
/// result, and `unknown` is large.
[[nodiscard]] IntervalNormals part_of(const ControlNormals& normals, const Restriction& part) noexcept;

/// Computes the control normals over [t0, t1] of a face, or of the sum of several faces, from integers.
[[nodiscard]] IntervalNormals exact_part_of(const ExactCurve& exact, double t0, double t1) noexcept;

/// Returns the smallest cone around the control normals of `part` that are not zero.
[[nodiscard]] NormalCone cone_around(IntervalNormals part) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CONES_INTERVAL_NORMALS_H_
