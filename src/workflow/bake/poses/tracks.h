/// Weight tracks with the weights of extra targets, which are quadratic in those of others. Private to workflow.
///
/// Between the keys of a LINEAR track such a weight is a quadratic in time, which a CUBICSPLINE with the
/// right tangents passes through exactly; so all weights become one. The product of two cubics has degree 6: keys are
/// inserted (the weights that are there stay as they are: a cubic is cut exactly by its value and slope at the new key)
/// until cubics between them are close enough.
#ifndef CHRONORMAL_WORKFLOW_BAKE_WRITE_TRACKS_H_
#define CHRONORMAL_WORKFLOW_BAKE_WRITE_TRACKS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// Rounds a weight or a slope to float32: those of a piece that is shorter than 1e-38 seconds may be beyond it.
[[nodiscard]] float to_file(double number) noexcept;

/// One extra target, as a track sees it: its weight is linear w_i + quadratic w_i w_j.
struct ExtraWeight {
  std::size_t i = 0, j = 0;
  double linear = 0, quadratic = 1;
  /// A bound of how much a normal turns, in radians, where the weight is off by 1.
  double gain = 0;

  [[nodiscard]] double at(double w_i, double w_j) const noexcept { return linear * w_i + quadratic * w_i * w_j; }
  /// The same for the file, as the target of this index.
  [[nodiscard]] GltfExtraTarget as_target(std::size_t target) const;
};

struct ExtendedTrack {
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::vector<float> times;   ///< empty: as they were
  std::vector<float> values;  ///< of targets + extra weights, in the order of the file
  double error = 0;           ///< a bound, in radians, of what insertions leave; pi where float32 cannot hold a number
  std::size_t keys = 0;
};

/// Memory for each key and weight of an extended track, while it is made and afterwards.
inline constexpr std::size_t kBytesPerWeight = 48;

/// Extends a track by extra weights. Cubic splines get keys until no normal is off by more than tolerance
/// (radians), as far as float32 can tell. Where that takes more than most_keys, the result has no values, but says how
/// many it would have.
[[nodiscard]] ExtendedTrack extended_track(const WeightTrack& track, std::span<const ExtraWeight> extras,
                                           double tolerance,
                                           std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// Extends a LINEAR track so that it stays one: from each key to the next in as many equal pieces as are asked for, on
/// straight lines, so that the weights that are there play as before (but for float32), and extra weights are right at
/// all keys. Where that takes more than most_keys, the result has no values, but says how many it would have.
/// pieces must have one number for each pair of neighbouring keys, none of them 0
[[nodiscard]] ExtendedTrack straight_track(const WeightTrack& track, std::span<const ExtraWeight> extras,
                                           std::span<const std::uint32_t> pieces,
                                           std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// Writes the weights of extra targets at a part of the gap after a key, where those of the mesh's own are given.
using ExtrasAt =
    std::function<void(std::size_t key, double part, std::span<const double> own, std::span<double> extras)>;

/// The same with weights that a function gives.
[[nodiscard]] ExtendedTrack straight_track(const WeightTrack& track, std::size_t extra_count, const ExtrasAt& extras_at,
                                           std::span<const std::uint32_t> pieces,
                                           std::size_t most_keys = std::numeric_limits<std::size_t>::max());

/// The track as it will be read from the file.
[[nodiscard]] WeightTrack as_track(const WeightTrack& before, const ExtendedTrack& extended, std::size_t extra_count);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_TRACKS_H_
