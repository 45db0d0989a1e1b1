/// Computes base normals and deltas of the elements of a sequence. Everything here is a function of the normals of the
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

/// Examines all segments, whose deltas must have been checked. Errors: from reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> sequence_elements(const SequenceNormals& normals);
/// Examines the first segment alone; for almost every sequence the result is the same. Errors: kInvalidInput if a delta
/// is too large for float32; errors from reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> elements_of_start(const SequenceNormals& normals);

/// The targets of one segment for the encoding exact, as float32 vectors one after the other.
struct ExactSegment {
  std::vector<float> positions;  ///< deltas of positions, from key 0 to the second key
  std::vector<float> start;      ///< of elements: what key 0 adds to N, in segment 0 only
  std::vector<float> key;        ///< what the second key adds to N
  std::vector<float> bend;       ///< what the segment adds to the hats of its keys
  bool bends = false;            ///< any normal bends; otherwise `bend` is not valid
};

/// Calls body(segment, values) for every segment, one after the other, until it returns an error. Holds the keys of one
/// segment at a time. If the elements are not final, this returns false as soon as a segment shows that
/// sequence_elements() would return others. Errors: kInvalidInput if a delta is too large for float32; errors of body,
/// and of the stream.
[[nodiscard]] Result<bool> each_exact_segment(
    const SequenceNormals& normals, std::span<const SequenceElement> elements, bool are_final,
    const std::function<Status(std::size_t segment, const ExactSegment& values)>& body);

/// The deltas that a key adds to N for the encoding endpoint, so that errors in the segment before it are smallest; and
/// the largest remaining angle in that segment, in radians. `before` are the deltas of the key before. `bounds`, of the
/// fits, are added to the angles, and may be empty.
struct EndDeltas {
  std::vector<Vec3d> deltas;
  double error = 0;
};
[[nodiscard]] EndDeltas end_deltas(std::span<const SequenceElement> elements, const SegmentForm& form,
                                   std::span<const double> bounds, const std::vector<Vec3d>& before);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
