/// Computes the terms that corners of polygons add to the normals of elements, by a weighting of faces. Private to
/// workflow.
///
/// Many corners are computed at once. If corners of the same polygon are close together in the list, the normal of the
/// polygon is computed once. Lengths and angles are computed in SIMD lanes. The result has the same bits as a call of
/// corner_term() for each corner.
#ifndef CHRONORMAL_WORKFLOW_SHADING_CORNER_TERMS_H_
#define CHRONORMAL_WORKFLOW_SHADING_CORNER_TERMS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/weighting.h"
#include "core/vector_area.h"

namespace chronormal::inline internal {

/// Returns the term that a corner of a polygon adds to the normal of its element. n is the normal of the polygon, and
/// its length is twice the area of the polygon. e and f are the edges from the corner to the next and to the previous
/// corner.
[[nodiscard]] Vec3d corner_term(Weighting weighting, const Vec3d& n, const Vec3d& e, const Vec3d& f) noexcept;

/// The number of elements that are computed together. It is large enough to fill SIMD lanes with their corners, and
/// small enough for the fastest cache.
inline constexpr std::size_t kElementsOfBlock = 128;

class CornerTerms {
 public:
  /// Returns an object without corners that belongs to this thread, so that its memory is reused. The object is valid
  /// until the next call of this function in this thread.
  [[nodiscard]] static CornerTerms& emptied(Weighting weighting);

  /// Appends a corner of a polygon. `loop` has the vertices of the polygon. `polygon` is a number that all calls use
  /// for this polygon and for no other.
  template <class PositionOf>
  void add(std::uint32_t polygon, std::span<const std::uint32_t> loop, std::size_t corner, const PositionOf& position) {
    face_of_corner_.push_back(face_of(polygon, loop, position));
    if (!needs_edges_) return;
    const std::size_t last = loop.size() - 1;
    const Vec3d here = position(loop[corner]);
    next_.push_back(position(loop[corner == last ? 0 : corner + 1]) - here);
    previous_.push_back(position(loop[corner == 0 ? last : corner - 1]) - here);
  }

  /// Computes the terms of all corners that were appended. Must be called once, after add() and before terms().
  void finish();

  /// Return the terms of all corners, the lengths of these terms, and the length of the normal of a corner's polygon
  /// (twice its area). Corners are numbered in the order of add().
  [[nodiscard]] std::span<const Vec3d> terms() const noexcept { return terms_; }
  [[nodiscard]] std::span<const double> lengths() const noexcept { return lengths_; }
  [[nodiscard]] double area(std::size_t corner) const noexcept { return areas_[face_of_corner_[corner]]; }

 private:
  struct Known {
    std::uint64_t use = 0;  // the value of use_ when this entry was made
    std::uint32_t polygon = 0, face = 0;
  };
  static constexpr std::size_t kKnown = 512;

  // Returns the index of a polygon in faces_. Computes the normal of the polygon if it was not computed recently.
  template <class PositionOf>
  std::uint32_t face_of(std::uint32_t polygon, std::span<const std::uint32_t> loop, const PositionOf& position) {
    Known& known = known_[polygon % kKnown];
    if (known.use == use_ && known.polygon == polygon) return known.face;
    known = {use_, polygon, static_cast<std::uint32_t>(faces_.size())};
    faces_.push_back(twice_vector_area(loop.size(), [&](std::size_t c) -> Vec3d { return position(loop[c]); }));
    return known.face;
  }

  Weighting weighting_ = Weighting::kArea;
  bool needs_edges_ = false;
  std::uint64_t use_ = 0;
  std::array<Known, kKnown> known_;
  // The normals of polygons. finish() replaces them by the vectors that are multiplied by the weights of corners.
  std::vector<Vec3d> faces_;
  std::vector<double> areas_;
  std::vector<std::uint32_t> face_of_corner_;
  std::vector<Vec3d> terms_, next_, previous_;
  std::vector<double> lengths_, angles_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SHADING_CORNER_TERMS_H_
