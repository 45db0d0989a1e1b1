/// Which weighting an author's normals follow. Private to workflow.
///
/// The program that made a mesh weighed the faces around a vertex in its own way (normals/weighting.h); what it stored
/// says which. Right normals are those of that weighting, and what another one makes of them is no fault of the file.
///
///     tells      a stored normal around which two weightings differ by more than 0.1 degrees: elsewhere all agree
///     distance   of a weighting: the median, over the normals that tell, of the angle to the stored one
///     detected   the weighting at the smallest distance, where that is at most a degree, and two thirds of the
///                distance of area; else area, which is exact at every time
///
/// It is the median because it does not ask about the normals that an author bent by hand, as long as most are as they
/// were computed. Normals in 8 bits, and quads that were cut into triangles afterwards, leave it well within the two
/// thirds where weightings differ by more than a degree; where none comes close, all are about as far off.
#ifndef CHRONORMAL_WORKFLOW_SHADING_AUTHORED_WEIGHTING_H_
#define CHRONORMAL_WORKFLOW_SHADING_AUTHORED_WEIGHTING_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// A normal that is stored for a vertex, of any length but zero, and its element in NormalGroups.
struct StoredNormal {
  std::uint32_t vertex = 0, element = 0;
  Vec3d normal;
};

/// How far stored normals are from those of one weighting, or of its other side, in degrees.
struct WeightingDistance {
  std::size_t count = 0;  ///< of the stored normals, those whose element has a normal
  double sum = 0, worst = 0;
  std::uint32_t worst_at = 0;  ///< the vertex
  double of_telling = 0;       ///< the median over those that tell

  [[nodiscard]] double mean() const noexcept { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

struct AuthoredWeighting {
  [[nodiscard]] const WeightingDistance& of(Weighting weighting) const noexcept {
    return distances[static_cast<std::size_t>(weighting)];
  }

  std::array<WeightingDistance, kAllWeightings.size()> distances;  ///< in the order of kAllWeightings
  std::size_t telling = 0;
  Weighting detected = Weighting::kArea;  ///< one of kWeightings
};

/// Holds stored normals against all weightings of the geometry. groups must be those of the topology, with corners.
/// O(corners), seven times; on all cores, and in little memory beside the stored normals. The same bits on any number of
/// threads.
[[nodiscard]] AuthoredWeighting find_authored_weighting(const Topology& topology, VectorView<const float> positions,
                                                        const NormalGroups& groups, std::vector<StoredNormal> stored);

/// The same of the base normals of a mesh; area where it has none. Its groups must have their corners. Where there are
/// more normals than `most`, about that many of them are asked, evenly.
[[nodiscard]] AuthoredWeighting find_authored_weighting(const GltfShading& shading,
                                                        std::size_t most = static_cast<std::size_t>(-1));

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_AUTHORED_WEIGHTING_H_
