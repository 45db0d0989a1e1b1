/// The missing normals of a mesh: the errors that the deltas of its own targets leave at the instants of the file.
/// The errors form the matrix that correction targets of low rank approximate (docs/theory.md, section 17). Private
/// to workflow.
///
/// Points     A point is a set of vertices that show the same normal. They have the same element and the same stored
///            base normal.
/// Shapes     (points, 3, stride) floats. The first rows() floats of each run of `stride` floats are values, and the
///            rest is 0.
/// Units      The length of the stored base normal is 1.
/// Threads    Uses all cores. The result has the same bits on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FITS_MISSING_NORMALS_H_
#define CHRONORMAL_WORKFLOW_BAKE_FITS_MISSING_NORMALS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "workflow/bake/deltas/right_normals.h"
#include "workflow/bake/deltas/vertex_columns.h"
#include "workflow/bake/poses/extra_curves.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

/// Rounds a number of floats up to a multiple of 16, so that loops handle whole groups of floats.
[[nodiscard]] constexpr std::size_t padded_to(std::size_t count) noexcept {
  constexpr std::size_t kPadding = 16;
  return (count + kPadding - 1) / kPadding * kPadding;
}

/// The vertices of a point: they show the same normal. The first vertex stands for all of them.
using PointVertices = std::vector<std::uint32_t>;

/// Groups vertices with the same normal into points. Leaves out vertices whose base normal is too short to divide
/// deltas by.
[[nodiscard]] std::vector<PointVertices> points_of(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                                                   std::span<const std::uint32_t> element_of_vertex);

/// All instants of a file at which the weight curves of correction targets have values. The nodes of each track come
/// first, and then the poses that the file stores.
struct FileInstants {
  explicit FileInstants(const MeshWeights& weights);

  std::vector<CurveNodes> tracks;
  std::vector<std::size_t> first;  ///< the first instant of each track, and of the poses that the file stores
  PoseList poses;
};

/// The rows of a fit. Each row is a pose, with the weights of the mesh's own targets, and with the rendered and the
/// missing normals of all points.
class MissingNormals {
 public:
  /// Computes the missing normals. `own` has the deltas of the mesh's own targets for the first vertex of each point.
  /// If `across` is true, the missing vectors are perpendicular to the stored normal where such vectors can reach the
  /// right direction. The length of the resulting normal is then not fixed.
  MissingNormals(const RightNormals& rights, std::span<const PointVertices> points,
                 std::span<const std::uint32_t> element_of_vertex, const VertexColumns& own, PoseList poses,
                 bool across = false);

  [[nodiscard]] std::size_t points() const noexcept { return numbers_.size(); }
  [[nodiscard]] std::size_t rows() const noexcept { return poses_.size(); }
  [[nodiscard]] std::size_t stride() const noexcept { return stride_; }
  [[nodiscard]] const PoseList& poses() const noexcept { return poses_; }
  /// Returns the index of a point among the points given to the constructor. This index differs from `point` after
  /// keep_beyond() has removed points.
  [[nodiscard]] std::size_t number(std::size_t point) const { return numbers_[point]; }
  /// Returns the rendered sums of the stored normal and the own deltas for a point, in all rows, as an array (3,
  /// stride). A sum is zero in a row in which the right normal is not known.
  [[nodiscard]] const float* shown(std::size_t point) const { return shown_.data() + 3 * stride_ * point; }
  /// Returns the missing vectors of a point in all rows, (3, stride). A missing vector is the right normal, whose
  /// length is |n(w)| / |n(0)|, minus the sum that shown() returns.
  [[nodiscard]] const float* missing(std::size_t point) const { return missing_.data() + 3 * stride_ * point; }

  /// Returns the inner products of the missing normals of each two rows, (rows, rows). A product is a sum over every
  /// step-th point. Each missing normal is multiplied by the importance of its point. Partial sums over a few points
  /// are computed in float32, and these sums are added up in double.
  [[nodiscard]] std::vector<double> inner_products(std::span<const float> importance, std::size_t step = 1) const;

  /// Adds `more` (3, stride) to the rendered sums of a point, and subtracts it from the missing vectors of this point.
  void show_more(std::size_t point, std::span<const float> more);
  /// Removes each point whose error is at most `degrees` in all rows.
  void keep_beyond(double degrees);

 private:
  PoseList poses_;
  std::size_t stride_;
  std::vector<std::size_t> numbers_;
  std::vector<float> shown_, missing_;
};

/// Returns a measure of the angle between two vectors of any length. The measure grows with the angle, from 0 to 2, and
/// needs no arc tangent. For angles up to a right angle the measure is the squared sine, and for larger angles 2 minus
/// the squared sine. The measure is 0 if one of the vectors is zero.
[[nodiscard]] inline float openness(const Vec3f& a, const Vec3f& b) noexcept {
  const Vec3f aside = cross(a, b);
  const float across = dot(aside, aside), along = dot(a, b), both = across + along * along;
  const float square = both > 0 ? across / both : 0;
  return along < 0 ? 2 - square : square;
}
/// Returns the angle that has this openness (the measure that openness() returns), in degrees.
[[nodiscard]] double degrees_of(float openness) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FITS_MISSING_NORMALS_H_
