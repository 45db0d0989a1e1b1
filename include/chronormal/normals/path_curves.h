/// Unit normals of vertices on cubics, of degree 6 in time, at the speed of memory: NormalCurves for curved paths.
///
/// The seven control normals of an element are kept in float32, 84 bytes, divided by a power of two, and evaluated by a
/// kernel: a Bernstein sum and a root. Where n(t) may get shorter than 1 / 2.6 of sum w_k |c_k|, float32 might not keep
/// the element within kPathAngle at every t. Such an element is flagged and evaluated in double, with the degenerate
/// cases of unit_normal_at() in paths.h. That n(t) stays longer is proven, and not sampled: either all seven control
/// normals lie within 67 degrees of one direction, or 2.6^2 |n|^2 - (sum w_k |c_k|)^2 has, after some subdivisions, no
/// negative Bernstein coefficient.
///
/// Units      t: fraction of the segment, in [0, 1]; a t outside is moved to the nearer end.
/// Errors     none; a t of NaN gives (0, 0, 0).
/// Threads    const members may run at once. Results have the same bits on any number of threads and on every
///            instruction set.
#ifndef CHRONORMAL_NORMALS_PATH_CURVES_H_
#define CHRONORMAL_NORMALS_PATH_CURVES_H_

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/paths.h"

namespace chronormal {

/// The largest angle, in radians, between a normal of PathCurves and the exact one of the same control normals. How far
/// these may be from those of the curve itself, for needles above all, is in docs/theory.md, section 11.
inline constexpr double kPathAngle = 1e-6;

/// Computes the control normals of all faces, or of all groups of their corners, on all cores. Each takes 168 bytes.
[[nodiscard]] std::vector<PolynomialNormals<3>> all_path_normals(const PolynomialSegment<3>& segment);
[[nodiscard]] std::vector<PolynomialNormals<3>> all_path_normals(const PolynomialSegment<3>& segment,
                                                                 const NormalGroups& groups);

class PathCurves {
 public:
  /// Creates curves of no elements.
  PathCurves() noexcept;
  /// Packs control normals, each independently of the others.
  explicit PathCurves(std::span<const PolynomialNormals<3>> normals, Threads threads = Threads::kOne);
  /// Packs those of all faces of a segment, or of all elements of the groups, some thousands at a time, so that no array
  /// of all of them is needed. Nothing of the segment is kept. Throws std::bad_alloc.
  explicit PathCurves(const PolynomialSegment<3>& segment, Threads threads = Threads::kOne);
  PathCurves(const PolynomialSegment<3>& segment, const NormalGroups& groups, Threads threads = Threads::kOne);
  PathCurves(PathCurves&& other) noexcept;
  PathCurves& operator=(PathCurves&& other) noexcept;
  ~PathCurves();

  /// Writes the unit normals of all elements at t. Returns how many have no direction, and got (0, 0, 0).
  /// result must have as many vectors as there are elements
  std::size_t unit_normals(double t, VectorView<float> result, Threads threads = Threads::kOne) const;

  [[nodiscard]] std::size_t size() const noexcept;
  /// The number of elements that are evaluated in double.
  [[nodiscard]] std::size_t flagged_count() const noexcept;
  /// The memory that an evaluation reads, in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_PATH_CURVES_H_
