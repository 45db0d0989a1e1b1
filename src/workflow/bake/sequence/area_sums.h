/// Computes normals of elements as sums of the vector areas of the faces around them. Private to workflow.
///
/// Each block of elements computes the areas of its faces itself, so that these areas stay in a cache near the core.
/// Areas of faces between two blocks are computed twice. If faces are in a very different order than elements, too many
/// areas would be computed twice. The areas of all faces are then computed first.
///
/// Threads    Each function uses all cores (core/parallel.h). The results have the same bits on any number of threads.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_AREA_SUMS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_AREA_SUMS_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "core/memory.h"

namespace chronormal::inline internal {

/// Rows with a point, or its displacement, for each vertex. A row has four doubles, of which the first three are used.
using PointRows = AlignedArray<double>;

class AreaSums {
 public:
  /// Divides the elements into blocks. The topology and the groups must outlive this object.
  AreaSums(const Topology& topology, const NormalGroups& groups);

  /// Calls body(elements, sums_of_a, sums_of_b) for each block of elements. The sums are the vector areas around each
  /// element, for the points a and for the points b. The sums are valid until body returns. If b is nullptr, sums_of_b
  /// is empty.
  using Body = std::function<void(IndexRange elements, std::span<const Vec3d> of_a, std::span<const Vec3d> of_b)>;
  void each_block(const PointRows& a, const PointRows* b, const Body& body) const { each_block(a, b, {}, {}, body); }
  /// Calls body for each block of elements, with more exact sums. If the vector areas around an element cancel to less
  /// than 2^-20 of the sum of their sizes, their sum is hardly more than rounding error, and of_a() or of_b() computes
  /// the sum instead. Both functions are called on several threads at the same time.
  using Exact = std::function<Vec3d(std::size_t element)>;
  void each_block(const PointRows& a, const PointRows* b, const Exact& of_a, const Exact& of_b, const Body& body) const;

 private:
  // Replaces the sums of elements whose vector areas cancel. first_face is the index of the face to which the first row
  // of `areas` belongs.
  void settle(const double* areas, std::size_t first_face, IndexRange elements, const Exact& exact,
              std::span<Vec3d> sums) const;
  void write_areas(const PointRows& points, IndexRange faces, double* areas) const;

  const Topology* topology_;
  const NormalGroups* groups_;
  std::vector<IndexRange> faces_of_block_;  // for each block, the first to the last face around its elements
  bool are_scattered_ = false;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_AREA_SUMS_H_
