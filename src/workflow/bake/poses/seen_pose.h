/// A pose as it is on the screen: weights, and the skin that carries what they make. Private to workflow.
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
  double time = 0;                 ///< of the pose of its joints, where they move

  friend bool operator==(const SeenPose&, const SeenPose&) = default;
};

/// Whether a skin carries any of these.
[[nodiscard]] bool any_skinned(std::span<const SeenPose> poses);
/// Poses that are seen as they are, or all through the skin that is given.
[[nodiscard]] std::vector<SeenPose> seen_through(PoseList poses, const MeshSkin* skin);
/// The weights of each pose.
[[nodiscard]] PoseList weights_of(std::span<const SeenPose> poses);
/// The same, once where only the joints of a skin move.
[[nodiscard]] PoseList different_weights_of(std::span<const SeenPose> poses);

/// The skins of some poses, with their joints as they are in each.
class SkinsInPoses {
 public:
  explicit SkinsInPoses(std::span<const SeenPose> poses);

  [[nodiscard]] bool any() const noexcept { return !skins_.empty(); }

  /// How one vertex is carried in the poses from number `first` on.
  class Vertex {
   public:
    Vertex(const SkinsInPoses& skins, std::uint32_t vertex, std::size_t first, std::size_t count);
    /// What is seen of a normal of any length in a pose: the normal itself where no skin carries it, else a unit
    /// vector, or (0, 0, 0) where nothing is left of it.
    [[nodiscard]] Vec3d seen(SkinRule rule, std::size_t pose, const Vec3d& normal) const;

   private:
    const SkinsInPoses& skins_;
    std::uint32_t vertex_;
    std::size_t first_;
    std::vector<AffineTransform> matrices_;
  };

 private:
  std::vector<std::optional<MeshSkin>> skins_;  // empty where there are none
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_SEEN_POSE_H_
