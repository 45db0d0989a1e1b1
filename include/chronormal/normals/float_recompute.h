/// Unit normals recomputed from positions entirely in float32: the fastest method that we know, for shading with the
/// accuracy of most programs.
///
/// MeshNormals and NormalCurves guarantee the accuracy of normals, and prepare a segment for this purpose.
/// FloatRecompute prepares nothing for a segment and guarantees no accuracy. It interpolates positions, subtracts them,
/// and adds up cross products, all in float32, for sixteen elements at a time. It is faster than MeshNormals if a
/// segment is evaluated only a few times (docs/benchmarks.md, "Frames of a segment").
///
///     FloatRecompute recompute(motion.topology, groups);       // once for a mesh
///     recompute.unit_normals(motion.segment(i), t, result);    // at any t of any of its segments
///
/// Accuracy   1e-4 rad or better on ordinary meshes, without a general bound: a position has an error of 2^-24 of its
///            distance from the origin, which turns a normal by that error divided by the height of the triangle.
///            Errors are large for meshes far from the origin or finely divided (they grow with coordinates divided by
///            edges), needles and slivers, faces that collapse in the segment, and vertices whose faces nearly cancel.
///            Limit directions are not computed.
/// Zeros      The result is (0, 0, 0) if |n|^2 is not a normal number of float32: for elements without area or
///            without a face, for edges below 1e-10 or above 1e9, and for infinities and NaN among the positions.
/// Order      The cross products of an element are added from neighbour to neighbour, and polygons as fans from the
///            element's own corner, in an order that follows from the topology and the groups.
/// Memory     4 bytes for each corner and 8 or more for each element of groups, for the paths around vertices, which
///            are stored in slices of sixteen paths, each slice as long as its longest path; 16 bytes for each vertex,
///            for its interpolated position.
/// Ownership  the topology must outlive the object; groups are only read when it is made.
/// Threads    unit_normals() uses the scratch of the object, so only one call may run at a time. With one thread it
///            does not allocate or throw. Results have the same bits on every instruction set, compiler and number of
///            threads.
#ifndef CHRONORMAL_NORMALS_FLOAT_RECOMPUTE_H_
#define CHRONORMAL_NORMALS_FLOAT_RECOMPUTE_H_

#include <cstddef>
#include <memory>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

class FloatRecompute {
 public:
  /// Creates an object without elements.
  FloatRecompute() noexcept;
  /// Objects can be moved, but not copied. An object that was moved from has no elements.
  FloatRecompute(FloatRecompute&&) noexcept;
  FloatRecompute& operator=(FloatRecompute&&) noexcept;
  ~FloatRecompute();
  /// Prepares the normals of the faces of a mesh. Throws only std::bad_alloc.
  explicit FloatRecompute(const Topology& topology);
  /// Prepares the normals of the elements of groups. The groups must belong to the topology, and forget_corners() was
  /// not called for them. O(corners).
  FloatRecompute(const Topology& topology, const NormalGroups& groups);

  /// Writes n / |n| of every element at t of a segment, and returns the number of (0, 0, 0) written. A t outside [0, 1]
  /// is moved to the nearer end; if t is NaN, every normal is (0, 0, 0). Preconditions: the segment has as many
  /// vertices as the topology; result has size() elements.
  std::size_t unit_normals(const Segment& segment, double t, VectorView<float> result, Threads threads = Threads::kOne);
  /// Writes the normals of a mesh with the given positions, for example of blend shapes, and returns the number of (0,
  /// 0, 0) written.
  std::size_t unit_normals(VectorView<const float> positions, VectorView<float> result,
                           Threads threads = Threads::kOne);

  /// Returns the number of elements.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns the bytes of memory that the paths around elements and the interpolated positions take.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;  // nullptr if there are no elements
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_FLOAT_RECOMPUTE_H_
