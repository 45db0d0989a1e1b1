/// Measures the errors of interpolated normals against exact ones, as the paper's Table 1 does.
///
/// For one element, the angles to the exact normal at N equidistant t = i / (N - 1) of a segment are summed; for a
/// mesh, so are those sums over elements and segments. A (element, sample) pair whose exact normal is zero is
/// counted as degenerate and left out; one for which only the scheme has no direction is counted as missing.
///
/// The exact normals that every scheme is held against are computed as the paper writes them, by the cross product
/// (eq. 1) of vertices interpolated at t, in double and from nothing but positions: no control normals and no scheme,
/// so that an error of those cannot hide here.
///
/// Units      radians inside; what is shown to people is in degrees.
#ifndef CHRONORMAL_ANALYSIS_QUALITY_H_
#define CHRONORMAL_ANALYSIS_QUALITY_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Writes n(t) of a range of faces. Where double cannot tell it from rounding (below 1e-10 of the products that it is
/// the sum of), it is computed in integers; it is (0, 0, 0) where it is zero, and where it passes a zero so near that a
/// rounding of t would turn it. Threads: pure.
/// result must have faces.count elements; t in [0, 1]
void reference_normals(const Segment& segment, IndexRange faces, double t, std::span<Vec3d> result) noexcept;

/// Returns n(t) of a vertex or corner in the same way: the sum of the normals of its faces, however far they cancel.
/// Threads: pure. t in [0, 1]
[[nodiscard]] Vec3d reference_normal(const Segment& segment, std::span<const std::uint32_t> faces, double t) noexcept;

/// The normal n(t) of a face in double, and the size of the products that it is the sum of, by which its rounding is
/// judged.
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
  double sum = 0;              ///< of the angles, radians: q and Q of the paper
  double sum_of_squares = 0;   ///< radians squared
  double max = 0;              ///< radians
  ErrorPlace max_at;           ///< the first place of the largest angle
  std::size_t count = 0;       ///< pairs that were summed
  std::size_t degenerate = 0;  ///< pairs without an exact normal, left out
  std::size_t missing = 0;     ///< pairs without a normal of the scheme, left out

  [[nodiscard]] double mean() const noexcept;  ///< radians; 0 where nothing was summed
  [[nodiscard]] double rms() const noexcept;   ///< radians

  /// Adds the errors of one batch: the angles between exact[i] (any length) and normals[i], for the elements
  /// first_element + i of one segment at one t.
  void add(std::span<const Vec3d> exact, VectorView<const float> normals, const ErrorPlace& first);

  /// Adds what was measured elsewhere. Adding the same parts in the same order gives the same bits.
  void add(const Quality& other);
};

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_H_
