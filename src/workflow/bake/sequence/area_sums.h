/// Normals of elements as sums of the vector areas of the faces around them. Private to workflow.
///
/// Each block of elements computes the areas of the faces around it by itself, so that they stay in a cache near the
/// core. Faces between two blocks are computed twice. If that would be too many, because faces and elements are in no
/// common order, all areas are computed first.
///
/// Threads    each function uses all cores (core/parallel.h); the same bits on any number of threads.
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

/// A point, or its displacement, for each vertex: rows of four doubles, of which three count.
using PointRows = AlignedArray<double>;

class AreaSums {
 public:
  /// The topology and the groups must outlive this.
  AreaSums(const Topology& topology, const NormalGroups& groups);

  /// Calls body(elements, sums_of_a, sums_of_b) for blocks of elements, each with the sums of the areas at the points a
  /// and b. The sums are valid until body returns. b may be nullptr, and then has no sums.
  using Body = std::function<void(IndexRange elements, std::span<const Vec3d> of_a, std::span<const Vec3d> of_b)>;
  void each_block(const PointRows& a, const PointRows* b, const Body& body) const { each_block(a, b, {}, {}, body); }
  /// Does the same. If the areas of an element cancel to less than 2^-20 of their size, so that the sum is hardly more
  /// than their rounding error, the sum is computed by the function of_a or of_b, which is called on several threads at
  /// once.
  using Exact = std::function<Vec3d(std::size_t element)>;
  void each_block(const PointRows& a, const PointRows* b, const Exact& of_a, const Exact& of_b, const Body& body) const;

 private:
  // Replaces sums that cancel. first_face is the face of the first row of areas.
  void settle(const double* areas, std::size_t first_face, IndexRange elements, const Exact& exact,
              std::span<Vec3d> sums) const;
  void write_areas(const PointRows& points, IndexRange faces, double* areas) const;

  const Topology* topology_;
  const NormalGroups* groups_;
  std::vector<IndexRange> faces_of_block_;  // the faces around its elements, and those between them
  bool are_scattered_ = false;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_AREA_SUMS_H_
