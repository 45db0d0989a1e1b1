/// Computes the normals of a sequence in the form of eq. 40 of docs/theory.md: one normal for each key, and one bend
/// for each segment. Private to workflow.
///
/// A viewer renders the positions base + delta, where both are float32. Normals are computed in double from these
/// positions, which differ from the positions of the motion by half an ulp of the delta.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_NORMALS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_NORMALS_H_

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "workflow/bake/sequence/area_sums.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

class SequenceNormals {
 public:
  /// Makes the object, and reads key 0. If the weighting is not area, also reads all keyframes, to fit all segments.
  /// `stored` may have the normals of the corners at key 0, (corners, 3). Their rotation away from the geometry's
  /// normals is then applied at every instant. The stream and the groups must outlive the result. Needs the memory of
  /// key 0 and of the fits. Errors: kUsage if the fits of two neighbouring segments do not agree at their common key,
  /// because one target of a key cannot represent both; those of check_deltas(), if there are fits; those of the
  /// stream.
  [[nodiscard]] static Result<SequenceNormals> make(MotionStream& stream, const NormalGroups& groups,
                                                    Weighting weighting, VectorView<const float> stored = {});

  /// Keeps the positions of the keys from first to last in memory, until the next call. deltas(), at_key(), bends() and
  /// each_block() may only be called for keys and segments in memory. Errors: those of the stream.
  [[nodiscard]] Status hold(std::size_t first, std::size_t last) const { return stream_->hold(first, last); }

  /// Reads and checks the first `keys` keyframes. Errors: kInvalidInput if a delta is too large for float32; those of
  /// the stream.
  [[nodiscard]] Status check_deltas(std::size_t keys) const;
  /// Checks that the deltas of one key fit into float32. Errors: kInvalidInput if a delta is too large.
  [[nodiscard]] static Status check_deltas(std::size_t key, std::span<const float> deltas);

  /// Returns the positions of key 0, (V, 3).
  [[nodiscard]] const std::vector<float>& base() const noexcept { return base_; }
  /// Returns the float32 deltas from the positions at key 0 to those at a key, as a file stores them, (V, 3).
  [[nodiscard]] std::vector<float> deltas(std::size_t key) const;
  /// Writes the float32 deltas from the positions at key 0 to those at a key, (V, 3), to `result`, whose memory is
  /// reused.
  void deltas(std::size_t key, std::vector<float>& result) const;

  /// Returns true if stored normals were given that differ from the normals of the geometry.
  [[nodiscard]] bool has_offsets() const noexcept { return !turns_.empty(); }

  /// Return the normals n of all elements at a key, and the bends d of all elements in a segment. Take O(corners), on
  /// all cores. If there are fits, only copy the results.
  [[nodiscard]] std::vector<Vec3d> at_key(std::size_t key) const;
  [[nodiscard]] std::vector<Vec3d> bends(std::size_t segment) const;

  /// Memory for the points of each_block(), which is reused from one segment to the next.
  struct Rows {
    PointRows positions, displacements;
  };
  /// Calls body(elements, n, d) for blocks of elements, on all cores. n has the normals of the elements at the second
  /// key of the segment, and d has their bends in the segment.
  void each_block(std::size_t segment, Rows& rows, const AreaSums::Body& body) const;

  [[nodiscard]] std::size_t keys() const noexcept { return motion().keyframes.size(); }
  [[nodiscard]] std::size_t elements() const noexcept { return groups_->size(); }
  /// Returns bounds, in radians, of the errors of fits to a weighting, for each segment and element. A bound is pi if
  /// none could be proven. The list is empty if normals are weighted by area.
  [[nodiscard]] const std::vector<std::vector<double>>& bounds() const noexcept { return bounds_; }

 private:
  // Compute the normals and bends of the geometry, without the rotation to the stored normals.
  [[nodiscard]] std::vector<Vec3d> computed_at_key(std::size_t key) const;
  [[nodiscard]] std::vector<Vec3d> computed_bends(std::size_t segment) const;
  void each_computed_block(std::size_t segment, Rows& rows, const AreaSums::Body& body) const;
  void find_offsets(VectorView<const float> stored);
  void add_offsets(std::size_t first_element, std::span<Vec3d> vectors) const;

  SequenceNormals(MotionStream& stream, const NormalGroups& groups)
      : stream_(&stream), groups_(&groups), sums_(stream.motion().topology, groups) {}

  [[nodiscard]] const Motion& motion() const noexcept { return stream_->motion(); }
  [[nodiscard]] Status fit(Weighting weighting);
  void write_positions(std::size_t key, PointRows& rows) const;
  void write_displacements(std::size_t segment, PointRows& rows) const;
  // Return functions that compute the exact sum of areas of one element. They are called for elements whose areas
  // cancel: exact_at_key() for the points at a key, exact_bend() for the displacements in a segment.
  [[nodiscard]] AreaSums::Exact exact_at_key(std::size_t key) const;
  [[nodiscard]] AreaSums::Exact exact_bend(std::size_t segment) const;
  [[nodiscard]] std::vector<Vec3d> vector_areas(const PointRows& points, const AreaSums::Exact& exact) const;

  MotionStream* stream_;
  const NormalGroups* groups_;
  AreaSums sums_;
  std::vector<float> base_;
  std::vector<std::vector<Vec3d>> fitted_keys_, fitted_bends_;
  std::vector<ShownTurn> turns_;  // the rotation of each element; empty if no element is rotated
  std::vector<std::vector<double>> bounds_;
};

/// Returns the control normals of an element in a segment (eq. 5 of the paper). from and to are the normals of the
/// element at both keys, and bend is its bend.
[[nodiscard]] inline ControlNormals control_normals_of(const Vec3d& from, const Vec3d& to, const Vec3d& bend) noexcept {
  return {from, 0.5 * (from + to - bend), to};
}

/// The normals of all elements in one segment: at both keys, and their bends between the keys.
struct SegmentForm {
  std::vector<Vec3d> from, to, bends;

  [[nodiscard]] ControlNormals control_normals(std::size_t element) const noexcept {
    return control_normals_of(from[element], to[element], bends[element]);
  }
};

/// Calls body(segment, form) for the first `segments` segments, one after the other, until body returns an error. Has
/// the keys of one segment in memory at a time. Errors: those of body and of the stream.
template <class Body>
[[nodiscard]] Status each_segment(const SequenceNormals& normals, std::size_t segments, const Body& body) {
  SegmentForm form;
  SequenceNormals::Rows rows;
  for (std::size_t s = 0; s < segments; ++s) {
    if (Status status = normals.hold(s, s + 1); !status) return status;
    if (s == 0) form.to = normals.at_key(0);
    form.from.swap(form.to);
    form.to.resize(normals.elements());
    form.bends.resize(normals.elements());
    normals.each_block(s, rows, [&form](IndexRange elements, std::span<const Vec3d> n, std::span<const Vec3d> d) {
      std::copy(n.begin(), n.end(), form.to.begin() + static_cast<std::ptrdiff_t>(elements.first));
      std::copy(d.begin(), d.end(), form.bends.begin() + static_cast<std::ptrdiff_t>(elements.first));
    });
    if (Status status = body(s, form); !status) return status;
  }
  return Success{};
}

/// Calls body(segment, form) for all segments, one after the other, until body returns an error. Errors: those of body
/// and of the stream.
template <class Body>
[[nodiscard]] Status each_segment(const SequenceNormals& normals, const Body& body) {
  return each_segment(normals, normals.keys() - 1, body);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_NORMALS_H_
