/// Finds the fewest keys of a sequence for viewers that interpolate linearly between the normals of two keys. Private
/// to workflow.
///
/// Every key has the exact unit normals of its instant. Between two keys with the normals u_0 and u_1, a viewer renders
/// normalize((1-t) u_0 + t u_1). From the first key on, each next key is put as late as possible. Two conditions must
/// hold on the whole line: its error from the true normals n(t) is within the tolerance, by a certificate and not by
/// samples (analysis/certificates/line_bound.h), and no vertex leaves the straight line between the two keys. A key may
/// lie between two keyframes, because the motion is straight there and the normal is known. Keyframes that add nothing,
/// as in motions that another program has sampled, get no key. If every part of a valid line is also valid, no choice
/// has fewer keys.
///
/// Times      of a sequence: keyframe k is k, and instants between are in steps of 1 / kKeySteps.
/// Threads    on all cores; the same keys on any number of them
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

inline constexpr std::size_t kKeySteps = 64;  ///< of a segment

/// The largest distance of a vertex from the line if a keyframe is left out, as a share of the diagonal of the motion.
inline constexpr double kKeyPositionShare = 1e-6;

struct SequenceKeys {
  std::vector<std::size_t> at;  ///< ascending, in steps: keyframe k is k kKeySteps
  double largest_error = 0;     ///< radians: the largest error of a normal at any instant, without those left out
  std::size_t beyond = 0;  ///< (normal, segment) pairs left out, because even lines of one step exceed the tolerance
  std::size_t even = 0;    ///< the number of keys if all keyframes stay, and all segments are split alike; at most
                           ///< kKeySteps pieces are tried
};

/// Chooses keys. tolerance is in radians, and above 0. progress() gets the segment that was reached. Reads all
/// keyframes three times, and holds those between two keys and a few around these; key_pose() holds three. Errors of
/// both functions: from reading keyframes.
[[nodiscard]] Result<SequenceKeys> fewest_keys(const Motion& motion, const SequenceNormals& normals, double tolerance,
                                               const std::function<void(std::size_t segment)>& progress);

/// The data of a key: the positions of its instant, as float32 deltas from keyframe 0, and the directions of the
/// normals of all elements.
struct KeyPose {
  std::vector<float> deltas;
  std::vector<Vec3d> directions;  ///< (0, 0, 0) if there is none in the segment
};
[[nodiscard]] Result<KeyPose> key_pose(const SequenceNormals& normals, std::size_t step);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_FEWEST_KEYS_H_
