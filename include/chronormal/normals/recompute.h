/// Unit normals from positions, recomputed at every t: a direct and fast implementation of eq. 1 and eq. 2 of
/// docs/theory.md.
///
/// This is the baseline for NormalCurves, and is faster than NormalCurves for one or two evaluations. Only scratch
/// memory is prepared. Positions and topology are read at every call and must stay alive; positions may change between
/// calls.
///
/// Accuracy   within 1e-6 rad of the exact n(t) of the positions at the double t, for all inputs. Edges are in float32
///            and the rest is in double if a bound of the rounding allows it (edges are interpolated instead of
///            vertices, so the distance from the origin does not matter); otherwise everything is in double, and if
///            that is not enough, in integers (docs/theory.md, section 5). If n(t) is exactly zero, the result is the
///            limit direction. control_normals.h explains t outside [0, 1], NaN and rounding modes.
/// Groups     face normals are computed slightly ahead of the elements that add them up, in a window that stays in the
///            cache; if the faces of neighbouring elements are far apart, in an array of all faces.
/// Memory     scratch of 16 bytes for each face of the window, or for all faces; and 32 bytes for each vertex if
///            vertices are in random order or not packed.
/// Order      sums are added in the order of groups.faces(): shuffling the faces of the mesh gives the same bits.
/// Threads    unit_normals() uses the scratch of the object, so only one call may run at a time. With one thread it
///            does not throw, and allocates only for groups around faces of more than 64 corners. Results have the same
///            bits on every instruction set, compiler and number of threads.
/// Speed      triangles whose positions are packed, and results aligned to 64 bytes, as planes or packed, are fastest;
///            polygons are computed one by one.
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_H_

#include <cstddef>
#include <memory>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

class NormalRecompute {
 public:
  /// Creates an object without elements.
  NormalRecompute() noexcept;
  /// Objects can be moved, but not copied. An object that was moved from has no elements.
  NormalRecompute(NormalRecompute&&) noexcept;
  NormalRecompute& operator=(NormalRecompute&&) noexcept;
  ~NormalRecompute();
  /// Creates an object for the faces of a segment. Throws only std::bad_alloc.
  explicit NormalRecompute(const Segment& segment);
  /// Creates an object for the elements of groups, which must belong to the segment's topology and outlive the object.
  NormalRecompute(const Segment& segment, const NormalGroups& groups);

  /// Writes n(t) / |n(t)| of every element. If n(t) = 0, the result is the limit direction (see Direction), or (0, 0,
  /// 0) if n is zero in the whole segment. Returns the number of (0, 0, 0) written. Precondition: result has size()
  /// elements.
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads = Threads::kOne);

  /// Returns the number of elements.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns the number of bytes of scratch memory.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;  // nullptr if there are no elements
};

// Unit normals recomputed from positions entirely in float32: the fastest method that we know, for shading with the
// accuracy of most programs.
//
// NormalRecompute guarantees 1e-6 rad, which takes time. FloatRecompute has no such guarantee. It interpolates
// positions, subtracts them, and adds up cross products, all in float32, for sixteen elements at a time. If no more
// accuracy is needed, it is the baseline for curves.
//
//     FloatRecompute recompute(motion.topology, groups);       // once for a mesh
//     recompute.unit_normals(motion.segment(i), t, result);    // at any t of any of its segments
//
// Accuracy   1e-4 rad or better on ordinary meshes, without a general bound: a position has an error of 2^-24 of its
//            distance from the origin, which turns a normal by that error divided by the height of the triangle. Errors
//            are large for meshes far from the origin or finely divided (they grow with coordinates divided by edges),
//            needles and slivers, faces that collapse in the segment, and vertices whose faces nearly cancel. Limit
//            directions are not computed.
// Zeros      The result is (0, 0, 0) if |n|^2 is not a normal number of float32: for elements without area or
//            without a face, for edges below 1e-10 or above 1e9, and for infinities and NaN among the positions.
// Order      The cross products of an element are added from neighbour to neighbour, and polygons as fans from the
//            element's own corner, in an order that follows from the topology and the groups.
// Memory     4 bytes for each corner and 8 or more for each element of groups, for paths around vertices in slices of
//            sixteen, each as long as its longest path; 16 bytes for each vertex, for its interpolated position.
// Ownership  the topology must outlive the object; groups are only read when it is made.
// Threads    unit_normals() uses the scratch of the object, so only one call may run at a time. With one thread it does
//            not allocate or throw. Results have the same bits on every instruction set, compiler and number of
//            threads.

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

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_H_
