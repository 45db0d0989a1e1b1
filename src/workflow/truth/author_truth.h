/// The normals that the author of a mesh would see, at any weights. Private to workflow.
///
/// The truth is what the authoring tool renders. The tool adds up the normals of polygons by a rule (author_rule.h),
/// and the sum at weights w is called r(w). The author may have changed the normals after that, by hand or by a
/// modifier. This change is the *offset*, which moves along with the surface (offset_frame.h). Let o_0 be the offset of
/// the base, and o_i the offset of target i at weight 1, as the file stores them. The truth at weights w has the offset
/// o(w) = o_0 + sum of w_i (o_i - o_0), limited to a right angle from the sum. The truth therefore equals the stored
/// normals of the base, and of each target at weight 1. If there is no offset, the truth equals r(w).
///
/// An azimuth is the angle around the sum at which an offset points. A key is a target at weight 1. Azimuths are
/// measured from the edge for which the offsets of an element at all keys differ least from the offset of the base. If
/// no edge can be used at every key, azimuths are measured from a direction that turns along with the sum by the
/// smallest rotation.
///
/// Unknown    If no target stores normals that tell rules apart, the motion of an offset is unknown. The truth is then
///            the sum by area, rotated as in the base, and can be computed exactly.
/// Stale      If the stored normals of a target are stale (stale_keys.h), its truth is r with the offset of the base.
/// Degenerate If r(w) is zero, the truth is zero. If r is zero at a key, the offset there is that of the base.
/// Threads    const functions may run at once
#ifndef CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_TRUTH_H_
#define CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_TRUTH_H_

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/vec3.h"
#include "core/blocks.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/truth/author_rule.h"
#include "workflow/truth/author_sums.h"
#include "workflow/truth/offset_frame.h"
#include "workflow/truth/stale_keys.h"
#include "workflow/truth/stored_keys.h"

namespace chronormal::inline internal {

class AuthorTruth {
 public:
  /// The offsets of the author's normals in one pose, one for each element that has an offset.
  using Pose = std::vector<PlaneOffset>;

  static constexpr std::uint32_t kNone = GltfShading::kNoElement;

  /// The frame in which the offsets of one element are measured.
  struct Frame {
    std::uint32_t first_edge = 0, edge_count = 0;  ///< the range in edges() of all edges around the element
    std::uint32_t edge = kNone;  ///< the index in edges() of the edge from which azimuths are measured
    double side = 1;             ///< -1 if the author shows the side opposite to r
    Vec3d base_z, base_x;        ///< directions that replace the edge, if no edge can be used
    PlaneOffset base;
  };
  /// The difference between the offset of a target at weight 1 and the offset of the base.
  struct Change {
    std::uint32_t frame = 0;
    PlaneOffset by;
  };

  /// Finds the truth from all stored normals. The shading must outlive this object and keep its deltas of normals. The
  /// groups of the shading need their corners only during this call. any_split is the result of split_by_keys().
  explicit AuthorTruth(const GltfShading& shading, bool any_split = false);
  /// Defines the truth as sums of triangles by this weighting, and uses only the stored normals of the base.
  AuthorTruth(const GltfShading& shading, Weighting weighting);

  [[nodiscard]] const AuthorRule& rule() const noexcept { return rule_; }
  /// Returns the sums of face normals. The sums are empty if is_plain() is true.
  [[nodiscard]] const AuthorSums& sums() const noexcept { return sums_; }
  /// Returns true if the truth is n(w), the area-weighted sum of the face normals at weights w, with the offset of the
  /// base unchanged. Such a truth can be computed exactly.
  [[nodiscard]] bool is_plain() const noexcept { return rule_.is_plain() && frames_.empty(); }
  /// Returns true if the stored normals of targets influence the truth, so that it differs from area weighting. A bake
  /// that keeps such a truth notes this in its mark.
  [[nodiscard]] bool follows_keys() const noexcept { return !is_plain() || any_split_; }
  [[nodiscard]] std::span<const StaleKey> stale() const noexcept { return stale_; }
  /// Returns the number of elements that have an offset.
  [[nodiscard]] std::size_t offset_count() const noexcept { return frames_.size(); }
  /// Return the frames, the index of each element's frame in frames(), and the edges around the elements that have
  /// frames. The index is kNone for an element without a frame. If no element has a frame, the list of indices is
  /// empty.
  [[nodiscard]] std::span<const Frame> frames() const noexcept { return frames_; }
  [[nodiscard]] std::span<const std::uint32_t> frame_of_element() const noexcept { return frame_of_element_; }
  [[nodiscard]] std::span<const OffsetEdge> edges() const noexcept { return edges_; }
  /// Returns for each target the changes that it makes to offsets, in the order of frames. The lists are empty if no
  /// element has an offset.
  [[nodiscard]] std::span<const std::vector<Change>> changes() const noexcept { return changes_; }

