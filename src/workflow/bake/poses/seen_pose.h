/// A pose as a viewer renders it: weights, and the skin that transforms the blended normals. Private to workflow.
///
/// Threads    const functions may run at the same time.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_SEEN_POSE_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_SEEN_POSE_H_

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
  const MeshSkin* skin = nullptr;  ///< nullptr if there is no skin, or if it only rotates and scales evenly
  double time = 0;                 ///< the time of the pose of the skin's joints, in seconds, if they move

  friend bool operator==(const SeenPose&, const SeenPose&) = default;
};

/// Returns true if any of the poses has a skin, which transforms the normals.
[[nodiscard]] bool any_skinned(std::span<const SeenPose> poses);
/// Returns the given poses, all with the same skin. If `skin` is nullptr, the poses have no skin.
[[nodiscard]] std::vector<SeenPose> seen_through(PoseList poses, const MeshSkin* skin);
/// Returns the weights of each pose, without its skin.
[[nodiscard]] PoseList weights_of(std::span<const SeenPose> poses);
/// Returns the weights of the poses, without repetitions: if neighbouring poses differ only in the joints of a skin,
/// their weights occur once.
[[nodiscard]] PoseList different_weights_of(std::span<const SeenPose> poses);

/// The skins of some poses, one skin for each pose, with the joints placed as in the pose.
class SkinsInPoses {
 public:
  explicit SkinsInPoses(std::span<const SeenPose> poses);

  [[nodiscard]] bool any() const noexcept { return !skins_.empty(); }

  /// The transforms of one vertex in `count` poses, beginning with pose `first`.
  class Vertex {
   public:
    Vertex(const SkinsInPoses& skins, std::uint32_t vertex, std::size_t first, std::size_t count);
    /// Returns the normal that a viewer renders in a pose for a normal of any length. If the pose has no skin, the
    /// result is the normal itself. Otherwise the result is a unit vector, or (0, 0, 0) if the skin collapses the
    /// normal.
    [[nodiscard]] Vec3d seen(SkinRule rule, std::size_t pose, const Vec3d& normal) const;

   private:
    const SkinsInPoses& skins_;
    std::uint32_t vertex_;
    std::size_t first_;
    std::vector<AffineTransform> matrices_;
  };

 private:
  std::vector<std::optional<MeshSkin>> skins_;  // empty if no pose has a skin
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_SEEN_POSE_H_
