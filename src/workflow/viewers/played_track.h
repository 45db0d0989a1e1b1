/// Computes the weights that a viewer plays from a track of a file. These weights may differ from the weights that glTF
/// specifies. Private to workflow.
///
/// Some viewers sample a track again at fixed steps. For such a viewer, only the two samples around the requested time
/// are computed.
#ifndef CHRONORMAL_WORKFLOW_VIEWERS_PLAYED_TRACK_H_
#define CHRONORMAL_WORKFLOW_VIEWERS_PLAYED_TRACK_H_

#include <cstddef>
#include <span>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/viewers.h"
#include "io/gltf/gltf_weights.h"

namespace chronormal::inline internal {

/// The first and the last time of all weight tracks of an animation, in seconds.
struct TimeRange {
  double first = 0, last = 0;
};

/// Reads the time range of an animation. Errors: those of GltfDocument::keys().
[[nodiscard]] Result<TimeRange> weight_time_range(const GltfDocument& document, std::size_t animation);

class PlayedTrack {
 public:
  /// Creates a track from keys as GltfDocument::keys() returns them. `animation` is the time range of the animation to
  /// which the track belongs.
  PlayedTrack(const Viewer& viewer, GltfKeys keys, GltfInterpolation interpolation, std::size_t target_count,
              const TimeRange& animation);

  /// Writes the weights that the viewer shows at a time in seconds. If the weights jump at that time, writes the
  /// weights just after the jump, or just before the jump if just_before is true.
  void at(double time, bool just_before, std::span<double> weights) const;

  /// Returns true if the viewer plays the weights that glTF specifies, except for rounding and weights that the viewer
  /// drops.
  [[nodiscard]] bool is_as_specified() const noexcept { return as_specified_; }

 private:
  // Computes the weights of one sample of a track that the viewer samples again at fixed steps.
  void sample(double index, std::span<double> weights) const;
  // Computes the weights of a cubic spline as the viewer computes them, which is not as glTF specifies.
  void play_spline(double time, bool just_before, std::span<double> weights) const;

  Viewer viewer_;
  bool as_specified_;
  bool resampled_;
  bool steps_;
  double first_, last_;  // seconds: the first and the last time of the samples
  double last_index_;    // the index of the last sample
  GltfKeys keys_;        // keys of a spline that the viewer plays by its own rule; empty for all other tracks
  gltf::WeightCurve curve_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_VIEWERS_PLAYED_TRACK_H_
