/// Measures the errors of interpolated normals against exact ones, like Table 1 of the paper.
///
/// The angles between the interpolated and the exact normal are summed over all elements and segments of a mesh, at N
/// equidistant t = i / (N - 1) of each segment. A sample is one element at one t. A sample whose exact normal is zero
/// is counted as degenerate and left out of the sum. A sample whose exact normal has a direction, but for which the
/// scheme has none, is counted as missing and left out, too.
///
/// The exact normals that schemes are compared with are computed as in the paper, by the cross product (eq. 1) of
/// vertices interpolated at t, in double and from positions alone. This computation uses neither control normals nor
/// schemes, so an error in either cannot stay hidden.
///
/// Units      radians; only output for people is in degrees.
#ifndef CHRONORMAL_ANALYSIS_QUALITY_H_
#define CHRONORMAL_ANALYSIS_QUALITY_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Writes n(t) of a range of faces. n(t) is a sum of products. If the sum is below 1e-10 of the size of these products,
/// double cannot tell it from rounding errors, and integer arithmetic computes n(t). The result is (0, 0, 0) if n(t) is
/// zero, or so close to zero that rounding t to a double would change its direction. Threads: pure. Preconditions:
/// result has faces.count elements; t is in [0, 1].
void reference_normals(const Segment& segment, IndexRange faces, double t, std::span<Vec3d> result) noexcept;

/// Returns n(t) of a vertex or corner, as accurately as reference_normals(). n(t) is the sum of the normals of the
/// given faces, which may nearly cancel. Threads: pure. Precondition: t is in [0, 1].
[[nodiscard]] Vec3d reference_normal(const Segment& segment, std::span<const std::uint32_t> faces, double t) noexcept;

/// The normal n(t) of a face in double, and the sum of the absolute values of the products that n(t) consists of. The
/// sum bounds the rounding error of the normal.
struct ReferenceArea {
  Vec3d n;
  double products = 0;
};
[[nodiscard]] ReferenceArea reference_area(const Segment& segment, std::uint32_t face, double t) noexcept;

/// The place of an angular error: a segment, an element and a t in the segment.
struct ErrorPlace {
  std::size_t segment = 0;
  std::size_t element = 0;
  double t = 0;
};

struct Quality {
  double sum = 0;              ///< sum of the angles in radians, from which the paper's q and Q follow
  double sum_of_squares = 0;   ///< sum of the squared angles, in radians squared
  double max = 0;              ///< the largest angle in radians
  ErrorPlace max_at;           ///< the first place with the largest angle
  std::size_t count = 0;       ///< number of samples whose angles were summed
  std::size_t degenerate = 0;  ///< number of samples without an exact normal, which are left out
  std::size_t missing = 0;     ///< number of samples for which the scheme has no normal, which are left out

  [[nodiscard]] double mean() const noexcept;  ///< the mean angle in radians; 0 if nothing was summed
  [[nodiscard]] double rms() const noexcept;   ///< the root of the mean squared angle, in radians

  /// Adds the errors of a batch of samples of one segment at one t. The error of element first.element + i is the angle
  /// between normals[i] and exact[i], which need not be unit vectors.
  void add(std::span<const Vec3d> exact, VectorView<const float> normals, const ErrorPlace& first);

  /// Adds the sums of another object to the sums of this object. If the same objects are added in the same order, the
  /// sums have the same bits.
  void add(const Quality& other);
};

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_H_
