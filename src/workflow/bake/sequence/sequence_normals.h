/// The normals of a sequence in the form of eq. 40: one for each key, and one bend for each segment. Private to
/// workflow.
///
/// A host sees the positions base + delta, where both are float32: normals are those of these positions, in double.
/// (The positions of the motion differ from them by half an ulp of the delta.)
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_NORMALS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_NORMALS_H_

#include <cstddef>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"

namespace chronormal::inline internal {

class SequenceNormals {
 public:
  /// Fits all segments where the weighting is not that of areas. Motion and groups must outlive this. Errors:
  /// kInvalidInput where a delta is too large for float32; kUsage where the fits of two neighbouring segments do not
  /// agree at their key, which a hat cannot show.
  [[nodiscard]] static Result<SequenceNormals> make(const Motion& motion, const NormalGroups& groups,
                                                    Weighting weighting);

  /// The float32 deltas of a key against key 0, as a file has them: (V, 3).
  [[nodiscard]] std::vector<float> deltas(std::size_t key) const;

  /// n of every element at a key, and d of every element in a segment. O(corners), on all cores; or a copy.
  [[nodiscard]] std::vector<Vec3d> at_key(std::size_t key) const;
  [[nodiscard]] std::vector<Vec3d> bends(std::size_t segment) const;

  [[nodiscard]] std::size_t keys() const noexcept { return motion_->keyframes.size(); }
  [[nodiscard]] std::size_t elements() const noexcept { return groups_->size(); }
  /// A bound of what the fits are off, radians: pi where nothing could be proven. One for each segment and element;
  /// empty for areas.
  [[nodiscard]] const std::vector<std::vector<double>>& bounds() const noexcept { return bounds_; }

 private:
  SequenceNormals(const Motion& motion, const NormalGroups& groups) : motion_(&motion), groups_(&groups) {}

  [[nodiscard]] Status fit(Weighting weighting);
  [[nodiscard]] std::vector<Vec3d> moved(std::size_t key) const;
  [[nodiscard]] std::vector<Vec3d> vector_areas(const std::vector<Vec3d>& positions) const;

  const Motion* motion_;
  const NormalGroups* groups_;
  std::vector<std::vector<Vec3d>> fitted_keys_, fitted_bends_;
  std::vector<std::vector<double>> bounds_;
};

/// The normals of all elements in one segment.
struct SegmentForm {
  std::vector<Vec3d> from, to, bends;

  /// The control normals of one element, from both of its keys and its bend (eq. 5).
  [[nodiscard]] ControlNormals control_normals(std::size_t element) const noexcept {
    return {from[element], 0.5 * (from[element] + to[element] - bends[element]), to[element]};
  }
};

/// Calls body(segment, form) for every segment, one after the other, until it returns an error.
template <class Body>
[[nodiscard]] Status each_segment(const SequenceNormals& normals, const Body& body) {
  SegmentForm form{{}, normals.at_key(0), {}};
  for (std::size_t s = 0; s + 1 < normals.keys(); ++s) {
    form.from.swap(form.to);
    form.to = normals.at_key(s + 1);
    form.bends = normals.bends(s);
    if (Status status = body(s, form); !status) return status;
  }
  return Success{};
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_NORMALS_H_
