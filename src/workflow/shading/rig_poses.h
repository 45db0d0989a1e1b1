/// Random poses for files without animations: poses that sliders, the capture of a face, or an avatar program may set.
/// Private to workflow.
///
///     no poses given   1 to 7 targets at once, 4 on average, at weights from 0 to 1; each next target is drawn with a
///                      probability that depends on how well its name goes together with the names drawn before
///     poses given      a pose between two given poses, or between a given pose and rest
///
/// Names go together if they are the left and the right of the same feature (8 times as often as any two), share a
/// word, or both belong to the mouth or to the eyes (3 times: "jawOpen" and "mouthSmile_L").
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

/// Returns the factor by which two targets are more likely to be active together than any two, judged by their names.
[[nodiscard]] double togetherness(const std::string& a, const std::string& b);

class RigPoses {
 public:
  /// Prepares to draw poses. Of target_count targets, only those in `targets` may be active. `names` has target_count
  /// names, or is empty. `given` holds poses of target_count weights each.
  RigPoses(std::span<const std::string> names, std::vector<std::size_t> targets, std::size_t target_count,
           PoseList given);

  /// Draws random poses. Different seeds give different poses.
  [[nodiscard]] PoseList sample(std::size_t count, unsigned seed) const;
  /// Returns the poses given to the constructor.
  [[nodiscard]] const PoseList& given() const noexcept { return given_; }

 private:
  std::vector<std::size_t> targets_;
  std::size_t target_count_;
  PoseList given_;
  std::vector<double> together_;  // (targets, targets)
};

/// Returns the poses of a file that give weights to this mesh.
[[nodiscard]] PoseList poses_of_mesh(std::span<const RigPose> poses, const GltfMesh& mesh);

/// Checks that the poses fit the file.
/// Errors: kInvalidInput if a pose names a target that no mesh with targets has, or has another number of weights than
/// the mesh has targets
[[nodiscard]] Status check_poses(std::span<const RigPose> poses, const GltfDocument& document);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_RIG_POSES_H_
