/// The part of a mesh that an audit looks at, and its right normals. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_JUDGED_PART_H_
#define CHRONORMAL_WORKFLOW_AUDIT_JUDGED_PART_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "workflow/truth/author_sums.h"

namespace chronormal::inline internal {

/// What one task takes.
inline constexpr std::size_t kRange = 4096;

/// Where terms cancel, a sum below this share of their size is nothing but rounding, and has no direction.
inline constexpr double kRoundingOfTerms = 1e-13;

/// By how much the normal of a polygon may change, at most, where each coordinate of its corners is rounded to float32,
/// which changes it by 2^-24 of itself: d n is the sum over the corners of d p[c] x (p[c+1] - p[c-1]).
template <class VertexAt>
[[nodiscard]] double rounding_of_area(std::size_t corners, const VertexAt& vertex) {
  constexpr double kOfVector = 1.7320508075688772 / (1 << 24);  // of the largest of three coordinates
  double sum = 0;
  for (std::size_t c = 0; c < corners; ++c) {
    const Vec3d chord = vertex((c + 1) % corners) - vertex((c + corners - 1) % corners);
    sum += kOfVector * max_abs(vertex(c)) * length(chord);
  }
  return sum;
}

/// Something that shows a normal: a vertex, or a corner where a vertex has several normals.
struct JudgedOutput {
  std::uint32_t vertex = 0, element = 0;
  std::uint32_t face = 0, corner = 0;  ///< where a rule looks at them
};

struct PartNormals {
  std::vector<Vec3d> faces, elements;
  std::vector<double> sizes;  ///< of each element, the largest components of the terms of its normal, added up
};

/// The elements of some outputs, and the faces and vertices that these need, numbered anew.
class JudgedPart {
 public:
  /// Elements and faces of the outputs become those of this part; their vertices and corners stay those of the mesh.
  /// Without needs_faces, normals() may leave out those of faces. groups need no corners where the weighting is area.
  /// Where there are sums, the normals of elements are those, and the sums must outlive this.
  JudgedPart(const Topology& topology, const NormalGroups& groups, Weighting weighting,
             std::vector<JudgedOutput> outputs, bool needs_faces = true, const AuthorSums* sums = nullptr);

  /// Its vertices and its elements, as the mesh numbers them, ascending.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const std::uint32_t> elements() const noexcept { return elements_; }
  [[nodiscard]] std::span<const JudgedOutput> outputs() const noexcept { return outputs_; }

  /// The faces of an element, and the corners of a face, numbered as in vertices().
  [[nodiscard]] std::span<const std::uint32_t> faces_of(std::size_t element) const noexcept {
    return std::span(faces_of_element_)
        .subspan(element_offsets_[element], element_offsets_[element + 1] - element_offsets_[element]);
  }
  [[nodiscard]] std::span<const std::uint32_t> corners_of(std::size_t face) const noexcept {
    return std::span(face_vertices_).subspan(face_offsets_[face], face_offsets_[face + 1] - face_offsets_[face]);
  }
  /// Pairs of neighbours, as vertices of the mesh, among them all that have an output; and which output a vertex has, or
  /// one behind all of them.
  [[nodiscard]] std::span<const std::array<std::uint32_t, 2>> edges() const noexcept {
    return own_edges_.empty() ? edges_ : own_edges_;
  }
  [[nodiscard]] std::uint32_t output_of(std::uint32_t vertex) const noexcept { return output_of_[vertex]; }
  /// How many vertices the mesh of these edges has.
  [[nodiscard]] std::size_t vertices_of_edges() const noexcept { return output_of_.size(); }
  /// Takes the edges of a mesh of so many vertices, which must outlive this. Every vertex must have one output at most.
  void set_edges(std::span<const std::array<std::uint32_t, 2>> edges, std::size_t vertex_count);
  [[nodiscard]] std::size_t face_count() const noexcept { return face_offsets_.size() - 1; }
  /// Where a vertex of the mesh is in vertices(); of parts with sums, and vertices that they need.
  [[nodiscard]] std::uint32_t place_of(std::uint32_t vertex) const noexcept { return places_[vertex]; }

  /// Computes the normals of its faces and elements from positions of vertices(): cross products, and for elements
  /// their weighted sums (normals/weighting.h) or the given ones, without a look at what is rounding.
  void normals(std::span<const Vec3d> positions, PartNormals& result) const;

  /// By how much the normal of an element may change, at most, where each of these positions is rounded to float32. The
  /// weights of its faces count as if they stayed the same.
  [[nodiscard]] double rounding_of(std::span<const Vec3d> positions, std::size_t element) const;

 private:
  void given_normals(std::span<const Vec3d> positions, PartNormals& result) const;
  void weighted_normals(std::span<const Vec3d> positions, PartNormals& result) const;
  [[nodiscard]] Vec3d face_normal(std::span<const Vec3d> positions, std::size_t face) const;
  // What a corner of a face adds to the normal of its element.
  [[nodiscard]] Vec3d term(std::span<const Vec3d> positions, std::size_t face, std::size_t corner,
                           const Vec3d& normal) const;

  std::vector<std::uint32_t> vertices_, elements_;
  std::vector<std::uint32_t> face_offsets_ = {0}, face_vertices_;        // of this part
  std::vector<std::uint32_t> element_offsets_ = {0}, faces_of_element_;  // of this part
  std::vector<std::uint32_t> corners_of_element_;  // 0, 1, 2 ... within these faces; empty where faces count by area
  Weighting weighting_;
  const AuthorSums* sums_;
  std::vector<std::uint32_t> places_;  // of the vertices of the mesh, in vertices_
  bool keeps_faces_;  // or each element computes the normals of its faces: no memory, and little time for small ones
  std::vector<JudgedOutput> outputs_;
  std::span<const std::array<std::uint32_t, 2>> edges_;
  std::vector<std::array<std::uint32_t, 2>> own_edges_;  // those of a small part
  std::vector<std::uint32_t> output_of_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_JUDGED_PART_H_
