/// Which morph targets are active at once, by the weights that a file gives them. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_SHADING_TARGET_WEIGHTS_H_
#define CHRONORMAL_WORKFLOW_SHADING_TARGET_WEIGHTS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"

namespace chronormal::inline internal {

/// Weights of all targets, pose by pose.
using PoseList = std::vector<std::vector<double>>;

/// The keys of a track and what is between them. A cubic spline with one key is none: it holds still.
struct WeightTrack {
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  GltfKeys keys;
  std::size_t targets = 0;
  /// Into how many pieces the curves of extra weights cut each gap of a LINEAR track: one, where what they are for is
  /// quadratic between keys.
  std::size_t pieces_of_line = 1;

  [[nodiscard]] std::size_t size() const noexcept { return keys.times.size(); }
  [[nodiscard]] double value(std::size_t key, std::size_t target) const noexcept;
  /// Per second; of cubic splines only.
  [[nodiscard]] double tangent(std::size_t key, bool out, std::size_t target) const noexcept;
  /// A weight from one key to the next as a cubic in Bernstein form. Steps hold their value.
  /// key + 1 < size()
  [[nodiscard]] std::array<double, 4> piece(std::size_t key, std::size_t target) const noexcept;
};

/// Gathers the weights that one mesh is given: tracks, and poses that stand still.
class WeightUse {
 public:
  explicit WeightUse(std::size_t targets) : lowest_(targets, 0.0), highest_(targets, 0.0), moments_(targets) {}

  /// The track must have this many targets, and outlive this.
  void add_track(const WeightTrack& track);
  void add_pose(std::vector<double> weights);

  /// Whether both weights are other than zero at some instant. (Between keys of a cubic spline a weight counts as other
  /// than zero where any of the four numbers that shape it is.) O(moments).
  [[nodiscard]] bool together(std::size_t i, std::size_t j) const noexcept;
  /// A bound of |w_i|.
  [[nodiscard]] double largest(std::size_t i) const { return std::fmax(-lowest_[i], highest_[i]); }
  /// Bounds of w_i, from 0 or less to 0 or more.
  [[nodiscard]] double lowest(std::size_t i) const { return lowest_[i]; }
  [[nodiscard]] double highest(std::size_t i) const { return highest_[i]; }
  [[nodiscard]] std::size_t targets() const noexcept { return moments_.size(); }

  /// How many poses samples() has at most.
  [[nodiscard]] std::size_t sample_count() const noexcept;
  /// Poses that the weights pass through: keys, and fifteen between any two; where these are more than `most`, as many
  /// of them, evenly.
  [[nodiscard]] std::vector<std::vector<double>> samples(std::size_t most) const { return samples(most, 1); }
  /// The same with all keys as long as that goes: with seven, three, one, or none between any two.
  [[nodiscard]] std::vector<std::vector<double>> samples_with_keys(std::size_t most) const;

 private:
  [[nodiscard]] std::size_t sample_count(std::size_t step) const noexcept;
  [[nodiscard]] std::vector<std::vector<double>> samples(std::size_t most, std::size_t step) const;
  void add_active(std::vector<std::size_t> active);
  void note(std::size_t target, double weight, std::vector<std::size_t>& active);

  std::vector<double> lowest_, highest_;
  std::vector<std::vector<std::size_t>> moments_;  // of each target, ascending: when it is active
  std::size_t moment_count_ = 0;
  std::vector<std::size_t> last_;  // what add_active() was given last
  std::vector<std::vector<double>> poses_;
  std::vector<const WeightTrack*> tracks_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_TARGET_WEIGHTS_H_
