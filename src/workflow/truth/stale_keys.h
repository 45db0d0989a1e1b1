/// Finds stored normals of targets that do not show what their author saw. Private to workflow.
///
/// Another program may have moved vertices after the normals of a target were computed, or may have stored no normals.
/// A target is *stale* on a connected part of the mesh if both conditions hold:
///
///     Its normals are no nearer to the true ones than the base normals. To test this, the base normals are turned like
///     the faces around their vertices. The median angle from these turned normals to the stored normals of the target
///     must be at least three quarters of the median turn.
///     Its normals do not turn like the surface. Over the part, the turns of normals and surface, as axes times sines,
///     have a correlation below a half.
///
/// The first condition alone would also find targets whose author weights faces differently. Vertices around which the
/// surface turns by less than a degree do not count. A connected part is judged as a whole, since exporters drop small
/// deltas of single vertices.
#ifndef CHRONORMAL_WORKFLOW_TRUTH_STALE_KEYS_H_
#define CHRONORMAL_WORKFLOW_TRUTH_STALE_KEYS_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "workflow/shading/gltf_shading.h"
#include "workflow/truth/author_sums.h"

namespace chronormal::inline internal {

/// A target that is stale on some connected parts of the mesh.
struct StaleKey {
  std::size_t target = 0;
  std::size_t vertices = 0;  ///< the number of vertices of these parts that the target turns by more than a degree
};

class StaleKeys {
 public:
  StaleKeys() = default;
  /// Judges all targets that store normals. Compares the stored normals with the given sums of elements or, if `sums`
  /// is nullptr, with area-weighted sums around each vertex. Takes O(corners) for each target, on all cores.
  explicit StaleKeys(const GltfShading& shading, const AuthorSums* sums = nullptr);
  /// Keeps only the results that `others` shares: a target stays stale on a part of the mesh only if it is stale on
  /// this part in `others` as well.
  void keep_common(const StaleKeys& others);

  [[nodiscard]] bool is_stale(std::size_t target, std::uint32_t vertex) const {
    return !stale_[target].empty() && stale_[target][part_of_vertex_[vertex]];
  }
  /// Returns true if the target is stale on all parts of the mesh that the target turns.
  [[nodiscard]] bool is_stale_everywhere(std::size_t target) const { return is_all_stale_[target]; }
  [[nodiscard]] const std::vector<StaleKey>& list() const noexcept { return list_; }

 private:
  std::vector<std::uint32_t> part_of_vertex_;
  // stale_ has for each target a list with an entry for each part of the mesh, which is true if the target is stale on
  // that part. The list is empty if the target is stale nowhere.
  std::vector<std::vector<bool>> stale_;
  std::vector<bool> is_all_stale_;  // for each target, true if it is stale wherever it turns the mesh
  std::vector<StaleKey> list_;
};

/// Gives vertices at one point separate elements if their base normals agree but their normals in a target differ, as
/// at an edge that is hard in a single target only. Ignores targets on parts of the mesh on which they are stale. The
/// groups of the shading must have their corners. Returns true if any element was split.
bool split_by_keys(GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_STALE_KEYS_H_
