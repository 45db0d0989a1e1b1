/// Computes base normals and deltas of the elements of a sequence. The results depend only on the normals of the
/// sequence. sequence_file.h writes these results to a file. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "workflow/bake/sequence/sequence_normals.h"

namespace chronormal::inline internal {

/// The normal that a file shows for an element without a normal.
inline constexpr Vec3d kAnyNormal{0, 0, 1};

/// The data of one element that are the same for all keys, because they follow from the whole sequence.
struct SequenceElement {
  Vec3d normal;             ///< N, the base normal: a unit vector in float32
  double scale = 1;         ///< the number by which the element's normals are divided
  bool frees_base = false;  ///< if true, N is not the element's normal at key 0, so key 0 needs a target
  bool has_none = true;     ///< true if the element has no normal at any time of the sequence
};

/// Examines all segments to find the base normals and scales of elements. check_deltas() must have been called. Errors:
/// those of reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> sequence_elements(const SequenceNormals& normals);
/// Finds the base normals and scales of elements from the first segment alone. In almost every sequence the result is
/// that of sequence_elements(). Errors: kInvalidInput if a delta is too large for float32; those of reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> elements_of_start(const SequenceNormals& normals);

/// The deltas of the targets of one segment, for the encoding exact. Vectors are in float32, three numbers each.
struct ExactSegment {
  std::vector<float> positions;  ///< deltas of the positions of vertices, from key 0 to the second key
  std::vector<float> start;      ///< for each element, what key 0 adds to N; only in segment 0
  std::vector<float> key;        ///< for each element, what the second key adds to N
  std::vector<float> bend;       ///< for each element, the bend: what the segment adds to the targets of its keys
  bool bends = false;            ///< true if any normal bends; otherwise `bend` is not valid
};

/// Calls body(segment, values) for every segment in order, until body returns an error. Has the keys of one segment in
/// memory at a time. If are_final is false, the elements may be those of the first segment alone. The function then
/// returns false as soon as a segment shows that sequence_elements() would return different elements. Errors:
/// kInvalidInput if a delta is too large for float32; those of body and of the stream.
[[nodiscard]] Result<bool> each_exact_segment(
    const SequenceNormals& normals, std::span<const SequenceElement> elements, bool are_final,
    const std::function<Status(std::size_t segment, const ExactSegment& values)>& body);

/// The deltas of a key for the encoding endpoint. They make the errors in the segment before the key as small as
/// possible. `error` is the largest angle that is left in this segment, in radians. end_deltas() computes the deltas
/// from `before`, the deltas of the key before. `bounds` has the error bounds of fits, which are added to the angles,
/// and may be empty.
struct EndDeltas {
  std::vector<Vec3d> deltas;
  double error = 0;
};
[[nodiscard]] EndDeltas end_deltas(std::span<const SequenceElement> elements, const SegmentForm& form,
                                   std::span<const double> bounds, const std::vector<Vec3d>& before);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
