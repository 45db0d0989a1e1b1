/// A primitive of a motion that a skin moves. Computes where joints move the vertices, and into how many straight
/// pieces the curved paths of the vertices must be cut. Private to io.
///
/// A vertex is at the sum of w_j M_j p, for the joint matrices M_j = W_j B_j (io/gltf/gltf_skin.h), its shares w_j, and
/// its position p before the skin, which morph targets move. The skin moves an edge from p to q, with shares v_j and
/// w_j, to the sum of
///
///     L_j y_j + o_j c_j        y_j = w_j B_j q - v_j B_j p,  c_j = w_j - v_j,  W_j = (L_j | o_j)
///
/// The second derivative is at most the sum of |L''| |y| + 2 |L'| |y'| + |L| |y''| + |c| |o''|. All c_j add up to 0, so
/// o'' may be counted from the bone at which the paths of all these joints meet. y is a small vector, so that a small
/// face far from a joint needs no more pieces than a large one.
#ifndef CHRONORMAL_IO_GLTF_GLTF_SKINNED_PART_H_
#define CHRONORMAL_IO_GLTF_GLTF_SKINNED_PART_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "io/gltf/gltf_skin.h"

namespace chronormal::inline internal {

class GltfSkinnedPart {
 public:
  /// Reads the shares of the vertices of a part. Errors: those of GltfSkin::read_shares().
  [[nodiscard]] static Result<GltfSkinnedPart> read(const GltfDocument& document, const GltfPart& part,
                                                    std::shared_ptr<const GltfSkin> skin);

  [[nodiscard]] const GltfSkin& skin() const noexcept { return *skin_; }
  [[nodiscard]] std::span<const JointShare> shares(std::size_t vertex) const noexcept {
    return std::span(shares_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

  /// Returns the position to which the skin moves a vertex of the part. `pose` has the joint matrices, and `before` is
  /// the position before the skin moves the vertex.
  [[nodiscard]] Vec3d place(std::span<const AffineTransform> pose, std::size_t vertex,
                            const Vec3d& before) const noexcept;

 private:
  std::shared_ptr<const GltfSkin> skin_;
  std::vector<std::size_t> first_;  // for each vertex the index of its first share, (V + 1)
  std::vector<JointShare> shares_;
};

/// The positions that the vertices of a part have before its skin moves them, over an interval of time in which no
/// curve has a key.
struct GltfUnskinned {
  double from = 0, to = 1;
  /// Writes the positions of some vertices of the part at a time.
  std::function<void(std::span<const std::uint32_t> vertices, double time, bool just_before, std::span<Vec3d> all)> at;
  /// A bound of the acceleration |p''| of each vertex before the skin moves the vertex; empty if all bounds are 0.
  std::vector<double> bend;
};

/// The bounds that decide, for an interval and the faces of a part, if a number of pieces is sufficient (pieces_for()
/// in motion/piece_bounds.h).
class GltfSkinPieces {
 public:
  /// Computes bounds for the triangles of the part. `sine` is the sine of the largest allowed angle between a normal on
  /// the pieces and the normal on the curves.
  GltfSkinPieces(const GltfSkinnedPart& part, const Topology& topology, const GltfPart& range, GltfUnskinned before,
                 double sine);

  /// Returns those of `faces` that belong to the part and for which `pieces` pieces are not enough, in their order.
  /// `faces` must ascend; nullptr stands for all faces of the topology.
  [[nodiscard]] std::vector<std::uint32_t> not_within(const std::vector<std::uint32_t>* faces,
                                                      std::size_t pieces) const;

 private:
  [[nodiscard]] std::vector<std::uint32_t> vertices_of(std::span<const std::uint32_t> faces) const;
  [[nodiscard]] double bend_of_edge(std::span<const BoneBounds> bones, std::span<const Vec3d> from,
                                    std::span<const Vec3d> to, std::uint32_t p, std::uint32_t q) const;
  // Returns the index within the part of the vertex at corner c of a face.
  [[nodiscard]] std::uint32_t vertex(std::uint32_t face, std::size_t c) const noexcept {
    return topology_.face(face)[c] - static_cast<std::uint32_t>(range_.first_vertex);
  }

  const GltfSkinnedPart& part_;
  const Topology& topology_;
  GltfPart range_;
  GltfUnskinned before_;
  double sine_;
  std::vector<double> bends_;  // bounds of |e''| for both edges from the first corner of each face of the part
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLTF_SKINNED_PART_H_
