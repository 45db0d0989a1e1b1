/// The poses that a rig is made for where no animation says so: what sliders, a captured face or the program of an
/// avatar may set. Private to workflow.
///
///     no poses given   1 to 7 targets at once, 4 on average, at weights from 0 to 1; each is drawn by how often its name
///                      goes together with those that are drawn already
///     poses given      the way from one of them to another, or to rest
///
/// Names go together where they are the left and the right of the same thing (8 times as often as any two), where they
/// share a word or both belong to the mouth or to the eyes (3 times: "jawOpen" and "mouthSmile_L").
///
/// Threads    pure; the same poses on every system.
#ifndef CHRONORMAL_WORKFLOW_SHADING_RIG_POSES_H_
#define CHRONORMAL_WORKFLOW_SHADING_RIG_POSES_H_

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/input.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// How much more often than any two targets these two are active at once, by their names.
[[nodiscard]] double togetherness(const std::string& a, const std::string& b);

class RigPoses {
 public:
  /// targets are those that may be active, of target_count; names has one for each of target_count, or is empty. given
  /// are poses of target_count weights each.
  RigPoses(std::span<const std::string> names, std::vector<std::size_t> targets, std::size_t target_count,
           PoseList given);

  /// Draws poses. Those of different seeds are different.
  [[nodiscard]] PoseList sample(std::size_t count, unsigned seed) const;
  /// The poses that were given.
  [[nodiscard]] const PoseList& given() const noexcept { return given_; }

 private:
  std::vector<std::size_t> targets_;
  std::size_t target_count_;
  PoseList given_;
  std::vector<double> together_;  // (targets, targets)
};

/// The poses of a file that give this mesh weights.
[[nodiscard]] PoseList poses_of_mesh(std::span<const RigPose> poses, const GltfMesh& mesh);

/// Errors: kInvalidInput where a pose has a target that no mesh with targets has, or weights for another number of
/// targets.
[[nodiscard]] Status check_poses(std::span<const RigPose> poses, const GltfDocument& document);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_RIG_POSES_H_
