/// Unit normals from positions in float32 throughout: the fastest way that we know to make them anew, where shading
/// needs no more than most programs have.
///
/// NormalRecompute promises 1e-6 rad and pays for it. This one promises nothing of the kind: it interpolates positions,
/// subtracts them, and adds up cross products, each in float32, sixteen elements at a time. It is what curves have to
/// be measured against where nobody asks for more.
///
///     FloatRecompute recompute(motion.topology, groups);       // once for a mesh
///     recompute.unit_normals(motion.segment(i), t, result);    // at any t of any of its segments
///
/// Accuracy   of an ordinary mesh 1e-4 rad or better, and no bound for all: a position is off by 2^-24 of its distance
///            from the origin, and turns a normal by that over the height of its triangle. Bad inputs are meshes far from
///            the origin or finely divided (the error grows with coordinate over edge), needles and slivers, faces that
///            collapse on their way, and vertices whose faces nearly cancel. No limit direction is looked for.
/// Zeros      (0, 0, 0) where |n|^2 is not a normal number of float32: no area, edges below 1e-10 or above 1e9,
///            infinities and NaN among the positions, elements without a face.
/// Order      sums are added around an element from neighbour to neighbour, polygons as fans from the element's own
///            corner, in an order that follows from the topology and the groups.
/// Memory     4 bytes for each corner and 8 or more for each element of groups, which are paths around vertices in
///            slices of sixteen (the longest of them counts); 16 bytes for each vertex, for its interpolated position.
/// Ownership  the topology must outlive the object; groups are only read when it is made.
/// Threads    unit_normals() uses the scratch of the object: one call at a time. On one thread it does not allocate or
///            throw. The same bits on every instruction set, compiler and number of threads.
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
  /// Objects can be moved, which leaves one of no elements, but not copied.
  FloatRecompute(FloatRecompute&&) noexcept;
  FloatRecompute& operator=(FloatRecompute&&) noexcept;
  ~FloatRecompute();
  /// Makes the normals of the faces of a mesh. Throws std::bad_alloc only.
  explicit FloatRecompute(const Topology& topology);
  /// Makes those of the elements of groups, which must be of the topology and have their corners. O(corners).
  FloatRecompute(const Topology& topology, const NormalGroups& groups);

  /// Writes n / |n| of every element at t of a segment, and returns the number of (0, 0, 0) written. What t outside
  /// [0, 1] and NaN mean is said in control_normals.h.
  /// the segment must have as many vertices as the topology; result must have size() elements
  std::size_t unit_normals(const Segment& segment, double t, VectorView<float> result, Threads threads = Threads::kOne);
  /// The same from positions as they are, of blend shapes say.
  std::size_t unit_normals(VectorView<const float> positions, VectorView<float> result,
                           Threads threads = Threads::kOne);

  /// How many elements there are.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Memory of paths and positions, in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;  // nothing: of no elements
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_FLOAT_RECOMPUTE_H_
