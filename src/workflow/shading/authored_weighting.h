/// Finds the weighting of faces that an author's normals follow. Private to workflow.
///
/// The program that made a mesh weighted the faces around a vertex in its own way (normals/weighting.h). The stored
/// normals show which weighting the program used. The true normals follow the same weighting, so a difference from
/// another weighting is not an error of the file.
///
///     tells      a stored normal tells if two weightings differ there by more than 0.1 degrees; at all other normals
///                the weightings agree
///     distance   of a weighting: the median, over the normals that tell, of the angle to the stored normal
///     detected   the weighting at the smallest distance, if that is at most a degree, and at most two thirds of the
///                distance of area; otherwise area, which can be computed exactly at every time
///
/// All weightings give a flat or regular mesh the same normals, and many sequences begin with such a mesh. For this
/// reason the normals of later keyframes are compared, too.
///
/// The distance is a median. For this reason normals that an author bent by hand have no influence as long as most
/// normals are as the program computed them. Rounding to 8 bits, and quads that were cut into triangles later, change
/// the distance little compared with the limit of two thirds, if weightings differ by more than a degree. If no
/// weighting fits, all have about the same distance.
#ifndef CHRONORMAL_WORKFLOW_SHADING_AUTHORED_WEIGHTING_H_
#define CHRONORMAL_WORKFLOW_SHADING_AUTHORED_WEIGHTING_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// A stored normal of a vertex, with the element of the vertex in NormalGroups. The normal has any length except zero.
struct StoredNormal {
  std::uint32_t vertex = 0, element = 0;
  Vec3d normal;
};

/// The angles between the stored normals and the normals of one weighting, in degrees. Opposite normals have the
/// distance 0, since an author may show either side of a surface.
struct WeightingDistance {
  std::size_t count = 0;  ///< the number of stored normals whose element has a normal
  double sum = 0, worst = 0;
  std::uint32_t worst_at = 0;  ///< the vertex with the largest angle
  double of_telling = 0;       ///< the median angle at the normals that tell weightings apart

  [[nodiscard]] double mean() const noexcept { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

struct AuthoredWeighting {
  [[nodiscard]] const WeightingDistance& of(Weighting weighting) const noexcept {
    return distances[static_cast<std::size_t>(weighting)];
  }

  /// The distance of the stored normals from each weighting, in the order of kAllWeightings.
  std::array<WeightingDistance, kAllWeightings.size()> distances;
  std::size_t telling = 0;
  Weighting detected = Weighting::kArea;  ///< the weighting that fits best, one of kWeightings
};

/// Compares stored normals with the normals of all weightings of faces. `groups` must belong to the topology, and have
/// corners. Takes O(corners) for each of the seven weightings. Uses all cores, and little memory besides the stored
/// normals. The result has the same bits on any number of threads.
[[nodiscard]] AuthoredWeighting find_authored_weighting(const Topology& topology, VectorView<const float> positions,
                                                        const NormalGroups& groups, std::vector<StoredNormal> stored);

/// The positions and the stored normals of one keyframe.
struct ShadedKeyframe {
  VectorView<const float> positions;
  std::vector<StoredNormal> stored;
};

/// Compares the stored normals of a sequence with the normals of all weightings of faces. Calls read(k) for keyframe 0
/// and for up to four later keyframes. read() returns nothing if keyframe k stores no normals; the positions that it
/// returns must be valid until the next call. The detected weighting follows from all of these keyframes, and all other
/// members of the result are those of keyframe 0.
[[nodiscard]] AuthoredWeighting find_authored_weighting(
    const Topology& topology, const NormalGroups& groups, std::size_t keyframes,
    const std::function<std::optional<ShadedKeyframe>(std::size_t keyframe)>& read);

/// The largest median angle, in degrees, at which stored normals count as normals of a surface. Normals in random
/// directions have a median of 60 degrees.
inline constexpr double kLargestMedian = 45;

/// Returns the median angle, in degrees, between the stored normals of corners and the area-weighted normals of their
/// elements. An element counts once, with the normal of its first corner. Opposite normals have the angle 0, since an
/// author may show either side of a surface. Returns 0 if there is nothing to compare.
[[nodiscard]] double median_angle(const Topology& topology, VectorView<const float> positions,
                                  const NormalGroups& groups, VectorView<const float> normal_of_corner);

/// Compares the base normals of a mesh with the normals of all weightings of faces. The groups of the mesh must have
/// their corners. If the mesh has no base normals, the detected weighting is area. If there are more than `most`
/// normals, compares only `most` of them, evenly spaced.
[[nodiscard]] AuthoredWeighting find_authored_weighting(const GltfShading& shading,
                                                        std::size_t most = static_cast<std::size_t>(-1));

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_AUTHORED_WEIGHTING_H_
