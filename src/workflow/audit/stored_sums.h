/// Adds up the stored normals and deltas of some outputs, as the specification requires or as a viewer stores them.
/// Private to workflow.
///
/// The deltas of many targets do not fit into the cache, so computing the sums for one set of weights takes as long as
/// reading all deltas. For this reason one pass computes the sums for several sets of weights.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_STORED_SUMS_H_
#define CHRONORMAL_WORKFLOW_AUDIT_STORED_SUMS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/workflow/viewers.h"
#include "workflow/audit/judged_part.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

class StoredSums {
 public:
  /// The number of sets of weights for which sums are computed in one pass. One pass takes hardly longer for several
  /// sets than for a single set.
  static constexpr std::size_t kAtOnce = 4;

  /// Creates an empty store. shading and outputs must outlive the store. `involved` lists targets in ascending order. A
  /// set of weights has a value for each of these targets, and all other targets always have weight 0.
  StoredSums(const GltfShading& shading, std::span<const JudgedOutput> outputs, std::vector<std::size_t> involved,
             const Viewer& viewer = {});

  /// Computes for every output and each set of weights the sum of the stored normal and the weighted deltas of all
  /// targets. Adds in float32 and in the order of targets, as viewers do. Discards earlier results. Skips deltas of
  /// zero, even if their weight is infinite or NaN. Uses all threads.
  void add_up(std::vector<std::vector<double>> sets);

  /// Returns the sums for one of the sets of weights, three numbers for each output. Returns an empty span if the last
  /// add_up() did not get this set.
  [[nodiscard]] std::span<const float> find(const std::vector<double>& weights) const noexcept;

  /// Writes the unit normals, rounded to float32, that a viewer renders for the sums of outputs from number `first` on.
  /// If a sum is zero, infinite or NaN, so is its normal.
  void shown(std::span<const float> sums, std::size_t first, std::span<Vec3d> normals) const;

  [[nodiscard]] const Viewer& viewer() const noexcept { return viewer_; }

 private:
  // A group of neighbouring outputs. It has a row of deltas for each target that changes any of their normals.
  struct Group {
    std::vector<std::uint32_t> targets;  // the targets of the rows, as ascending indices in involved_
    std::vector<float> deltas;           // (targets, 3 kGroup), the deltas of the outputs in the group
  };
  static constexpr std::size_t kGroup = 64;

  void make_groups();
  void add_group(std::size_t g, std::span<const float> by_target);
  [[nodiscard]] Vec3f stored(std::size_t output) const;
  [[nodiscard]] Vec3f kept(std::size_t output) const;

  const GltfShading& shading_;
  std::span<const JudgedOutput> outputs_;
  std::vector<std::size_t> involved_;
  Viewer viewer_;
  std::vector<Vec3f> kept_normals_;  // one for each output; empty if the viewer uses the normals as stored
  std::vector<Group> groups_;        // empty until add_up() is called
  std::vector<std::vector<double>> sets_;
  std::size_t stride_;       // number of floats for one set of weights, rounded up to whole groups
  std::vector<float> sums_;  // (sets, stride), the sums for each set of weights
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_STORED_SUMS_H_
