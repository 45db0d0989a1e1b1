/// Measures the errors of interpolated normals against exact ones, like Table 1 of the paper.
///
/// The angles to the exact normal at N equidistant t = i / (N - 1) of a segment are summed, over all elements and
/// segments of a mesh. A pair (element, t) whose exact normal is zero is counted as degenerate and left out; a pair for
/// which only the scheme has no direction is counted as missing.
///
/// The exact normals that schemes are compared with are computed as in the paper, by the cross product (eq. 1) of
/// vertices interpolated at t, in double and from positions alone. They use neither control normals nor schemes, so an
/// error in either cannot stay hidden.
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

/// Writes n(t) of a range of faces. n(t) is a sum of products; if it is below 1e-10 of their size, double cannot tell
/// it from rounding errors, and integers compute it. The result is (0, 0, 0) if n(t) is zero, or so close to a zero
/// that rounding t would turn it. Threads: pure. result must have faces.count elements; t in [0, 1]
void reference_normals(const Segment& segment, IndexRange faces, double t, std::span<Vec3d> result) noexcept;

/// Returns n(t) of a vertex or corner in the same way: the sum of the normals of its faces, even if they nearly cancel.
/// Threads: pure. t in [0, 1]
[[nodiscard]] Vec3d reference_normal(const Segment& segment, std::span<const std::uint32_t> faces, double t) noexcept;

/// The normal n(t) of a face in double, and the size of the products whose sum it is, which determines its rounding
/// error.
struct ReferenceArea {
  Vec3d n;
  double products = 0;
};
[[nodiscard]] ReferenceArea reference_area(const Segment& segment, std::uint32_t face, double t) noexcept;

/// The place of an angular error.
struct ErrorPlace {
  std::size_t segment = 0;
  std::size_t element = 0;
  double t = 0;
};

struct Quality {
  double sum = 0;              ///< sum of the angles in radians: q and Q of the paper
  double sum_of_squares = 0;   ///< radians squared
  double max = 0;              ///< radians
  ErrorPlace max_at;           ///< the first place with the largest angle
  std::size_t count = 0;       ///< pairs that were summed
  std::size_t degenerate = 0;  ///< pairs without an exact normal, left out
  std::size_t missing = 0;     ///< pairs without a normal of the scheme, left out

  [[nodiscard]] double mean() const noexcept;  ///< radians; 0 if nothing was summed
  [[nodiscard]] double rms() const noexcept;   ///< radians

  /// Adds the errors of a batch: the angles between exact[i], which need not be unit vectors, and normals[i], for the
  /// elements first_element + i of one segment at one t.
  void add(std::span<const Vec3d> exact, VectorView<const float> normals, const ErrorPlace& first);

  /// Adds the sums of another object. Adding the same parts in the same order gives the same bits.
  void add(const Quality& other);
};

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_H_
