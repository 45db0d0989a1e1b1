/// The normals that a viewer renders for one mesh of a glTF file, and the true normals. Private to workflow.
///
/// A viewer renders normalize(N + sum_i w_i D_i), from the stored base normal N and the stored deltas D_i at weights w.
/// The true normals follow from the geometry. They are n(w) of eq. 32, area-weighted, over the faces whose corners
/// share the stored base normal at one point. An author may have given the base other normals: by another weighting, by
/// a bevel, or by hand. The true normals keep this difference. For each vertex, the smallest rotation that takes the
/// direction of n(0) to N also takes every n(w) to the true normal.
///
///     authored offset    the angle of that rotation; not an error
///     motion error       the angle between the rendered and the true normal at w
///
/// A primitive without NORMAL is flat by the specification: viewers compute its normals from positions, so these
/// normals are true.
///
/// Shapes     V is the number of vertices in all primitives with faces, one primitive after the other (parts); K is the
///            number of targets of the mesh.
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
  bool smooth = false;        ///< if true, primitives without NORMAL get vertex normals; otherwise they are flat
  double crease_angle = 180;  ///< degrees; if `smooth` is true, edges sharper than this in the base are hard
  /// If true, normal_deltas, tangents and tangent_deltas are kept. Otherwise they are only checked.
  bool keep_deltas = true;
  bool weld = true;  ///< if true, vertices at the same point in every pose are joined
};

struct GltfShading {
  static constexpr std::uint32_t kNoElement = static_cast<std::uint32_t>(-1);

  std::size_t mesh = 0;
  std::vector<GltfPart> parts;  ///< the primitives that have faces; `node` is empty
  BlendSet set;                 ///< all parts together, with all targets of the file, also correction targets
  NormalGroups groups;          ///< groups of set.topology; outputs are vertices, also those of flat primitives
  /// The element (group of corners with one normal) of each vertex, (V). It is kNoElement if the vertex has no face or
  /// its primitive is flat.
  std::vector<std::uint32_t> element_of_vertex;
  /// The point of each vertex, a number below V, as a list (V). Vertices belong to one point if they have the same
  /// place in the base and the same deltas in all targets. However, the two sides of a sheet are two points. Only the
  /// author's truth (workflow/truth) needs points.
  std::vector<std::uint32_t> point_of_vertex;
  /// The place of each vertex, (V). Places are numbered like points, except that both sides of a sheet are one place.
  /// The list is empty if the mesh has no sheet with two sides.
  std::vector<std::uint32_t> place_of_vertex;
  /// For each corner, true if its face belongs to one side of a sheet, but its vertex shows the normal of the other
  /// side. Elements leave these corners out. The list is empty if no corner is on the back.
  std::vector<bool> at_the_back;
  std::vector<float> normals;  ///< (V, 3) N as stored; (0, 0, 0) if the primitive has no normals
  /// The normal deltas that the file stores for each target, as arrays (V, 3). An array is empty if no primitive stores
  /// deltas for the target.
  std::vector<std::vector<float>> normal_deltas;
  /// For each target, true if any of its normal deltas is not zero, even if the deltas are not kept.
  std::vector<bool> turns;
  std::vector<float> tangents;                     ///< (V, 4); empty if no primitive has tangents
  std::vector<std::vector<float>> tangent_deltas;  ///< as normal_deltas, for tangents
  std::optional<GltfBakeMark> mark;
  /// The number of correction targets of an earlier bake that have lost their deltas, because another program has made
  /// new normals for the file. If this number is not 0, `mark` is empty.
  std::size_t emptied = 0;
  std::size_t split_by_crease = 0;  ///< the number of vertices that a crease would have split

  [[nodiscard]] std::uint32_t place_of(std::uint32_t vertex) const noexcept {
    return place_of_vertex.empty() ? point_of_vertex[vertex] : place_of_vertex[vertex];
  }
  /// Returns the number of targets that move vertices by themselves: all but correction targets.
  [[nodiscard]] std::size_t own_targets() const noexcept {
    return set.targets.size() - (mark ? mark->extras.size() : 0);
  }
};

/// Reads one mesh. Vertices with the same place in the base and the same deltas in all targets are one point, even if
/// they belong to different primitives. The vertices of one point share a normal if their stored base normals agree.
///
/// Triangles that name a vertex twice are left out, unless a primitive has no others: a mesh must give the same normals
/// as a strip, which needs such triangles, and as a list.
///
/// Vertices of primitives without NORMAL have no element, and their faces do not count. If options.smooth is true,
/// these vertices get normals by the crease angle, and share them only among each other. A vertex of the file has a
/// single normal, so a crease cannot split it: the elements on both sides of the crease are joined there, and
/// split_by_crease counts the vertex.
///
/// Errors: see GltfDocument; kUsage for a crease angle outside [0, 180]; kInvalidInput, with the JSON pointer, if no
/// primitive of the mesh has faces, or if extras.chronormal was not written by a bake.
[[nodiscard]] Result<GltfShading> read_gltf_shading(const GltfDocument& document, std::size_t mesh,
                                                    const GltfShadingOptions& options = {});

/// Returns the normal n(w) of one element. positions has the coordinates of all vertices at the weights w, (V, 3).
[[nodiscard]] Vec3d normal_from_positions(const GltfShading& shading, std::span<const double> positions,
                                          std::size_t element) noexcept;

/// Computes n(w) of all elements from the blended positions, by cross products in double (eq. 1 of docs/theory.md).
/// Does not remove results that are only rounding errors. weights must have one value for each target. Takes
/// O(corners), on all cores.
[[nodiscard]] std::vector<Vec3d> normals_from_positions(const GltfShading& shading, std::span<const double> weights);

/// Returns the true direction at a vertex: n(w) of its element, rotated as the author rotated the base. stored is N,
/// the base normal of the vertex in the file. base_normal and normal are n(0) and n(w) of the element, of any length.
/// The result is zero if n(w) is zero. If n(0) or N is zero, nothing is rotated. If N faces away from n(0), -n(0) and
/// -n(w) are used instead of n(0) and n(w).
[[nodiscard]] Vec3d shown_direction(const Vec3d& stored, const Vec3d& base_normal, const Vec3d& normal) noexcept;

/// A map with the same effect as shown_direction() for one vertex, for callers that apply it to many normals. The map
/// is linear and keeps lengths.
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
  Vec3d axis_;         // the axis of the rotation; its length is the sine of the angle
  double cosine_ = 1;  // the cosine of the angle; negative if N faces away from n(0)
};

/// Computes the weights of correction targets from the weights of the mesh's own targets. weights must have one value
/// for each target. The function overwrites the weights of correction targets.
void fill_extra_weights(const GltfShading& shading, std::span<double> weights) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_GLTF_SHADING_H_
