/// Curves of normals prepared a little at a time, for players that may not spend a whole frame on the next segment.
///
///     CurvePreparation next(motion.segment(i + 1), groups);
///     while (shows_segment(i)) next.prepare(0.4);      // 2.5 frames in a segment: a frame does two fifths of the work
///     curves = next.take();
///
/// Bits       those of NormalCurves::of_faces() and of_groups(), however the work is cut.
/// Cost       the same in sum; a call does the share that it is asked for, rounded up to 512 elements. On meshes in no order
///            positions are laid out anew first, and of groups the control normals of all faces are made; these count as a
///            tenth of the work, and as two fifths.
/// Ownership  the positions and the topology of the segment, and the groups, must outlive the preparation, and positions
///            must not change before it is done.
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
  /// Of the faces of a segment, or of the elements of groups. `reuse` as NormalCurves::of_faces() has it. Does no work
  /// yet. Throws std::bad_alloc only, as all of these.
  explicit CurvePreparation(const Segment& segment, const CurveOptions& options = {}, NormalCurves* reuse = nullptr);
  CurvePreparation(const Segment& segment, const NormalGroups& groups, const CurveOptions& options = {},
                   NormalCurves* reuse = nullptr);
  CurvePreparation(CurvePreparation&&) noexcept;
  CurvePreparation& operator=(CurvePreparation&&) noexcept;
  ~CurvePreparation();

  /// Does this share of all the work, 1 or more for what is left; nothing for 0 or less, and NaN. Returns whether all is
  /// done.
  bool prepare(double share);
  /// Does what is left, and returns the curves. Afterwards the object may only be destroyed or assigned to.
  [[nodiscard]] NormalCurves take();

 private:
  std::unique_ptr<CurveSlices> slices_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_CURVE_PREPARATION_H_
