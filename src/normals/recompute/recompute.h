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
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_RECOMPUTE_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_RECOMPUTE_H_

#include <cstddef>
#include <memory>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

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

  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns the number of bytes of scratch memory.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;  // nullptr if there are no elements
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_RECOMPUTE_H_
