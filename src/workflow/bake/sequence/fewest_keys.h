/// Finds the fewest keys of a sequence for viewers that interpolate linearly between the normals of two keys. Private
/// to workflow.
///
/// Every key has the exact unit normals of its instant. Between two keys with the normals u_0 and u_1, a viewer renders
/// normalize((1-t) u_0 + t u_1), which is called a line here. From the first key on, each next key is put as late as
/// possible. A line must meet two conditions. First, its error from the true normals n(t) must be within the tolerance
/// at every t, by a certificate and not by samples (analysis/certificates/line_bound.h). Second, all vertices must stay
/// on the straight line between their positions at the two keys. A key may lie between two keyframes, because the
/// motion is straight there and the normals are known. Keyframes that change nothing, as in motions that another
/// program has sampled, get no key. If every part of a valid line is also valid, no other choice has fewer keys.
///
/// Times      Times are those of a sequence: keyframe k has time k. Instants between keyframes are in steps of 1 /
///            kKeySteps.
/// Threads    Uses all cores. The keys are the same on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_FEWEST_KEYS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_FEWEST_KEYS_H_

#include <cstddef>
#include <functional>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "workflow/bake/sequence/sequence_normals.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kKeySteps = 64;  ///< the number of steps in a segment

/// The largest distance of a vertex from the straight line between two keys, at a keyframe that gets no key, as a share
/// of the diagonal of the box around the whole motion.
inline constexpr double kKeyPositionShare = 1e-6;

struct SequenceKeys {
  std::vector<std::size_t> at;  ///< the keys in steps, ascending; keyframe k is at step k kKeySteps
  /// The largest error of any normal at any instant, in radians. Leaves out the normals counted in `beyond`.
  double largest_error = 0;
  /// The number of pairs of a normal and a segment in which the error is beyond the tolerance even if a key is put at
  /// every step.
  std::size_t beyond = 0;
  /// The number of keys that would be needed if all keyframes stayed, and all segments were split into the same number
  /// of pieces, at most kKeySteps.
  std::size_t even = 0;
};

/// Chooses the fewest keys. tolerance is in radians, and must be above 0. progress() receives the segment that was
/// reached. Reads all keyframes three times. Keeps in memory the keyframes between two keys and a few keyframes around
/// them; key_pose() keeps three keyframes. Errors of both functions: those of reading keyframes.
[[nodiscard]] Result<SequenceKeys> fewest_keys(const Motion& motion, const SequenceNormals& normals, double tolerance,
                                               const std::function<void(std::size_t segment)>& progress);

/// The data of a key: the positions at its instant, as float32 deltas from keyframe 0, and the directions of the
/// normals of all elements.
struct KeyPose {
  std::vector<float> deltas;
  std::vector<Vec3d> directions;  ///< unit vectors; (0, 0, 0) if a normal has no direction in the segment
};
[[nodiscard]] Result<KeyPose> key_pose(const SequenceNormals& normals, std::size_t step);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_FEWEST_KEYS_H_
