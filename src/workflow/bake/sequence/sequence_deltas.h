/// The numbers of a baked sequence: base normals and deltas of its elements. Everything here is a function of the
/// normals of the sequence; sequence_file.h puts the numbers into a file. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "workflow/bake/sequence/sequence_normals.h"

namespace chronormal::inline internal {

/// The normal that a file shows where an element has none.
inline constexpr Vec3d kAnyNormal{0, 0, 1};

/// What the whole sequence says about one element.
struct SequenceElement {
  Vec3d normal;             ///< N: unit, float32
  double scale = 1;         ///< what its normals are divided by
  bool frees_base = false;  ///< N is not its normal at key 0: that takes a target of its own
  bool has_none = true;     ///< it has no area in the whole sequence
};

/// Looks at all segments, whose deltas must have been checked. Errors: those of reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> sequence_elements(const SequenceNormals& normals);
/// What the first segment alone says: for almost every sequence that is the same. Errors: kInvalidInput where a delta
/// is too large for float32; those of reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> elements_of_start(const SequenceNormals& normals);

/// Of exact: what the targets of one segment have, float32 vectors one after the other.
struct ExactSegment {
  std::vector<float> positions;  ///< how far vertices are at the second key from where they were at key 0
  std::vector<float> start;      ///< of elements: what key 0 adds to N, in segment 0 only
  std::vector<float> key;        ///< what the second key adds to N
  std::vector<float> bend;       ///< what the segment adds to the hats of its keys
  bool bends = false;            ///< whether any normal bends; else nothing of `bend` counts
};

/// Calls body(segment, values) for every segment, one after the other, until it returns an error. Holds the keys of one
/// segment at a time. Where the elements are not final, this returns false as soon as a segment shows that
/// sequence_elements() are others. Errors: kInvalidInput where a delta is too large for float32; those of body, and of
/// the stream.
[[nodiscard]] Result<bool> each_exact_segment(
    const SequenceNormals& normals, std::span<const SequenceElement> elements, bool are_final,
    const std::function<Status(std::size_t segment, const ExactSegment& values)>& body);

/// Of endpoint: what a key adds to N so that the segment before it is shown best, and the largest angle that is left in
/// that segment, radians. `before` are the deltas of the key before; bounds, of the fits, are added to the angles, and
/// may be empty.
struct EndDeltas {
  std::vector<Vec3d> deltas;
  double error = 0;
};
[[nodiscard]] EndDeltas end_deltas(std::span<const SequenceElement> elements, const SegmentForm& form,
                                   std::span<const double> bounds, const std::vector<Vec3d>& before);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
