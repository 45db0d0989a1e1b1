/// The numbers of a baked sequence: base normals and deltas of its elements. Everything here is a function of the
/// normals of the sequence; sequence_file.h puts the numbers into a file. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_SEQUENCE_DELTAS_H_

#include <cstddef>
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

/// Looks at all segments. Errors: those of reading keyframes.
[[nodiscard]] Result<std::vector<SequenceElement>> sequence_elements(const SequenceNormals& normals);

/// Of exact: what a key adds to N, from the normals there.
[[nodiscard]] std::vector<Vec3d> key_deltas(std::span<const SequenceElement> elements, std::span<const Vec3d> at_key);

/// Of exact: what a segment adds to the hats of its keys; empty where no normal bends.
[[nodiscard]] std::vector<Vec3d> bend_deltas(std::span<const SequenceElement> elements, const SegmentForm& form);

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
