/// Weight tracks with the weights of extra targets, which are products of others. Private to workflow.
///
/// Between the keys of a LINEAR track the product of two weights is a quadratic in time, which a CUBICSPLINE with the
/// right tangents passes through exactly; so all weights become one. The product of two cubics has degree 6: keys are
/// inserted (the weights that are there stay as they are: a cubic is cut exactly by its value and slope at the new key)
/// until cubics between them are close enough.
#ifndef CHRONORMAL_WORKFLOW_BAKE_TRACKS_H_
#define CHRONORMAL_WORKFLOW_BAKE_TRACKS_H_

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// One extra target, as a track sees it.
struct WeightProduct {
  std::size_t i = 0, j = 0;
  /// A bound of how much a normal turns, in radians, where the product is off by 1.
  double gain = 0;
};

struct ExtendedTrack {
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::vector<float> times;   ///< empty: as they were
  std::vector<float> values;  ///< of targets + products weights, in the order of the file
  double error = 0;           ///< a bound, in radians, of what insertions leave
  std::size_t keys = 0;
};

/// Memory for each key and weight of an extended track, while it is made and afterwards.
inline constexpr std::size_t kBytesPerWeight = 48;

/// Extends a track by products of its weights. Cubic splines get keys until no normal is off by more than tolerance
/// (radians), as far as float32 can tell. Where that takes more than most_keys, the result has no values, but says how
/// many it would have.
[[nodiscard]] ExtendedTrack extended_track(const WeightTrack& track, std::span<const WeightProduct> products,
                                           double tolerance,
                                           std::size_t most_keys = std::numeric_limits<std::size_t>::max());

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_TRACKS_H_
