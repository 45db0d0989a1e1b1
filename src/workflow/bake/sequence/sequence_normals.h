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
#include "chronormal/motion/motion_stream.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"

namespace chronormal::inline internal {

class SequenceNormals {
 public:
  /// Reads all keyframes once, and fits all segments where the weighting is not that of areas. Stream and groups must
  /// outlive this. Errors: kInvalidInput where a delta is too large for float32; kUsage where the fits of two
  /// neighbouring segments do not agree at their key, which a hat cannot show; those of the stream. Memory: that of key
  /// 0, and of the fits.
  [[nodiscard]] static Result<SequenceNormals> make(MotionStream& stream, const NormalGroups& groups,
                                                    Weighting weighting);

  /// Holds the positions of keys first to last, until the next hold. The functions below are about keys and segments
  /// that are held. Errors: those of the stream.
  [[nodiscard]] Status hold(std::size_t first, std::size_t last) const { return stream_->hold(first, last); }

  /// The positions of key 0: (V, 3).
  [[nodiscard]] const std::vector<float>& base() const noexcept { return base_; }
  /// The float32 deltas of a key against key 0, as a file has them: (V, 3).
  [[nodiscard]] std::vector<float> deltas(std::size_t key) const;

  /// n of every element at a key, and d of every element in a segment. O(corners), on all cores; or a copy.
  [[nodiscard]] std::vector<Vec3d> at_key(std::size_t key) const;
  [[nodiscard]] std::vector<Vec3d> bends(std::size_t segment) const;

  [[nodiscard]] std::size_t keys() const noexcept { return motion().keyframes.size(); }
  [[nodiscard]] std::size_t elements() const noexcept { return groups_->size(); }
  /// A bound of what the fits are off, radians: pi where nothing could be proven. One for each segment and element;
  /// empty for areas.
  [[nodiscard]] const std::vector<std::vector<double>>& bounds() const noexcept { return bounds_; }

 private:
  SequenceNormals(MotionStream& stream, const NormalGroups& groups) : stream_(&stream), groups_(&groups) {}

  [[nodiscard]] const Motion& motion() const noexcept { return stream_->motion(); }
  [[nodiscard]] Status fit(Weighting weighting);
  [[nodiscard]] std::vector<Vec3d> moved(std::size_t key) const;
  [[nodiscard]] std::vector<Vec3d> vector_areas(const std::vector<Vec3d>& positions) const;

  MotionStream* stream_;
  const NormalGroups* groups_;
  std::vector<float> base_;
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

/// Calls body(segment, form) for every segment, one after the other, until it returns an error. Holds the keys of one
/// segment at a time. Errors: those of body, and of the stream.
template <class Body>
[[nodiscard]] Status each_segment(const SequenceNormals& normals, const Body& body) {
  SegmentForm form;
  for (std::size_t s = 0; s + 1 < normals.keys(); ++s) {
    if (Status status = normals.hold(s, s + 1); !status) return status;
    if (s == 0) form.to = normals.at_key(0);
    form.from.swap(form.to);
    form.to = normals.at_key(s + 1);
    form.bends = normals.bends(s);
    if (Status status = body(s, form); !status) return status;
  }
  return Success{};
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_NORMALS_H_
