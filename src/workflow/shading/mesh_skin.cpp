// Blends the joint matrices of vertices, and transforms normals by them.
#include "workflow/shading/mesh_skin.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kEvenBlock = 1024;
// The tolerance for axes of a matrix that should be perpendicular and equally long, relative to the square of the
// scale. Matrices in files are rounded. A matrix within this tolerance changes the angle between two normals by at most
// 5e-5 times the angle.
constexpr double kEven = 1e-4;

bool keeps_angles(const std::array<Vec3d, 3>& columns) {
  const auto& [x, y, z] = columns;
  const double xx = dot(x, x), yy = dot(y, y), zz = dot(z, z), most = std::max({xx, yy, zz});
  const double off =
      std::max({most - std::min({xx, yy, zz}), std::fabs(dot(x, y)), std::fabs(dot(y, z)), std::fabs(dot(z, x))});
  return most > 0 && std::isfinite(most) && off <= kEven * most;
}

}  // namespace

Result<MeshSkin> MeshSkin::read(const GltfDocument& document, const GltfShading& shading, std::size_t node,
                                std::optional<std::size_t> animation, const MeshSkin* of_same_mesh) {
  Result<GltfSkin> skin = GltfSkin::read(document, node, animation);
  if (!skin) return skin.error();
  if (of_same_mesh != nullptr && of_same_mesh->shares_->joints <= skin.value().joint_count())
    return MeshSkin(std::move(skin).value(), of_same_mesh->shares_);
  const auto shares = std::make_shared<Shares>();
  for (const GltfPart& part : shading.parts) {
    const Status status = skin.value().read_shares(document, shading.mesh, part.primitive, shares->first, shares->all);
    if (!status) return status.error();
  }
  shares->first.push_back(shares->all.size());
  for (const JointShare& share : shares->all) shares->joints = std::max(shares->joints, std::size_t{share.joint} + 1);
  return MeshSkin(std::move(skin).value(), shares);
}

bool MeshSkin::pose(double time, bool just_before) {
  if (!moves()) return false;
  matrices_ = skin_->pose(time, just_before);
  return true;
}

bool MeshSkin::is_even(std::span<const std::uint32_t> vertices) const {
  std::atomic<bool> are_all_even = true;
  parallel_each(vertices.size(), kEvenBlock, [&](std::size_t n) {
    if (are_all_even && !keeps_angles(of_vertex(vertices[n]).columns)) are_all_even = false;
  });
  return are_all_even;
}

AffineTransform MeshSkin::of_vertex(std::size_t vertex) const noexcept {
  AffineTransform sum{{Vec3d{}, Vec3d{}, Vec3d{}}, {}};
  for (std::size_t i = shares_->first[vertex]; i < shares_->first[vertex + 1]; ++i) {
    const AffineTransform& matrix = matrices_[shares_->all[i].joint];
    const double share = shares_->all[i].share;
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
  for (std::size_t i = shares_->first[vertex]; i < shares_->first[vertex + 1]; ++i) {
    const NormalMatrix of_joint = normal_matrix(matrices_[shares_->all[i].joint]);
    // Changes the sign for a joint that mirrors, because its cofactor matrix gives a normal that points to the wrong
    // side.
    sum = sum + (of_joint.mirrored ? -shares_->all[i].share : shares_->all[i].share) * unit(of_joint(normal));
  }
  return unit(sum);
}

}  // namespace chronormal::inline internal
