/// Unit normals from positions, made anew at every t: eq. 1 and eq. 2 as they stand, as fast as we can write them.
///
/// The baseline that NormalCurves is compared with; it is the faster of the two for one evaluation or two. Nothing is
/// prepared but scratch memory; positions and topology are read at every call and must stay alive, and positions may
/// change between calls.
///
/// Accuracy   within 1e-6 rad of the exact n(t) of the positions at the double t, whatever they are: edges in float32
///            and all that follows in double if a bound on the rounding shows that it suffices (edges are interpolated,
///            not vertices, so the distance from the origin does not matter), double throughout if that suffices, and
///            integers behind it (docs/theory.md, section 5). The limit direction where n(t) is exactly zero.
///            control_normals.h says what t outside [0, 1], NaN and rounding modes mean.
/// Groups     face normals are made a little ahead of the elements that add them up, in a window that stays in the
///            cache; where the faces of neighbouring elements are far apart, in memory for all of them.
/// Memory     scratch of 16 bytes for each face of the window, or for all; and where vertices lie in no order, or not
///            as x y z, 32 bytes for each.
/// Order      sums are added in the order of groups.faces(): shuffling the faces of the mesh gives the same bits.
/// Threads    unit_normals() uses the scratch of the object: one call at a time. On one thread it does not throw, and
///            does not allocate but for groups around faces of more than 64 corners. The same bits on every
///            instruction set, compiler and number of threads.
/// Speed      triangles whose positions are packed, and results aligned to 64 bytes, as planes or packed, are fastest;
///            polygons go one by one.
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_H_

#include <cstddef>
#include <memory>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

/// Writes the unit normals at t of a range of faces; see NormalRecompute, whose bits they have. Pure: no allocation, no
/// throw, and no scratch, so that meshes in no order and positions that are not packed are slower.
/// result must have faces.count elements; faces must lie inside the topology
std::size_t unit_normals_at(const Segment& segment, IndexRange faces, const LocalTime& t,
                            VectorView<float> result) noexcept;

class NormalRecompute {
 public:
  /// Creates an object of no elements.
  NormalRecompute() noexcept;
  /// Objects can be moved, which leaves one of no elements, but not copied.
  NormalRecompute(NormalRecompute&&) noexcept;
  NormalRecompute& operator=(NormalRecompute&&) noexcept;
  ~NormalRecompute();
  /// Makes the normals of the faces of a segment. Throws std::bad_alloc only.
  explicit NormalRecompute(const Segment& segment);
  /// Makes the normals of the elements of groups, which must be groups of the segment's topology and outlive the
  /// object.
  NormalRecompute(const Segment& segment, const NormalGroups& groups);

  /// Writes n(t) / |n(t)| of every element. Where n(t) = 0 it is the limit direction (see Direction), or (0, 0, 0)
  /// where n is zero throughout. Returns the number of (0, 0, 0) written.
  /// result must have size() elements
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads = Threads::kOne);

  /// Returns the number of elements.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns the bytes of scratch memory.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;  // nothing: of no elements
};

// Unit normals recomputed from positions in float32 throughout: the fastest way that we know, for shading that needs
// no more accuracy than most programs have.
//
// NormalRecompute promises 1e-6 rad and pays for it. FloatRecompute promises nothing of the kind: it interpolates
// positions, subtracts them, and adds up cross products, each in float32, sixteen elements at a time. Curves have to
// be measured against it where nobody asks for more accuracy.
//
//     FloatRecompute recompute(motion.topology, groups);       // once for a mesh
//     recompute.unit_normals(motion.segment(i), t, result);    // at any t of any of its segments
//
// Accuracy   1e-4 rad or better on an ordinary mesh, without a bound for all: a position is off by 2^-24 of its
//            distance from the origin, and turns a normal by that over the height of its triangle. Bad inputs are
//            meshes far from the origin or finely divided (the error grows with coordinate over edge), needles and
//            slivers, faces that collapse in the segment, and vertices whose faces nearly cancel. It looks for no
//            limit direction.
// Zeros      The result is (0, 0, 0) where |n|^2 is not a normal number of float32: for elements without area or
//            without a face, for edges below 1e-10 or above 1e9, and for infinities and NaN among the positions.
// Order      The cross products of an element are added from neighbour to neighbour, and polygons as fans from the
//            element's own corner, in an order that follows from the topology and the groups.
// Memory     4 bytes for each corner and 8 or more for each element of groups, for paths around vertices in slices of
//            sixteen, each as long as its longest path; 16 bytes for each vertex, for its interpolated position.
// Ownership  the topology must outlive the object; groups are only read when it is made.
// Threads    unit_normals() uses the scratch of the object: one call at a time. On one thread it does not allocate or
//            throw. Results have the same bits on every instruction set, compiler and number of threads.

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
  /// Prepares for the normals of the elements of groups, which must be groups of the topology that keep their corners.
  /// O(corners).
  FloatRecompute(const Topology& topology, const NormalGroups& groups);

  /// Writes n / |n| of every element at t of a segment, and returns the number of (0, 0, 0) written. control_normals.h
  /// says what t outside [0, 1] and NaN mean.
  /// the segment must have as many vertices as the topology; result must have size() elements
  std::size_t unit_normals(const Segment& segment, double t, VectorView<float> result, Threads threads = Threads::kOne);
  /// Writes the normals of given positions, for example of blend shapes.
  std::size_t unit_normals(VectorView<const float> positions, VectorView<float> result,
                           Threads threads = Threads::kOne);

  /// Returns the number of elements.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns the bytes that paths and positions take.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;  // nullptr: no elements
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_H_
