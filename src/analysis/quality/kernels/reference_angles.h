/// Reference normals of triangles at many times, and the angles between exact normals and others, in lanes of double.
///
/// Results have the same bits as the scalar functions: reference_normals() of analysis/quality.h, except for its
/// length, and portable::atan2(|n x u|, n . u).
#ifndef CHRONORMAL_ANALYSIS_QUALITY_KERNELS_REFERENCE_ANGLES_H_
#define CHRONORMAL_ANALYSIS_QUALITY_KERNELS_REFERENCE_ANGLES_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Computes the reference normals of some triangles of a segment. Positions are gathered once, so that each t costs one
/// pass over contiguous memory.
class ReferenceTriangles {
 public:
  /// Takes faces of a segment, which must all be triangles. The arrays behind the segment must outlive the object,
  /// which reads them again if double is not accurate enough.
  ReferenceTriangles(const Segment& segment, IndexRange faces);

  /// Writes n(t) of each face divided by its largest component, and (0, 0, 0) if reference_normals() does. result must
  /// have one element per face; t in [0, 1]
  void normals(double t, std::span<Vec3d> result) const noexcept;

 private:
  Segment segment_;
  IndexRange faces_;
  std::vector<double> edges_;  // in groups of lanes, 20 values per triangle
};

/// The values that stand for an angle that does not exist.
inline constexpr double kNoExactNormal = -1, kNoNormal = -2;

/// Writes the angle between each exact normal, which need not be a unit vector, and the rendered normal: kNoExactNormal
/// if the exact normal is zero, or else kNoNormal if the rendered one is zero or not finite. The function is fastest if
/// 1 is the largest component of each exact normal. All three arrays must have the same size.
void angles_to_exact(std::span<const Vec3d> exact, VectorView<const float> shown, std::span<double> angles) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_KERNELS_REFERENCE_ANGLES_H_
