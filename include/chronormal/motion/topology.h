/// Which vertices make which face: the part of a mesh that does not move.
///
/// Faces are polygons of three or more corners, counter-clockwise seen from the side to which the normal points. Two
/// triangles and a quad are kept as
///
///     corners   0 1 2   2 1 3   4 5 6 7        vertex of each corner, face after face
///     offsets   0       3       6         10   where each face begins, and the end
///
/// A mesh of triangles alone keeps no offsets.
#ifndef CHRONORMAL_MOTION_TOPOLOGY_H_
#define CHRONORMAL_MOTION_TOPOLOGY_H_

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal {

class Topology {
 public:
  Topology() = default;

  /// Builds polygons from corners and offsets (see above) over vertices 0 .. vertex_count - 1.
  /// Errors: a face of fewer than 3 corners, a corner that names no vertex, offsets that do not ascend from 0 to the
  /// number of corners; the place is "face F" or "face F, corner C". O(corners).
  [[nodiscard]] static Result<Topology> polygons(std::size_t vertex_count, std::vector<std::uint32_t> offsets,
                                                 std::vector<std::uint32_t> corners);

  /// Builds triangles from three corners each. Errors and cost as for polygons().
  [[nodiscard]] static Result<Topology> triangles(std::size_t vertex_count, std::vector<std::uint32_t> corners);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return vertex_count_; }
  [[nodiscard]] std::size_t corner_count() const noexcept { return corners_.size(); }
  [[nodiscard]] std::size_t face_count() const noexcept {
    return offsets_.empty() ? corners_.size() / 3 : offsets_.size() - 1;
  }
  /// Whether every face is a triangle.
  [[nodiscard]] bool all_triangles() const noexcept { return offsets_.empty(); }

  /// The vertices of one face, in order.
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t f) const noexcept {
    assert(f < face_count());
    if (offsets_.empty()) return {corners_.data() + 3 * f, 3};
    return {corners_.data() + offsets_[f], corners_.data() + offsets_[f + 1]};
  }

  [[nodiscard]] std::span<const std::uint32_t> corners() const noexcept { return corners_; }

  friend bool operator==(const Topology&, const Topology&) = default;

 private:
  std::size_t vertex_count_ = 0;
  std::vector<std::uint32_t> offsets_;  // empty where all faces are triangles
  std::vector<std::uint32_t> corners_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_TOPOLOGY_H_
