/// What a viewer plays of a track of weights, which may be otherwise than the specification has it. Private to workflow.
///
/// Nothing is sampled before it is asked for: a resampled track is the two samples around a time.
#ifndef CHRONORMAL_WORKFLOW_VIEWERS_PLAYED_TRACK_H_
#define CHRONORMAL_WORKFLOW_VIEWERS_PLAYED_TRACK_H_

#include <cstddef>
#include <span>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/viewers.h"
#include "io/gltf/gltf_weights.h"

namespace chronormal::inline internal {

/// The first and the last time of all tracks of weights of an animation, in seconds.
struct TimeRange {
  double first = 0, last = 0;
};

/// Reads that range. Errors: of GltfDocument
[[nodiscard]] Result<TimeRange> weight_time_range(const GltfDocument& document, std::size_t animation);

class PlayedTrack {
 public:
  /// keys as GltfDocument::keys() gives them. animation: of the animation that the track is of.
  PlayedTrack(const Viewer& viewer, GltfKeys keys, GltfInterpolation interpolation, std::size_t target_count,
              const TimeRange& animation);

  /// Writes the weights that the viewer shows at a time; where they jump, those just after it or just before it.
  void at(double time, bool just_before, std::span<double> weights) const;

  /// Whether the viewer plays the weights of the specification, but for rounding and weights that are left out.
  [[nodiscard]] bool is_as_specified() const noexcept { return as_specified_; }

 private:
  // A sample of a resampled track.
  void sample(double index, std::span<double> weights) const;
  // The weights of a cubic spline that is played by a rule of its own.
  void play_spline(double time, bool just_before, std::span<double> weights) const;

  Viewer viewer_;
  bool as_specified_;
  bool resampled_;
  bool steps_;
  double first_, last_;  // of the samples
  double last_index_;    // that of the last sample
  GltfKeys keys_;        // of a spline that is played by a rule of its own; else none
  gltf::WeightCurve curve_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_VIEWERS_PLAYED_TRACK_H_
