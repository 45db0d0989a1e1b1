/// The normals that the author of a mesh would see, at any weights. Private to workflow.
///
/// Right is what the authoring tool shows. It adds up the normals of polygons by a rule (author_rule.h), r(w), and the
/// author may have added something to that: normals bent by hand, or made by a modifier. What was added, the *offset*,
/// is carried by the surface (offset_frame.h). Let o_0 be that of the base, and o_i that of target i at weight 1, as
/// the file stores them. The truth at weights w has the offset o(w) = o_0 + sum of w_i (o_i - o_0), at most a right
/// angle from the sum. So it passes through all that is stored, and is r(w) where nothing was added. Azimuths are
/// measured from the edge with which the offsets of an element differ least; where no edge will do at every key, from a
/// direction that is turned along with the sum by the smallest rotation.
///
/// Unknown    Where no target stores normals that tell, nobody knows how an offset moves: its rotation in the base
///            stays as it is, so that by area the truth is exact.
/// Stale      Where the stored normals of a target tell nothing (stale_keys.h), r counts, with the offset of the base.
/// Degenerate Where r(w) is zero the truth is zero. Where it is zero at a key, the offset there is that of the base.
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
  /// The offsets of a pose, of all elements that have any.
  using Pose = std::vector<PlaneOffset>;

  static constexpr std::uint32_t kNone = GltfShading::kNoElement;

  /// The frame in which the offsets of one element are placed.
  struct Frame {
    std::uint32_t first_edge = 0, edge_count = 0;  ///< all edges around it, in edges()
    std::uint32_t edge = kNone;                    ///< the one from which azimuths are measured, in edges()
    double side = 1;                               ///< -1 where the author shows the other side of r
    Vec3d base_z, base_x;                          ///< in place of the edge, if there is none
    PlaneOffset base;
  };
  /// The difference between the offset of a target at weight 1 and that of the base.
  struct Change {
    std::uint32_t frame = 0;
    PlaneOffset by;
  };

  /// Finds what the author would see. The shading must outlive this, and have its deltas of normals; its groups need
  /// their corners for this alone. any_split says whether split_by_keys() made elements of it.
  explicit AuthorTruth(const GltfShading& shading, bool any_split = false);
  /// The sums of triangles by a weighting, and nothing that the file stores but the base normals.
  AuthorTruth(const GltfShading& shading, Weighting weighting);

  [[nodiscard]] const AuthorRule& rule() const noexcept { return rule_; }
  /// Empty where the truth is plain.
  [[nodiscard]] const AuthorSums& sums() const noexcept { return sums_; }
  /// Returns whether the truth is n(w), by area, with what is added to the base turned along as it is, so that it can
  /// be exact.
  [[nodiscard]] bool is_plain() const noexcept { return rule_.is_plain() && frames_.empty(); }
  /// Returns whether the normals that targets store have a part in the truth, beyond what area weighs: a bake that
  /// keeps them says so in its mark.
  [[nodiscard]] bool follows_keys() const noexcept { return !is_plain() || any_split_; }
  [[nodiscard]] std::span<const StaleKey> stale() const noexcept { return stale_; }
  /// Returns the number of elements that have an offset.
  [[nodiscard]] std::size_t offset_count() const noexcept { return frames_.size(); }
  /// Their frames; which of these an element has, or kNone, of all elements if any has one; and the edges around them.
  [[nodiscard]] std::span<const Frame> frames() const noexcept { return frames_; }
  [[nodiscard]] std::span<const std::uint32_t> frame_of_element() const noexcept { return frame_of_element_; }
  [[nodiscard]] std::span<const OffsetEdge> edges() const noexcept { return edges_; }
  /// The changes of each target, by frames; of none where no element has an offset.
  [[nodiscard]] std::span<const std::vector<Change>> changes() const noexcept { return changes_; }

  /// The offsets at the weights of all targets, and those of one target alone.
  [[nodiscard]] Pose pose(std::span<const double> weights) const;
  [[nodiscard]] Pose pose_alone(std::size_t target, double weight) const;

  /// The truth of an element, in a pose with the positions that position(vertex) gives, as long as r(w).
  template <class PositionOf>
  [[nodiscard]] AuthorSum at(std::uint32_t element, const PositionOf& position, const Pose& pose) const {
    return turned_sum(element, sums_.at(element, position), position, pose);
  }
  /// Adds to r(w) of an element what the author added, and leaves its length as it is.
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
  /// Calls visit(i, truth) for the i-th of some elements, or visit(element, truth) for all, on all cores.
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

  /// The elements of which a target turns the truth, ascending; none for targets that the author's mesh does not have.
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
  std::vector<std::uint32_t> frame_of_element_;  // or empty, where no element has an offset
  std::vector<std::vector<Change>> changes_;     // of each target, by frames
  std::vector<StaleKey> stale_;
  bool any_split_ = false;
};

/// Finds what the author of a mesh would see, or sums by a weighting where one is asked for. Copies of a point that a
/// key tells apart become elements of their own, unless one is. The shading must be as the first constructor needs it.
[[nodiscard]] AuthorTruth author_truth(GltfShading& shading, std::optional<Weighting> asked);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_TRUTH_H_
