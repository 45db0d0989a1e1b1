/// The true normals of vertices in any pose. Private to workflow.
///
/// Units      A right normal has the true direction. Its length is the quotient |n(w)| / |n(0)| of normals weighted by
///            area, or 1 if n(0) is zero. It is (0, 0, 0) if n(w) is so short compared with its terms that its
///            direction means nothing.
/// Poses      A pose has the weights of the mesh's own targets. Further weights may follow, and are ignored.
/// Threads    const functions may run at the same time. Each function uses all cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_RIGHT_NORMALS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_RIGHT_NORMALS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/blocks.h"
#include "workflow/bake/deltas/terms.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

class RightNormals {
 public:
  /// Creates the object. base_normals has the base normals that the file will store, (V, 3), and `largest` the length
  /// of the largest term of each element. All arguments must outlive this object.
  RightNormals(const GltfShading& shading, const NormalTerms& terms, std::span<const float> base_normals,
               const std::vector<double>& largest);

  [[nodiscard]] std::size_t targets() const noexcept { return shading_.set.targets.size(); }
  /// Returns true if normals are weighted by area, which makes them quadratic in the weights.
  [[nodiscard]] bool are_by_area() const noexcept { return !terms_.is_fitted(); }
  /// Returns the stored base normal of a vertex.
  [[nodiscard]] Vec3d stored(std::size_t vertex) const noexcept;
  /// Return the normals of all elements, or of some elements, in a pose. The rotation from the geometry to the author's
  /// base normals is not yet applied. Take O(vertices + elements).
  [[nodiscard]] std::vector<Vec3d> of_elements(std::span<const double> pose) const;
  [[nodiscard]] std::vector<Vec3d> of_elements(std::span<const double> pose,
                                               std::span<const std::uint32_t> elements) const;
  /// Returns the right normal of a vertex in a pose. of_element is the normal of the vertex's element in this pose,
  /// from of_elements().
  [[nodiscard]] Vec3d of_vertex(std::size_t vertex, const Vec3d& of_element) const noexcept;

  /// Calls visit(n, first, right) for each vertex and each batch of poses. n is the index of the vertex in `vertices`,
  /// and `right` has the unit normals of this vertex in the poses from number `first` on. Calls for different n may run
  /// at the same time, but each batch begins only when the batch before has ended. In each pose, computes the
  /// positions of all vertices, but only the normals of the listed vertices.
  template <class Visit>
  void for_each(std::span<const std::uint32_t> vertices, const PoseList& poses, const Visit& visit) const {
    constexpr std::size_t kBytes = std::size_t{32} << 20, kFewest = 4, kTogether = 8, kVertices = 64;
    const Places places(shading_, vertices);
    const std::size_t elements = places.elements.size();
    const std::size_t batch = std::max(kFewest, kBytes / (sizeof(Vec3d) * (elements + 1)));
    std::vector<Vec3d> of_elements_in_poses(elements * std::min(batch, poses.size()));
    for (std::size_t first = 0; first < poses.size(); first += batch) {
      const std::size_t count = std::min(batch, poses.size() - first);
      // Writes the normals of several poses together, so that whole cache lines are filled.
      parallel_blocks(count, std::min(batch, kTogether), [&](IndexRange some) {
        std::vector<std::vector<Vec3d>> directions;
        for (std::size_t p = some.first; p < some.end(); ++p)
          directions.push_back(directions_of(std::span(poses[first + p]).first(targets()), places.elements));
        for (std::size_t e = 0; e < elements; ++e)
          for (std::size_t p = 0; p < some.count; ++p)
            of_elements_in_poses[e * count + some.first + p] = directions[p][e];
      });
      parallel_blocks(vertices.size(), kVertices, [&](IndexRange range) {
        std::vector<Vec3f> right(count);
        for (std::size_t n = range.first; n < range.first + range.count; ++n) {
          const ShownTurn& turn = turns_[vertices[n]];
          const Vec3d* const of_element = of_elements_in_poses.data() + places.of_vertices[n] * count;
          for (std::size_t p = 0; p < count; ++p) right[p] = to_float(turn(of_element[p]));
          visit(n, first, std::span<const Vec3f>(right));
        }
      });
    }
  }

 private:
  // The elements of some vertices, in ascending order. of_vertices has for each vertex the index of its element in this
  // list.
  struct Places {
    Places(const GltfShading& shading, std::span<const std::uint32_t> vertices);
    std::vector<std::uint32_t> elements;
    std::vector<std::size_t> of_vertices;
  };
  [[nodiscard]] std::vector<Vec3d> normals_of(std::span<const double> pose,
                                              std::span<const std::uint32_t> elements) const;
  // Returns the unit normals of some elements, or (0, 0, 0) for a normal without a direction.
  [[nodiscard]] std::vector<Vec3d> directions_of(std::span<const double> pose,
                                                 std::span<const std::uint32_t> elements) const;
  [[nodiscard]] bool is_judged(std::uint32_t element, const Vec3d& normal) const noexcept;

  const GltfShading& shading_;
  const NormalTerms& terms_;
  std::span<const float> base_normals_;
  const std::vector<double>& largest_;
  std::vector<Vec3d> base_;           // n(0) of each element; kept, since it is often needed
  std::vector<double> base_lengths_;  // lengths of base_
  std::vector<std::uint32_t> all_elements_;
  std::vector<ShownTurn> turns_;  // for each vertex, the rotation from n(0) to the stored normal
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_RIGHT_NORMALS_H_
