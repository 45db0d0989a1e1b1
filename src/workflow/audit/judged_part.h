/// The part of a mesh that an audit looks at, and its true normals. Private to workflow.
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

/// The number of elements or outputs that one task of a thread handles.
inline constexpr std::size_t kRange = 4096;

/// The limit below which a sum of vectors counts as zero, relative to the sum of the sizes (largest components) of its
/// vectors. A shorter sum consists only of rounding errors and has no direction.
inline constexpr double kRoundingOfTerms = 1e-13;

/// Returns a bound of the change of a polygon's normal if the coordinates of its corners are rounded to float32.
/// Rounding changes a coordinate by at most 2^-24 of its value. If the change of the position p[c] is d[c], the change
/// of the normal is the sum over the corners c of d[c] x (p[c+1] - p[c-1]).
template <class VertexAt>
[[nodiscard]] double rounding_of_area(std::size_t corners, const VertexAt& vertex) {
  // The length by which rounding changes a vector at most, relative to its largest coordinate.
  constexpr double kOfVector = 1.7320508075688772 / (1 << 24);
  double sum = 0;
  for (std::size_t c = 0; c < corners; ++c) {
    const Vec3d chord = vertex((c + 1) % corners) - vertex((c + corners - 1) % corners);
    sum += kOfVector * max_abs(vertex(c)) * length(chord);
  }
  return sum;
}

/// A normal that is judged. It belongs to a vertex or, if the vertex has several normals, to a corner that shows one of
/// these normals.
struct JudgedOutput {
  std::uint32_t vertex = 0, element = 0;
  std::uint32_t face = 0, corner = 0;  ///< the face and the corner that show the normal; not set by all callers
};

struct PartNormals {
  std::vector<Vec3d> faces, elements;
  std::vector<double> sizes;  ///< for each element, the sum of the largest components of its normal's terms
};

/// The part of a mesh that determines some of the judged normals (the outputs). It has the elements of the outputs
/// (groups of corners that share a normal), and the faces and vertices around these elements.
class JudgedPart {
 public:
  /// Creates the part. Elements and faces of the outputs are renumbered for this part, but vertices and corners keep
  /// their numbers in the mesh. If needs_faces is false, normals() may leave out the normals of faces. If the weighting
  /// is area, `groups` need no corners. If `sums` is not nullptr, the normals of elements come from `sums`, which must
  /// outlive the part.
  JudgedPart(const Topology& topology, const NormalGroups& groups, Weighting weighting,
             std::vector<JudgedOutput> outputs, bool needs_faces = true, const AuthorSums* sums = nullptr);

  /// Return the vertices and the elements of the part, as indices in the mesh, in ascending order.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const std::uint32_t> elements() const noexcept { return elements_; }
  [[nodiscard]] std::span<const JudgedOutput> outputs() const noexcept { return outputs_; }

  /// Returns the faces of an element. Elements and faces are numbered within the part. corners_of() returns the corners
  /// of a face as indices in vertices().
  [[nodiscard]] std::span<const std::uint32_t> faces_of(std::size_t element) const noexcept {
    return std::span(faces_of_element_)
        .subspan(element_offsets_[element], element_offsets_[element + 1] - element_offsets_[element]);
  }
  [[nodiscard]] std::span<const std::uint32_t> corners_of(std::size_t face) const noexcept {
    return std::span(face_vertices_).subspan(face_offsets_[face], face_offsets_[face + 1] - face_offsets_[face]);
  }
  /// Returns the edges as pairs of vertices of the mesh. The list contains every edge between two vertices with
  /// outputs, and may contain other edges. output_of() returns the output of a vertex, or an index beyond all outputs
  /// if the vertex has no output.
  [[nodiscard]] std::span<const std::array<std::uint32_t, 2>> edges() const noexcept {
    return own_edges_.empty() ? edges_ : own_edges_;
  }
  [[nodiscard]] std::uint32_t output_of(std::uint32_t vertex) const noexcept { return output_of_[vertex]; }
  /// Returns the number of vertices of the whole mesh, whose vertex numbers edges() uses.
  [[nodiscard]] std::size_t vertices_of_edges() const noexcept { return output_of_.size(); }
  /// Sets the edges of the whole mesh, which has vertex_count vertices. The edges must outlive the part. Every vertex
  /// must have at most one output.
  void set_edges(std::span<const std::array<std::uint32_t, 2>> edges, std::size_t vertex_count);
  [[nodiscard]] std::size_t face_count() const noexcept { return face_offsets_.size() - 1; }
  /// Returns the index that a vertex of the mesh has in vertices(). May be called only for parts that were created with
  /// `sums`, and for vertices that these sums need.
  [[nodiscard]] std::uint32_t place_of(std::uint32_t vertex) const noexcept { return places_[vertex]; }

  /// Computes the normals of faces and elements from the positions of vertices(). The normal of a face is a cross
  /// product. The normal of an element is the sum that `sums` gives, if the part was created with `sums`, and otherwise
  /// the weighted sum of face normals (normals/weighting.h). Such a weighted sum becomes zero if it consists only of
  /// rounding errors of its terms (kRoundingOfTerms).
  void normals(std::span<const Vec3d> positions, PartNormals& result) const;

  /// Returns a bound of the change of an element's normal if these positions are rounded to float32. Treats the weights
  /// of its faces as constant.
  [[nodiscard]] double rounding_of(std::span<const Vec3d> positions, std::size_t element) const;

 private:
  void given_normals(std::span<const Vec3d> positions, PartNormals& result) const;
  void weighted_normals(std::span<const Vec3d> positions, PartNormals& result) const;
  [[nodiscard]] Vec3d face_normal(std::span<const Vec3d> positions, std::size_t face) const;
  // Returns the term that a corner of a face adds to the normal of its element.
  [[nodiscard]] Vec3d term(std::span<const Vec3d> positions, std::size_t face, std::size_t corner,
                           const Vec3d& normal) const;

  std::vector<std::uint32_t> vertices_, elements_;
  std::vector<std::uint32_t> face_offsets_ = {0}, face_vertices_;  // the corners of each face, as indices in vertices_
  // The faces around each element. Elements and faces are numbered within the part.
  std::vector<std::uint32_t> element_offsets_ = {0}, faces_of_element_;
  // For each face around an element, the corner of this face that belongs to the element: 0 is the first corner of the
  // face. The list is empty if faces are weighted by area.
  std::vector<std::uint32_t> corners_of_element_;
  Weighting weighting_;
  const AuthorSums* sums_;
  std::vector<std::uint32_t> places_;  // for each vertex of the mesh, its index in vertices_
  bool keeps_faces_;                   // if false, each element computes the normals of its faces again
  std::vector<JudgedOutput> outputs_;
  std::span<const std::array<std::uint32_t, 2>> edges_;
  std::vector<std::array<std::uint32_t, 2>> own_edges_;  // the edges at vertices with outputs; set if the part is small
  std::vector<std::uint32_t> output_of_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_JUDGED_PART_H_
