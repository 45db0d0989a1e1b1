// Blends the joint matrices of vertices.
#include "workflow/shading/mesh_skin.h"

#include <utility>

namespace chronormal::inline internal {

Result<MeshSkin> MeshSkin::read(const GltfDocument& document, const GltfShading& shading, std::size_t node,
                                std::optional<std::size_t> animation) {
  Result<GltfSkin> skin = GltfSkin::read(document, node, animation);
  if (!skin) return skin.error();
  MeshSkin result(std::move(skin).value());
  for (const GltfPart& part : shading.parts) {
    const Status status =
        result.skin_.read_shares(document, shading.mesh, part.primitive, result.first_, result.shares_);
    if (!status) return status.error();
  }
  result.first_.push_back(result.shares_.size());
  return result;
}

bool MeshSkin::pose(double time, bool just_before) {
  if (!skin_.moves()) return false;
  matrices_ = skin_.pose(time, just_before);
  return true;
}

AffineTransform MeshSkin::of_vertex(std::size_t vertex) const noexcept {
  AffineTransform sum{{Vec3d{}, Vec3d{}, Vec3d{}}, {}};
  for (std::size_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
    const AffineTransform& matrix = matrices_[shares_[i].joint];
    const double share = shares_[i].share;
    for (std::size_t c = 0; c < 3; ++c) sum.columns[c] = sum.columns[c] + share * matrix.columns[c];
    sum.offset = sum.offset + share * matrix.offset;
  }
  return sum;
}

Vec3d MeshSkin::carried(SkinRule rule, std::size_t vertex, const AffineTransform& matrix,
                        const Vec3d& normal) const noexcept {
  if (rule == SkinRule::kInverseTranspose) return unit(normal_matrix(matrix)(normal));
  if (rule == SkinRule::kBlended)
    return unit(normal.x * matrix.columns[0] + normal.y * matrix.columns[1] + normal.z * matrix.columns[2]);
  Vec3d sum;
  for (std::size_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
    const NormalMatrix of_joint = normal_matrix(matrices_[shares_[i].joint]);
    // The cofactors themselves look to the other side where the joint mirrors.
    sum = sum + (of_joint.mirrored ? -shares_[i].share : shares_[i].share) * unit(of_joint(normal));
  }
  return unit(sum);
}

}  // namespace chronormal::inline internal
