/// Computes the deltas and weights of a sequence whose vertices move on curves, for hosts that add up deltas. Private
/// to workflow.
///
/// A cubic through keyframes is linear in their positions: with the weights of its basis, as cubic splines, the targets
/// of keys put every vertex where the curve has it. With the same weights, the unit normals of the keys give a curve
/// through these normals, from which n(t), which has degree 6, differs. Up to two more targets for a segment, with the
/// weights
///
///     4 t (1 - t)    and    10 t (1 - t) (1 - 2 t)
///
/// make the normals right at t = 1/2, or at 1/3 and 2/3. The error that is left is measured at kCurveInstants of each
/// segment.
///
/// Threads    on all cores; the same bits on any number of them
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_CURVED_SEQUENCE_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_CURVED_SEQUENCE_H_

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/paths.h"
#include "workflow/bake/sequence/sequence_deltas.h"
#include "workflow/bake/sequence/sequence_file.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kCurveInstants = 40;

/// A target that bends the normals of a segment by one of the two weights above.
struct CurveBend {
  std::size_t segment = 0;
  bool is_odd = false;  ///< whether its weight is the one that changes its sign at t = 1/2
  std::vector<Vec3d> deltas;
};

/// The normals of a bake on curved paths.
struct CurvedNormals {
  std::vector<SequenceElement> elements;
  std::vector<std::vector<Vec3d>> keys;  ///< what the target of each key adds to N; key 0 adds nothing
  std::vector<CurveBend> bends;          ///< in the order of segments
  double largest_error = 0;              ///< radians
};

/// Examines all segments. Bends are made where an element is off by more than the tolerance, in radians: the fewest
/// that keep it, or else those that leave the smallest error. progress gets the number of segments that are done.
[[nodiscard]] CurvedNormals curved_normals(const Motion& motion, const NormalGroups& groups, PathKind path,
                                           double tolerance, const std::function<void(std::size_t done)>& progress);

/// Finds the keys that have velocities of their own, and so one more target: the velocities are its positions, and its
/// weight has slope 1 at the key.
[[nodiscard]] std::vector<std::size_t> keys_with_velocities(const Motion& motion, PathKind path);

/// The weights of the targets of keys 1, 2 ..., of those with velocities, and of bends, at the times of the file.
[[nodiscard]] SequenceTrack curved_track(std::span<const float> times, std::span<const std::size_t> with_velocities,
                                         std::span<const CurveBend> bends);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_CURVED_SEQUENCE_H_
