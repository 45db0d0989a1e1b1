/// Computes the normals of a sequence that every viewer renders alike (docs/theory.md, section 16). Private to
/// workflow.
///
/// N is the normal of key 0, and the target of a key has the delta from N to the normal at the key, both of length 1.
/// So a viewer interpolates linearly between two unit normals. One more target for each segment, the bend, leads to
/// another unit normal. With the weight 4 t (1 - t) it makes the normal right at t = 1/2 as well. Tracks are LINEAR, so
/// that weight is a chain of kBendPieces straight pieces.
///
/// Threads    on all cores; the same bits on any number of them
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_HARMLESS_SEQUENCE_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_HARMLESS_SEQUENCE_H_

#include <cstddef>
#include <span>
#include <vector>

#include "workflow/bake/sequence/sequence_deltas.h"
#include "workflow/bake/sequence/sequence_normals.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kBendPieces = 8;

/// Base normals of elements, and the number of elements that have a delta with a component beyond 1. Compressors clamp
/// such components.
struct HarmlessElements {
  std::vector<SequenceElement> elements;
  std::size_t without_room = 0;
};
/// Examines all segments. Errors: from reading keyframes.
[[nodiscard]] Result<HarmlessElements> harmless_elements(const SequenceNormals& normals);

/// The directions of all elements at both keys of a segment. An element without a direction at a key takes the
/// direction of the key before.
struct SegmentEnds {
  std::vector<Vec3d> from, to;
};
[[nodiscard]] SegmentEnds segment_ends(std::span<const SequenceElement> elements, const SegmentForm& form,
                                       const std::vector<Vec3d>& before);

/// Returns the deltas from N to the given directions at a key.
[[nodiscard]] std::vector<Vec3d> unit_key_deltas(std::span<const SequenceElement> elements,
                                                 std::span<const Vec3d> directions);

/// The bends of a segment, if they reduce errors, and the angles between rendered and right normals, in radians.
struct UnitBends {
  std::vector<Vec3d> deltas;       ///< empty if no element gains
  double gain = 0;                 ///< the sum over all elements of the reduction of their worst angle
  double error = 0, straight = 0;  ///< the largest angle with the deltas, and without any
};
[[nodiscard]] UnitBends unit_bends(std::span<const SequenceElement> elements, const SegmentForm& form,
                                   const SegmentEnds& ends);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_HARMLESS_SEQUENCE_H_
