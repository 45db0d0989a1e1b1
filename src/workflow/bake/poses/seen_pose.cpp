#include "workflow/bake/poses/seen_pose.h"

#include <algorithm>
#include <utility>

#include "chronormal/core/parallel.h"

namespace chronormal::inline internal {

bool any_skinned(std::span<const SeenPose> poses) {
  return std::any_of(poses.begin(), poses.end(), [](const SeenPose& pose) { return pose.skin != nullptr; });
}

std::vector<SeenPose> seen_through(PoseList poses, const MeshSkin* skin) {
  std::vector<SeenPose> result;
  result.reserve(poses.size());
  for (std::vector<double>& pose : poses) result.push_back({std::move(pose), skin, 0});
  return result;
}

PoseList weights_of(std::span<const SeenPose> poses) {
  PoseList result;
  result.reserve(poses.size());
  for (const SeenPose& pose : poses) result.push_back(pose.weights);
  return result;
}

PoseList different_weights_of(std::span<const SeenPose> poses) {
  PoseList result;
  for (const SeenPose& pose : poses)
    if (result.empty() || pose.skin == nullptr || result.back() != pose.weights) result.push_back(pose.weights);
  return result;
}

SkinsInPoses::SkinsInPoses(std::span<const SeenPose> poses) {
  if (!any_skinned(poses)) return;
  skins_.resize(poses.size());
  parallel_for(poses.size(), [&](std::size_t p) {
    if (poses[p].skin == nullptr) return;
    skins_[p] = *poses[p].skin;
    skins_[p]->pose(poses[p].time, false);
  });
}

SkinsInPoses::Vertex::Vertex(const SkinsInPoses& skins, std::uint32_t vertex, std::size_t first, std::size_t count)
    : skins_(skins), vertex_(vertex), first_(first) {
  if (!skins.any()) return;
  matrices_.resize(count);
  for (std::size_t p = 0; p < count; ++p)
    if (skins.skins_[first + p]) matrices_[p] = skins.skins_[first + p]->of_vertex(vertex);
}

Vec3d SkinsInPoses::Vertex::seen(SkinRule rule, std::size_t pose, const Vec3d& normal) const {
  if (!skins_.any() || !skins_.skins_[first_ + pose]) return normal;
  const Vec3d carried = skins_.skins_[first_ + pose]->carried(rule, vertex_, matrices_[pose], normal);
  return is_finite(carried) ? carried : Vec3d{};
}

}  // namespace chronormal::inline internal
