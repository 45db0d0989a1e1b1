/// What the vertices of one mesh of a glTF file show, and what they should show. Private to workflow.
///
/// A viewer shows normalize(N + sum_i w_i D_i): the stored base normal and the stored deltas. What it should show follows
/// from the geometry: n(w) of eq. 32, area-weighted, over the faces whose corners share the stored base normal at one
/// point. Where an author gave base normals of his own (another weighting, a bevel, a lie), that is kept: the smallest
/// rotation that takes the direction of n(0) to N, fixed per vertex, takes every n(w) to what should be shown.
///
///     authored offset    the angle of that rotation: no fault
///     motion error       the angle between what is shown at w and what should be
///
/// A primitive without NORMAL is flat by the specification: viewers compute it from positions, so that it is right.
///
/// Shapes     V = vertices of all primitives with faces, one primitive after the other (parts); K = targets of the
/// mesh.
#ifndef CHRONORMAL_WORKFLOW_SHADING_GLTF_SHADING_H_
#define CHRONORMAL_WORKFLOW_SHADING_GLTF_SHADING_H_

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

struct GltfShadingOptions {
  bool smooth = false;        ///< primitives without NORMAL get vertex normals, instead of being flat
  double crease_angle = 180;  ///< degrees, for those: edges sharper than this in the base are hard
  /// Whether normal_deltas, tangents and tangent_deltas are kept; otherwise they are checked only.
  bool keep_deltas = true;
  bool weld = true;  ///< vertices at one point throughout are one
};

struct GltfShading {
  static constexpr std::uint32_t kNoElement = static_cast<std::uint32_t>(-1);

  std::size_t mesh = 0;
  std::vector<GltfPart> parts;  ///< node is empty
  BlendSet set;                 ///< of all parts together; targets as the file has them, extra ones too
  NormalGroups groups;          ///< of its topology; outputs are vertices, of flat primitives too
  /// (V), the element of each vertex; kNoElement where it has no face, or its primitive is flat.
  std::vector<std::uint32_t> element_of_vertex;
  /// (V), which vertices are one point: at one place in the base, with the same deltas in all targets. Below V. For
  /// whoever looks for the author's truth.
  std::vector<std::uint32_t> point_of_vertex;
  /// Corners of faces that lie at the back of those whose normal their vertex shows; elements leave them out. Empty
  /// where there are none.
  std::vector<bool> at_the_back;
  std::vector<float> normals;  ///< (V, 3) N as stored; (0, 0, 0) where a primitive has none
  /// Per target the stored deltas (V, 3), or empty where no primitive stores any for it.
  std::vector<std::vector<float>> normal_deltas;
  std::vector<bool> turns;      ///< per target, whether some of these are other than zero, kept or not
  std::vector<float> tangents;  ///< (V, 4), or empty where no primitive has any
  std::vector<std::vector<float>> tangent_deltas;  ///< as normal_deltas
  std::optional<GltfBakeMark> mark;
  /// Extra targets of an earlier bake that turn nothing, because another program made normals anew: there is no mark
  /// then.
  std::size_t emptied = 0;
  std::size_t split_by_crease = 0;  ///< vertices that a crease would have split

  /// The number of targets that move vertices by themselves: all but extra ones.
  [[nodiscard]] std::size_t own_targets() const noexcept {
    return set.targets.size() - (mark ? mark->extras.size() : 0);
  }
};

/// Reads one mesh. Vertices at one place in the base and with the same deltas in all targets are one point, across its
/// primitives, and share a normal where their stored base normals agree. Vertices of primitives without NORMAL are in
/// no element, and their faces count for none; with options.smooth they get normals by the crease angle, shared among
/// such primitives only. A vertex of the file has one normal: where a crease would split one, it stays whole (parts on
/// both sides of the crease are joined there), and split_by_crease counts it.
///
/// Errors: of GltfDocument; kUsage for a crease angle outside [0, 180]; kInvalidInput where the mesh has no primitive
/// with faces, or extras.chronormal is not what a bake writes, with the JSON pointer.
[[nodiscard]] Result<GltfShading> read_gltf_shading(const GltfDocument& document, std::size_t mesh,
                                                    const GltfShadingOptions& options = {});

/// n(w) of one element, from the positions of all vertices, (V, 3).
[[nodiscard]] Vec3d normal_from_positions(const GltfShading& shading, std::span<const double> positions,
                                          std::size_t element) noexcept;

/// Computes n(w) of all elements from the blended positions, in double, by the cross product: nothing but eq. 1, and
/// no look at what is rounding. weights must have one for each target. O(corners); on all cores.
[[nodiscard]] std::vector<Vec3d> normals_from_positions(const GltfShading& shading, std::span<const double> weights);

/// The direction that a vertex should show: n(w) of its element, turned as the author turned the base. base_normal and
/// normal are n(0) and n(w) of the element, of any length; zero where n(w) is. Where n(0) or N is zero nothing is
/// turned. Where N
/// looks to the other side than n(0), both are those of the other side: -n(0) and -n(w).
[[nodiscard]] Vec3d shown_direction(const Vec3d& stored, const Vec3d& base_normal, const Vec3d& normal) noexcept;

/// The same for one vertex and many normals: a linear map, which keeps their lengths.
class ShownTurn {
 public:
  ShownTurn() = default;
  ShownTurn(const Vec3d& stored, const Vec3d& base_normal) noexcept;

  [[nodiscard]] Vec3d operator()(const Vec3d& normal) const noexcept {
    const double cosine = std::fabs(cosine_);
    const Vec3d turned = cosine * normal + cross(axis_, normal) + (dot(axis_, normal) / (1 + cosine)) * axis_;
    return std::signbit(cosine_) ? -turned : turned;
  }

 private:
  Vec3d axis_;         // as long as the sine of the angle
  double cosine_ = 1;  // with a sign where both are those of the other side
};

/// The weight of every target where those of the mesh's own targets are given: extra ones get theirs.
/// weights must have one for each target; those of extra ones are written
void fill_extra_weights(const GltfShading& shading, std::span<double> weights) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_GLTF_SHADING_H_
