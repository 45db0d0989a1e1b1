#include "workflow/audit/skinning_error.h"

#include <vector>

#include "chronormal/analysis/quality.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kSkinnedBlock = 1024;

// Returns the angle in degrees between two normals: the true normal `before` after the skin has transformed it, and
// `after`, the normal of the skinned surface. Returns nothing if `after` is nearly zero.
std::optional<double> degrees_at(const MeshSkin& skin, std::size_t vertex, const Vec3d& before, const Vec3d& after) {
  const AffineTransform matrix = skin.of_vertex(vertex);
  const NormalMatrix exact = normal_matrix(matrix);
  if (!(length(after) > kVanished * length(exact(before))) || !is_finite(after)) return std::nullopt;
  const Vec3d shown = skin.carried(SkinRule::kBlended, vertex, matrix, before);
  if (shown == Vec3d{} || !is_finite(shown)) return 180;
  return angle_between(shown, exact.mirrored ? -after : after) * kDegreesPerRadian;
}

}  // namespace

void SkinningErrors::add_sample(const BlendSource& source, const MeasuredSample& sample) {
  if (source.skin() == nullptr) return;
  if (!all_) all_.emplace();
  if (source.placed() != placed_) {
    placed_ = source.placed();
    const JudgedPart& part = sample.placed.part;
    std::vector<Vec3d> positions(part.vertices().size());
    parallel_each(positions.size(), kSkinnedBlock, [&](std::size_t i) {
      positions[i] = source.skin()->of_vertex(part.vertices()[i])(sample.placed.positions[i]);
    });
    PartNormals skinned;
    part.normals(positions, skinned);
    source.turn(positions, skinned.elements);
    last_ = parallel_fold<SkinningError>(
        part.outputs().size(), kSkinnedBlock,
        [&](std::size_t i, SkinningError& result) {
          const JudgedOutput& output = part.outputs()[i];
          const Vec3d& before = sample.placed.normals.elements[output.element];
          if (!(length(before) > kVanished * sample.largest[output.element])) return;
          const std::optional<double> degrees =
              degrees_at(*source.skin(), output.vertex, before, skinned.elements[output.element]);
          if (degrees) result.add(*degrees, source.at(sample.segment, sample.t, output));
        },
        [](SkinningError& to, const SkinningError& each) { to.add(each); });
  }
  all_->add(last_);
}

}  // namespace chronormal::inline internal