  /// Return the offsets at the given weights of all targets, or at the given weight of one target if all others have
  /// weight 0.
  [[nodiscard]] Pose pose(std::span<const double> weights) const;
  [[nodiscard]] Pose pose_alone(std::size_t target, double weight) const;

  /// Returns the true normal of an element in a pose. Its length is the length of r(w), the sum of face normals.
  /// position(vertex) must return the position of a vertex.
  template <class PositionOf>
  [[nodiscard]] AuthorSum at(std::uint32_t element, const PositionOf& position, const Pose& pose) const {
    return turned_sum(element, sums_.at(element, position), position, pose);
  }
  /// Turns the sum r(w) of an element by the author's offset in a pose. Keeps the length of the sum.
  template <class PositionOf>
  [[nodiscard]] Vec3d with_offset(std::uint32_t element, const Vec3d& sum, const PositionOf& position,
                                  const Pose& pose) const {
    const std::uint32_t n = frame_of_element_.empty() ? kNone : frame_of_element_[element];
    if (n == kNone || sum == Vec3d{}) return sum;
    const double size = length(sum);
    const Vec3d z = (frames_[n].side / size) * sum;
    const Frame& frame = frames_[n];
    const Vec3d x = frame.edge == kNone ? turned_with(frame, z) : zero_azimuth(edges_[frame.edge], z, position);
    return size * internal::with_offset(pose[n], z, x, mean_edge_angle(edges_of(frame), z, position));
  }
  /// Call visit(i, truth) for the i-th of the given elements, or visit(element, truth) for all elements. `truth` is the
  /// true normal. The calls run on all cores, in any order.
  template <class PositionOf, class Visit>
  void for_each(std::span<const std::uint32_t> elements, const PositionOf& position, const Pose& pose,
                const Visit& visit) const {
    parallel_blocks(elements.size(), kElementsOfBlock, [&](IndexRange range) {
      const std::span<const std::uint32_t> block = elements.subspan(range.first, range.count);
      sums_.for_each(block, position, [&](std::size_t i, const AuthorSum& sum) {
        visit(range.first + i, turned_sum(block[i], sum, position, pose));
      });
    });
  }
  template <class PositionOf, class Visit>
  void for_all(const PositionOf& position, const Pose& pose, const Visit& visit) const {
    sums_.for_all(position,
                  [&](std::uint32_t e, const AuthorSum& sum) { visit(e, turned_sum(e, sum, position, pose)); });
  }

  /// Lists the elements whose true normal a target turns, in ascending order. The list is empty for targets that are
  /// not in the author's mesh.
  [[nodiscard]] std::vector<std::uint32_t> elements_of(std::size_t target) const;

 private:
  class Finder;

  template <class PositionOf>
  [[nodiscard]] AuthorSum turned_sum(std::uint32_t element, AuthorSum sum, const PositionOf& position,
                                     const Pose& pose) const {
    sum.normal = with_offset(element, sum.normal, position, pose);
    return sum;
  }
  [[nodiscard]] std::span<const OffsetEdge> edges_of(const Frame& frame) const noexcept {
    return std::span(edges_).subspan(frame.first_edge, frame.edge_count);
  }
  [[nodiscard]] static Vec3d turned_with(const Frame& frame, const Vec3d& z);

  const GltfShading* shading_;
  AuthorRule rule_;
  AuthorSums sums_;
  std::vector<OffsetEdge> edges_;
  std::vector<Frame> frames_;
  std::vector<std::uint32_t> frame_of_element_;  // empty if no element has an offset
  std::vector<std::vector<Change>> changes_;     // for each target, its changes in the order of frames
  std::vector<StaleKey> stale_;
  bool any_split_ = false;
};

/// Returns the true normals of a mesh. If a weighting is requested, the truth consists of sums by this weighting.
/// Otherwise the truth is found from the stored normals, and vertices at one point whose normals differ in a target
/// become separate elements. The shading must satisfy the preconditions of the constructor of AuthorTruth.
[[nodiscard]] AuthorTruth author_truth(GltfShading& shading, std::optional<Weighting> asked);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_TRUTH_H_
