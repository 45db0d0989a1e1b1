/// Extends weight tracks by the weights of correction targets, which are quadratic in the weights of other targets.
/// Private to workflow.
///
/// Between the keys of a LINEAR track, the weight of a correction target is quadratic in time. A cubic spline with the
/// right tangents has exactly this weight, so the track becomes a cubic spline. If the track is a cubic spline already,
/// the product of two of its weights has degree 6. Keys are then inserted until cubics between the keys are close
/// enough to the product. New keys do not change the other weights, because a cubic can be split exactly, by its value
/// and slope at the new key.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_TRACKS_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_TRACKS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// Rounds a weight or a slope to float32. Clamps the number to the range of float32, because slopes exceed this range
/// in pieces that are shorter than 1e-38 seconds.
[[nodiscard]] float to_file(double number) noexcept;

/// A correction target in a track. Its weight is linear * w_i + quadratic * w_i * w_j, where w_i and w_j are weights of
/// own targets.
struct ExtraWeight {
  std::size_t i = 0, j = 0;
  double linear = 0, quadratic = 1;
  /// A bound of the angle, in radians, by which a normal turns if the weight of this target has an error of 1.
  double gain = 0;

  [[nodiscard]] double at(double w_i, double w_j) const noexcept { return linear * w_i + quadratic * w_i * w_j; }
  /// Returns the correction target in the form in which the file describes it. `target` is the index of this target
  /// among all targets of the mesh.
  [[nodiscard]] GltfExtraTarget as_target(std::size_t target) const;
};

struct ExtendedTrack {
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::vector<float> times;   ///< the times of the keys in seconds; empty if they stay as they are
  std::vector<float> values;  ///< weights of the track's targets and of correction targets, in the order of the file
  /// A bound of the angle, in radians, by which errors of the weights turn a normal. It is pi if some weight or slope
  /// is too large for float32.
  double error = 0;
  std::size_t keys = 0;
};

/// The bytes of memory that each weight takes at each key of an extended track, while the track is made and afterwards.
inline constexpr std::size_t kBytesPerWeight = 48;

/// Extends a track by the weights of correction targets. Cubic splines get more keys until the errors of these weights
/// turn no normal by more than tolerance (radians), as far as float32 allows. If the track needs more than most_keys
/// keys, the result has no values, but the number of keys that it would have.
[[nodiscard]] ExtendedTrack extended_track(const WeightTrack& track, std::span<const ExtraWeight> extras,
                                           double tolerance,
                                           std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// Extends a LINEAR track by the weights of correction targets, so that it stays LINEAR. The gap between two keys gets
/// as many straight pieces of equal length as `pieces` tells. The weights in the file play as before (up to rounding),
/// and the weights of correction targets are right at all keys. If the pieces take more than most_keys keys, the result
/// has no values, but the number of keys that it would have. pieces must have one number for each pair of neighbouring
/// keys, and none of these numbers may be 0.
[[nodiscard]] ExtendedTrack straight_track(const WeightTrack& track, std::span<const ExtraWeight> extras,
                                           std::span<const std::uint32_t> pieces,
                                           std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// A function that writes the weights of correction targets in the gap between `key` and the next key. `part` is the
/// position in the gap, from 0 to 1. `own` has the weights of the mesh's own targets at this position.
using ExtrasAt =
    std::function<void(std::size_t key, double part, std::span<const double> own, std::span<double> extras)>;

/// Extends a LINEAR track by straight pieces. The weights of correction targets come from a function, and the track
/// stays LINEAR.
[[nodiscard]] ExtendedTrack straight_track(const WeightTrack& track, std::size_t extra_count, const ExtrasAt& extras_at,
                                           std::span<const std::uint32_t> pieces,
                                           std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// Returns the extended track as a reader of the baked file would read it.
[[nodiscard]] WeightTrack as_track(const WeightTrack& before, const ExtendedTrack& extended, std::size_t extra_count);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_TRACKS_H_
