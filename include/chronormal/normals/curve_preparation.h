/// Curves of normals, prepared a slice at a time for players that cannot spend a whole frame on the next segment.
///
///     CurvePreparation next(motion.segment(i + 1), groups);
///     while (shows_segment(i)) next.prepare(0.4);      // with 2.5 frames in a segment, a frame does two fifths
///     curves = next.take();
///
/// Bits       those of NormalCurves::of_faces() and of_groups(), however the work is cut.
/// Cost       the same in sum; a call does the share that it is asked for, rounded up to 512 elements. For a mesh whose
///            vertices lie in no order, positions are first copied side by side, and for its groups the control normals
///            of all faces are computed; these steps count as a tenth and as two fifths of the work.
/// Ownership  the positions and the topology of the segment, and the groups, must outlive the preparation, and
///            positions must not change before it is done.
/// Threads    one call at a time, which may be on a thread of its own, beside others that evaluate other curves.
#ifndef CHRONORMAL_NORMALS_CURVE_PREPARATION_H_
#define CHRONORMAL_NORMALS_CURVE_PREPARATION_H_

#include <memory>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

inline namespace internal {
class CurveSlices;
}

class CurvePreparation {
 public:
  /// Creates a preparation for the faces of a segment, or for the elements of groups, and does no work yet. `reuse`
  /// means what it means for NormalCurves::of_faces(). Like all of these functions, it throws std::bad_alloc only.
  explicit CurvePreparation(const Segment& segment, const CurveOptions& options = {}, NormalCurves* reuse = nullptr);
  CurvePreparation(const Segment& segment, const NormalGroups& groups, const CurveOptions& options = {},
                   NormalCurves* reuse = nullptr);
  CurvePreparation(CurvePreparation&&) noexcept;
  CurvePreparation& operator=(CurvePreparation&&) noexcept;
  ~CurvePreparation();

  /// Does this share of all the work: everything that is left for 1 or more, nothing for 0, less than 0 or NaN. Returns
  /// whether all work is done.
  bool prepare(double share);
  /// Does what is left, and returns the curves. Afterwards the object may only be destroyed or assigned to.
  [[nodiscard]] NormalCurves take();

 private:
  std::unique_ptr<CurveSlices> slices_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_CURVE_PREPARATION_H_
