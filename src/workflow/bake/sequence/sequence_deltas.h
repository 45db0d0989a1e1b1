/// Computes base normals and deltas of the elements of a sequence. Everything here depends only on the normals of the
/// sequence; sequence_file.h writes the results to a file. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "workflow/bake/sequence/sequence_normals.h"

namespace chronormal::inline internal {

/// The normal that a file shows if an element has none.
inline constexpr Vec3d kAnyNormal{0, 0, 1};

/// The data of one element that depend on the whole sequence.
struct SequenceElement {
  Vec3d normal;             ///< N: unit, float32
  double scale = 1;         ///< the divisor of its normals
  bool frees_base = false;  ///< N is not its normal at key 0, which then needs a target
  bool has_none = true;     ///< it has no area in the whole sequence
};

/// Examines all segments to find the elements. The deltas must have been checked. Errors: from reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> sequence_elements(const SequenceNormals& normals);
/// Finds the elements from the first segment alone; for almost every sequence the result is the same. Errors:
/// kInvalidInput if a delta is too large for float32; errors from reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> elements_of_start(const SequenceNormals& normals);

/// The targets of one segment for the encoding exact, as float32 vectors one after the other.
struct ExactSegment {
  std::vector<float> positions;  ///< deltas of positions, from key 0 to the second key
  std::vector<float> start;      ///< of elements: what key 0 adds to N, in segment 0 only
  std::vector<float> key;        ///< what the second key adds to N
  std::vector<float> bend;       ///< what the segment adds to the hats of its keys
  bool bends = false;            ///< any normal bends; otherwise `bend` is not valid
};

/// Calls body(segment, values) for every segment in order, until it returns an error. Holds the keys of one segment at
/// a time. If the elements are not final, returns false as soon as a segment shows that sequence_elements() would
/// return different ones. Errors: kInvalidInput if a delta is too large for float32; errors of body, and of the stream.
[[nodiscard]] Result<bool> each_exact_segment(
    const SequenceNormals& normals, std::span<const SequenceElement> elements, bool are_final,
    const std::function<Status(std::size_t segment, const ExactSegment& values)>& body);

/// The deltas of a key for the encoding endpoint, with which the errors in the segment before the key are smallest, and
/// the largest angle that remains in that segment, in radians. `before` are the deltas of the previous key. `bounds`
/// has the error bounds of fits, which are added to the angles; it may be empty.
struct EndDeltas {
  std::vector<Vec3d> deltas;
  double error = 0;
};
[[nodiscard]] EndDeltas end_deltas(std::span<const SequenceElement> elements, const SegmentForm& form,
                                   std::span<const double> bounds, const std::vector<Vec3d>& before);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
