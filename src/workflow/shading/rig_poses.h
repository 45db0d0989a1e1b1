/// Draws random poses for files without animations. A slider, the capture of a face, or an avatar program may set such
/// poses. Private to workflow.
///
///     no poses given   1 to 7 targets at once, 4 on average, at weights from 0 to 1. Each next target is drawn with a
///                      probability that depends on how well its name goes together with the names drawn before
///     poses given      a pose between two given poses, or between a given pose and the rest pose, which has weights 0
///
/// Two names go together if they are the left and the right of the same feature. Such targets are drawn together 8
/// times as often as any two targets. Two names also go together if they share a word, or if both belong to the mouth
/// or to the eyes (3 times as often, for example "jawOpen" and "mouthSmile_L").
///
/// Threads    All functions are pure, and give the same poses on every system.
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

/// Returns how many times as likely the targets with these names are to be active together as any two targets.
[[nodiscard]] double togetherness(const std::string& a, const std::string& b);

class RigPoses {
 public:
  /// Prepares to draw poses for target_count targets. Only the targets in `targets` may be active. `names` has
  /// target_count names, or is empty. `given` has the poses between which poses are drawn, with target_count weights
  /// each, or is empty.
  RigPoses(std::span<const std::string> names, std::vector<std::size_t> targets, std::size_t target_count,
           PoseList given);

  /// Draws `count` random poses. Different seeds give different poses.
  [[nodiscard]] PoseList sample(std::size_t count, unsigned seed) const;
  /// Returns the poses given to the constructor.
  [[nodiscard]] const PoseList& given() const noexcept { return given_; }

 private:
  std::vector<std::size_t> targets_;
  std::size_t target_count_;
  PoseList given_;
  std::vector<double> together_;  // (targets, targets), the results of togetherness()
};

/// Returns the given poses that have weights for a mesh, each as a list of weights of the mesh's targets.
[[nodiscard]] PoseList poses_of_mesh(std::span<const RigPose> poses, const GltfMesh& mesh);

/// Checks that the given poses fit a glTF file. Errors: kInvalidInput if a pose names a target that no mesh with
/// targets has, or if its number of weights differs from the number of targets of the mesh.
[[nodiscard]] Status check_poses(std::span<const RigPose> poses, const GltfDocument& document);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_RIG_POSES_H_
