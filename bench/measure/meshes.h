/// Makes the meshes that are measured: a closed grid on a torus, in the order of the grid or shuffled.
///
/// Every vertex has six faces. The first keyframe is a torus with ripples. In the second keyframe the torus is turned
/// by 60 degrees, stretched, and twisted around its own tube by up to a radian, so that every face changes its shape,
/// and none collapses. A mesh has n vertices and 2 n faces; n is chosen to get about the requested number of elements.
#ifndef BENCH_MEASURE_MESHES_H_
#define BENCH_MEASURE_MESHES_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/motion/motion.h"
#include "core/memory.h"

namespace chronormal::bench {

enum class Elements { kFaces, kVertices };

class Mesh {
 public:
  /// Makes a mesh with about element_count elements. If `shuffled` is true, vertices and faces are in a random order,
  /// which is the same in every run.
  Mesh(Elements elements, std::size_t element_count, bool shuffled);
  /// Makes a mesh of any triangles, with packed positions at both ends of the segment.
  Mesh(Topology topology, std::span<const float> from, std::span<const float> to);

  /// Returns a segment of packed positions, which refers to this mesh. The mesh must outlive the segment.
  [[nodiscard]] Segment segment() const noexcept;
  [[nodiscard]] const Topology& topology() const noexcept { return topology_; }
  [[nodiscard]] std::span<const float> from() const noexcept { return {from_.data(), from_.size()}; }
  [[nodiscard]] std::span<const float> to() const noexcept { return {to_.data(), to_.size()}; }

  [[nodiscard]] std::size_t count(Elements elements) const noexcept {
    return elements == Elements::kFaces ? topology_.face_count() : topology_.vertex_count();
  }

 private:
  Topology topology_;
  AlignedArray<float> from_, to_;  // positions of the vertices, (V, 3)
};

}  // namespace chronormal::bench

#endif  // BENCH_MEASURE_MESHES_H_
