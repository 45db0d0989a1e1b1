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
/// Each of the functions over a CurvedSource is a pass over the keyframes, of which it holds four at a time.
///
/// Threads    on all cores; the same bits on any number of them
/// Memory     the control normals of two to four segments, 168 bytes for each element of each
/// Errors     those of reading keyframes, and of body, which ends a pass by one
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_CURVED_SEQUENCE_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_CURVED_SEQUENCE_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion_stream.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/paths.h"
#include "workflow/bake/sequence/sequence_deltas.h"
#include "workflow/bake/sequence/sequence_file.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kCurveInstants = 40;

/// A sequence, whose normals these are, and its paths.
struct CurvedSource {
  MotionStream* stream;
  const NormalGroups* groups;
  PathKind path;
};

/// A target that bends the normals of a segment by one of the two weights above.
struct CurveBend {
  std::size_t segment = 0;
  bool is_odd = false;  ///< whether its weight is the one that changes its sign at t = 1/2
};

/// The first direction that each element has is its N. Reads no more keyframes than it takes to find all of them.
[[nodiscard]] Result<std::vector<SequenceElement>> curved_elements(const CurvedSource& source);

/// Calls body(key, deltas) for keys 1, 2 ... in order: what the target of the key adds to N.
[[nodiscard]] Status each_curved_key(
    const CurvedSource& source, std::span<const SequenceElement> elements,
    const std::function<Status(std::size_t key, const std::vector<Vec3d>& deltas)>& body);

/// Calls body(key, deltas) for each of these keys: how fast the normals turn there, per second, which makes the shown
/// curve follow them through the key. Without it the curve of normals would stand still at keys whose positions do not.
[[nodiscard]] Status each_key_turning(
    const CurvedSource& source, std::span<const std::size_t> keys,
    const std::function<Status(std::size_t key, const std::vector<Vec3d>& deltas)>& body);

/// Calls body(bend, deltas) for the bends of all segments in order, and done(segments) after each segment. There are
/// bends where an element is off by more than the tolerance, in radians: the fewest that keep it, or else those that
/// leave the smallest error. Returns the largest error that is left, in radians.
[[nodiscard]] Result<double> each_curved_bend(
    const CurvedSource& source, std::span<const SequenceElement> elements, double tolerance,
    const std::function<Status(const CurveBend& bend, const std::vector<Vec3d>& deltas)>& body,
    const std::function<void(std::size_t segments)>& done);

/// Finds the keys that have velocities of their own (given_velocities() in normals/paths.h), and so one more target:
/// the velocities are its positions, what each_key_turning() gives are its normals, and its weight has slope 1 at the
/// key.
[[nodiscard]] std::vector<std::size_t> keys_with_velocities(const Motion& motion, PathKind path);

/// The weights of the targets of keys 1, 2 ..., of those with velocities, and of bends, at the times of the file. The
/// track looks into all three when it is asked for a row.
[[nodiscard]] SequenceTrack curved_track(std::span<const float> times, std::span<const std::size_t> with_velocities,
                                         std::span<const CurveBend> bends);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_CURVED_SEQUENCE_H_
