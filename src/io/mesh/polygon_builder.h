/// Collects the faces of a mesh while a file is read. Private to io.
#ifndef CHRONORMAL_IO_MESH_POLYGON_BUILDER_H_
#define CHRONORMAL_IO_MESH_POLYGON_BUILDER_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// A builder of faces. Most meshes have only triangles, so the builder stores no offsets of faces until the first face
/// that is not a triangle.
class PolygonBuilder {
 public:
  static constexpr std::size_t kMaxCorners = std::numeric_limits<std::uint32_t>::max();

  void reserve_triangles(std::size_t count) { corners_.reserve(3 * count); }

  /// Adds a corner to the face that is being built. Returns false if the mesh would have more corners than 32 bits can
  /// count.
  [[nodiscard]] bool add_corner(std::uint32_t vertex) {
    if (corners_.size() >= kMaxCorners) return false;
    corners_.push_back(vertex);
    return true;
  }

  /// Returns the number of corners of the face that is being built.
  [[nodiscard]] std::size_t open_corners() const noexcept { return corners_.size() - face_begin_; }
  /// Returns the number of finished faces, which is the index of the face that is being built.
  [[nodiscard]] std::size_t face_count() const noexcept { return face_count_; }

  void drop_face() { corners_.resize(face_begin_); }

  void end_face() {
    if (open_corners() != 3 && offsets_.empty()) {
      for (std::size_t f = 0; f <= face_count_; ++f) offsets_.push_back(static_cast<std::uint32_t>(3 * f));
    }
    if (!offsets_.empty()) offsets_.push_back(static_cast<std::uint32_t>(corners_.size()));
    face_begin_ = corners_.size();
    ++face_count_;
  }

  /// Makes the topology of all faces. The builder must not be used afterwards. Errors: those of Topology::polygons().
  [[nodiscard]] Result<Topology> build(std::size_t vertex_count) {
    corners_.shrink_to_fit();
    offsets_.shrink_to_fit();
    if (offsets_.empty()) return Topology::triangles(vertex_count, std::move(corners_));
    return Topology::polygons(vertex_count, std::move(offsets_), std::move(corners_));
  }

 private:
  std::vector<std::uint32_t> offsets_;
  std::vector<std::uint32_t> corners_;
  std::size_t face_begin_ = 0;
  std::size_t face_count_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_POLYGON_BUILDER_H_
