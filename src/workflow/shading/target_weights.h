/// Finds which morph targets are active at the same time, from the weights of a file. Private to workflow.
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

/// A list of poses. A pose has one weight for each target of a mesh.
using PoseList = std::vector<std::vector<double>>;

/// The weight track of a mesh: its keys, and how weights are interpolated between them. A cubic spline with one key
/// stays constant.
struct WeightTrack {
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  GltfKeys keys;
  std::size_t targets = 0;
  /// The number of pieces of equal length into which each gap between two keys of a LINEAR track is cut for the weights
  /// of correction targets. One piece is enough if the corrected normals are quadratic between keys.
  std::size_t pieces_of_line = 1;

  [[nodiscard]] std::size_t size() const noexcept { return keys.times.size(); }
  [[nodiscard]] double value(std::size_t key, std::size_t target) const noexcept;
  /// Returns a tangent of a cubic spline: the change of the weight per second. Returns the tangent after the key if out
  /// is true, and before the key otherwise.
  [[nodiscard]] double tangent(std::size_t key, bool out, std::size_t target) const noexcept;
  /// Returns the weight from a key to the next key as a cubic in Bernstein form. In a STEP track the cubic is constant.
  /// key + 1 must be less than size().
  [[nodiscard]] std::array<double, 4> piece(std::size_t key, std::size_t target) const noexcept;
};

/// The weights that the tracks and single poses of a file give to the targets of a mesh.
class WeightUse {
 public:
  explicit WeightUse(std::size_t targets) : lowest_(targets, 0.0), highest_(targets, 0.0), moments_(targets) {}

  /// Adds a track. The track must have as many targets as this object, and must outlive the object.
  void add_track(const WeightTrack& track);
  void add_pose(std::vector<double> weights);

  /// Returns true if both targets have a nonzero weight at some moment. Between keys of a cubic spline, a weight counts
  /// as nonzero if any of its four coefficients is nonzero. Takes O(moments).
  [[nodiscard]] bool together(std::size_t i, std::size_t j) const noexcept;
  /// Returns a bound of |w_i|, the size of the weight of target i.
  [[nodiscard]] double largest(std::size_t i) const { return std::fmax(-lowest_[i], highest_[i]); }
  /// Return bounds of w_i, the weight of target i: a lower bound of at most 0, and an upper bound of at least 0.
  [[nodiscard]] double lowest(std::size_t i) const { return lowest_[i]; }
  [[nodiscard]] double highest(std::size_t i) const { return highest_[i]; }
  [[nodiscard]] std::size_t targets() const noexcept { return moments_.size(); }

  /// Returns the largest number of poses that samples() can return for the added tracks and poses.
  [[nodiscard]] std::size_t sample_count() const noexcept;
  /// Returns poses that the tracks pass through: all keys, and fifteen poses between any two neighbouring keys. Also
  /// returns the poses that add_pose() added. If there are more than `most` poses, returns `most` of them, evenly
  /// spaced.
  [[nodiscard]] std::vector<std::vector<double>> samples(std::size_t most) const { return samples(most, 1); }
  /// Returns poses that the tracks pass through, like samples(), but leaves out poses between keys before it leaves out
  /// keys. For this purpose, the fifteen poses between two keys become seven, three, one or none.
  [[nodiscard]] std::vector<std::vector<double>> samples_with_keys(std::size_t most) const;

 private:
  [[nodiscard]] std::size_t sample_count(std::size_t step) const noexcept;
  [[nodiscard]] std::vector<std::vector<double>> samples(std::size_t most, std::size_t step) const;
  void add_active(std::vector<std::size_t> active);
  void note(std::size_t target, double weight, std::vector<std::size_t>& active);

  std::vector<double> lowest_, highest_;
  // For each target, the indices of the moments at which it is active (has a weight), in ascending order.
  std::vector<std::vector<std::size_t>> moments_;
  std::size_t moment_count_ = 0;
  std::vector<std::size_t> last_;  // the argument of the last add_active()
  std::vector<std::vector<double>> poses_;
  std::vector<const WeightTrack*> tracks_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_TARGET_WEIGHTS_H_
