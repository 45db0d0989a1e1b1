/// A pose as it is rendered: weights, and the skin that transforms the blended normals. Private to workflow.
///
/// Threads    const functions may run at once.
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_SEEN_POSE_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_SEEN_POSE_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/workflow/viewers.h"
#include "workflow/shading/mesh_skin.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

struct SeenPose {
  std::vector<double> weights;
  const MeshSkin* skin = nullptr;  ///< nullptr: there is none, or it turns and scales evenly
  double time = 0;                 ///< of the pose of its joints, if they move

  friend bool operator==(const SeenPose&, const SeenPose&) = default;
};

/// Tells whether any of these poses has a skin.
[[nodiscard]] bool any_skinned(std::span<const SeenPose> poses);
/// Returns poses that are all seen through the given skin, or without a skin if it is nullptr.
[[nodiscard]] std::vector<SeenPose> seen_through(PoseList poses, const MeshSkin* skin);
/// Returns the weights of each pose.
[[nodiscard]] PoseList weights_of(std::span<const SeenPose> poses);
/// Returns the weights of the poses, only once for neighbouring poses that differ only in the joints of a skin.
[[nodiscard]] PoseList different_weights_of(std::span<const SeenPose> poses);

/// The skins of some poses, with the joints as each pose has them.
class SkinsInPoses {
 public:
  explicit SkinsInPoses(std::span<const SeenPose> poses);

  [[nodiscard]] bool any() const noexcept { return !skins_.empty(); }

  /// The transforms of one vertex in the poses from number `first` on.
  class Vertex {
   public:
    Vertex(const SkinsInPoses& skins, std::uint32_t vertex, std::size_t first, std::size_t count);
    /// Returns the normal that is rendered in a pose for a normal of any length. Without a skin this is the normal
    /// itself; otherwise it is a unit vector, or (0, 0, 0) if the skin collapses the normal.
    [[nodiscard]] Vec3d seen(SkinRule rule, std::size_t pose, const Vec3d& normal) const;

   private:
    const SkinsInPoses& skins_;
    std::uint32_t vertex_;
    std::size_t first_;
    std::vector<AffineTransform> matrices_;
  };

 private:
  std::vector<std::optional<MeshSkin>> skins_;  // empty if there are none
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_SEEN_POSE_H_
