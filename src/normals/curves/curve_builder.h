/// Builds curves. Packs control normals, sixteen at a time, into the blocks that take the fewest bytes.
///
///     source --tiles--> how precise each must be --> runs of blocks of one kind --> packed, one after the other
///
/// Elements are processed in chunks of 32 tiles, which stay in cache from the first step to the last. Several threads
/// may build parts of 4 to 32 chunks at once. The boundaries of the parts do not depend on the threads, so the bits of
/// the curves do not depend on the threads either.
#ifndef CHRONORMAL_NORMALS_CURVES_CURVE_BUILDER_H_
#define CHRONORMAL_NORMALS_CURVES_CURVE_BUILDER_H_

#include <memory>
#include <span>

#include "chronormal/core/parallel.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/curves/curve_data.h"

namespace chronormal::inline internal {

/// Builds the curves of elements whose control normals already exist.
[[nodiscard]] CurveData build_curves(std::span<const ControlNormals> normals, const CurveOptions& options);

/// Build the curves of all faces of a segment, and of all elements of groups. If `reuse` is not nullptr, these curves
/// are emptied and their memory is used again.
[[nodiscard]] CurveData build_curves(const Segment& segment, const CurveOptions& options, Threads threads,
                                     CurveData* reuse);
[[nodiscard]] CurveData build_curves(const Segment& segment, const NormalGroups& groups, const CurveOptions& options,
                                     Threads threads, CurveData* reuse);

/// A builder that makes the same curves as build_curves(), on one thread and in slices, for MeshNormals::prepare(). The
/// segment and the groups must outlive the object.
class CurveSlices {
 public:
  CurveSlices(const Segment& segment, const NormalGroups* groups, const CurveOptions& options, CurveData* reuse);
  CurveSlices(const CurveSlices&) = delete;
  CurveSlices& operator=(const CurveSlices&) = delete;
  ~CurveSlices();

  /// Does a share of all work, from 0 to 1, or the rest of the work if less is left. Returns true if all work is done.
  bool advance(double share);
  /// Does the rest of the work, and returns the curves. Must not be called again.
  [[nodiscard]] CurveData finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_BUILDER_H_
