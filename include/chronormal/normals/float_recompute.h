/// Unit normals recomputed from positions in float32 throughout: the fastest way that we know, for shading that needs
/// no more accuracy than most programs have.
///
/// NormalRecompute promises 1e-6 rad and pays for it. FloatRecompute promises nothing of the kind: it interpolates
/// positions, subtracts them, and adds up cross products, each in float32, sixteen elements at a time. Curves have to
/// be measured against it where nobody asks for more accuracy.
///
///     FloatRecompute recompute(motion.topology, groups);       // once for a mesh
///     recompute.unit_normals(motion.segment(i), t, result);    // at any t of any of its segments
///
/// Accuracy   1e-4 rad or better on an ordinary mesh, without a bound for all: a position is off by 2^-24 of its
///            distance from the origin, and turns a normal by that over the height of its triangle. Bad inputs are
///            meshes far from the origin or finely divided (the error grows with coordinate over edge), needles and
///            slivers, faces that collapse in the segment, and vertices whose faces nearly cancel. It looks for no
///            limit direction.
/// Zeros      The result is (0, 0, 0) where |n|^2 is not a normal number of float32: for elements without area or
///            without a face, for edges below 1e-10 or above 1e9, and for infinities and NaN among the positions.
/// Order      The cross products of an element are added from neighbour to neighbour, and polygons as fans from the
///            element's own corner, in an order that follows from the topology and the groups.
/// Memory     4 bytes for each corner and 8 or more for each element of groups, for paths around vertices in slices of
///            sixteen, each as long as its longest path; 16 bytes for each vertex, for its interpolated position.
/// Ownership  the topology must outlive the object; groups are only read when it is made.
/// Threads    unit_normals() uses the scratch of the object: one call at a time. On one thread it does not allocate or
///            throw. Results have the same bits on every instruction set, compiler and number of threads.
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
  /// Creates an object of no elements.
  FloatRecompute() noexcept;
  /// Objects can be moved, which leaves an object of no elements, but not copied.
  FloatRecompute(FloatRecompute&&) noexcept;
  FloatRecompute& operator=(FloatRecompute&&) noexcept;
  ~FloatRecompute();
  /// Prepares for the normals of all faces of a mesh. Throws std::bad_alloc only.
  explicit FloatRecompute(const Topology& topology);
  /// Prepares for those of the elements of groups, which must be groups of the topology that keep their corners.
  /// O(corners).
  FloatRecompute(const Topology& topology, const NormalGroups& groups);

  /// Writes n / |n| of every element at t of a segment, and returns the number of (0, 0, 0) written. What t outside
  /// [0, 1] and NaN mean is said in control_normals.h.
  /// the segment must have as many vertices as the topology; result must have size() elements
  std::size_t unit_normals(const Segment& segment, double t, VectorView<float> result, Threads threads = Threads::kOne);
  /// The same from given positions, for example of blend shapes.
  std::size_t unit_normals(VectorView<const float> positions, VectorView<float> result,
                           Threads threads = Threads::kOne);

  /// The number of elements.
  [[nodiscard]] std::size_t size() const noexcept;
  /// The memory that paths and positions take, in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;  // nullptr: no elements
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_FLOAT_RECOMPUTE_H_
