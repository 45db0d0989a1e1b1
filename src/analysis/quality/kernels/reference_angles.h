/// Computes in lanes of double the reference normals of triangles at many times, and the angles between exact normals
/// and other normals.
///
/// Results have the same bits as those of the scalar functions: reference_normals() of analysis/quality.h, which
/// returns the same directions with other lengths, and portable::atan2(|n x u|, n . u).
#ifndef CHRONORMAL_ANALYSIS_QUALITY_KERNELS_REFERENCE_ANGLES_H_
#define CHRONORMAL_ANALYSIS_QUALITY_KERNELS_REFERENCE_ANGLES_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Some triangles of a segment, whose reference normals are computed at any t. Positions are gathered once, so that
/// each t costs one pass over contiguous memory.
class ReferenceTriangles {
 public:
  /// Takes faces of a segment, which must all be triangles. The arrays of the segment must outlive the object, since
  /// the arrays are read again where double is not accurate enough.
  ReferenceTriangles(const Segment& segment, IndexRange faces);

  /// Writes n(t) of each face divided by its largest component, or (0, 0, 0) where reference_normals() writes (0, 0,
  /// 0). Preconditions: result has one element per face; t is in [0, 1].
  void normals(double t, std::span<Vec3d> result) const noexcept;

 private:
  Segment segment_;
  IndexRange faces_;
  // The values of each triangle that do not depend on t: 20 values per triangle, in groups of eight triangles.
  std::vector<double> edges_;
};

/// The numbers that stand in place of an angle: kNoExactNormal if the exact normal is zero, kNoNormal if the rendered
/// normal is zero or not finite.
inline constexpr double kNoExactNormal = -1, kNoNormal = -2;

/// Writes the angle in radians between each exact normal, which need not be a unit vector, and the rendered normal.
/// Writes kNoExactNormal instead if the exact normal is zero, and otherwise kNoNormal if the rendered normal is zero or
/// not finite. The function is fastest if the largest component of each exact normal is 1. Precondition: all three
/// arrays have the same size.
void angles_to_exact(std::span<const Vec3d> exact, VectorView<const float> shown, std::span<double> angles) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_KERNELS_REFERENCE_ANGLES_H_
