/// Blend shapes: a base and targets that move some of its vertices, with any weights at once.
///
///     p(w) = base + sum_i w_i d_i                                            (section 14 of docs/theory.md)
///
/// A target lists the vertices that it moves, ascending, and how: target 0 lifts vertex 2, target 1 shifts 0 and 2:
///
///     targets[0]   vertices 2      deltas  0 1 0
///     targets[1]   vertices 0 2    deltas  1 0 0   1 0 0
///
/// Shapes     V = vertices, K = targets; base is (V, 3), deltas (n, 3) for n moved vertices, float32.
/// Units      positions and deltas: any length; weights: any finite number, often in [0, 1].
#ifndef CHRONORMAL_MOTION_BLEND_SET_H_
#define CHRONORMAL_MOTION_BLEND_SET_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/topology.h"

namespace chronormal {

struct BlendTarget {
  std::string name;                     ///< for messages; may be empty
  std::vector<std::uint32_t> vertices;  ///< ascending
  std::vector<float> deltas;            ///< (n, 3)

  /// Keeps the vertices of dense deltas, (V, 3), that are not (0, 0, 0).
  [[nodiscard]] static BlendTarget from_dense(std::span<const float> deltas, std::string name = {});
};

struct BlendSet {
  Topology topology;
  std::vector<float> base;  ///< (V, 3)
  std::vector<BlendTarget> targets;
};

/// The blend shapes of a star of segments (targets in io/input.h): its base, and a target for each segment
/// from keyframe 0, named as the keyframe at its end. Deltas are differences of positions, rounded to float32. The
/// motion must be valid. Errors, with the place "target K": kUsage for a segment that does not begin at keyframe 0,
/// kInvalidInput for a delta beyond the range of float32.
[[nodiscard]] Result<BlendSet> blend_set_of(const Motion& star);

/// Checks what the rest of the library relies on: as many positions as the topology has vertices, all finite, and in
/// each target vertices that ascend and exist, with one finite delta each.
/// Errors: kInvalidInput with the place "base, vertex V" or "target K, entry N".
[[nodiscard]] Status validate(const BlendSet& set);

/// The same of one target that is to become number k of a set over this topology.
[[nodiscard]] Status validate(const BlendTarget& target, const Topology& topology, std::size_t k);

/// Writes the positions at some weights, (V, 3) in double, without a rounding to float32 in between.
/// weights must have one for each target, result 3 V; targets of weight 0 cost nothing
void blend_positions(const BlendSet& set, std::span<const double> weights, std::span<double> result) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_BLEND_SET_H_
