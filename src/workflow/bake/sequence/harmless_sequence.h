/// The numbers of a sequence that every viewer shows alike (docs/theory.md, section 16). Private to workflow.
///
/// N is the normal of key 0, and the target of a key has the delta from it to the normal there, both of length 1.
/// Between two keys that is a straight line between unit normals; one more unit normal for each segment, with the
/// weight 4 t (1 - t), makes it right at t = 1/2 as well. Tracks are LINEAR: that weight is a chain of kBendPieces
/// straight pieces.
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

/// Base normals, and of how many elements a delta has components beyond 1, which compressors cut.
struct HarmlessElements {
  std::vector<SequenceElement> elements;
  std::size_t without_room = 0;
};
/// Looks at all segments. Errors: those of reading keyframes.
[[nodiscard]] Result<HarmlessElements> harmless_elements(const SequenceNormals& normals);

/// The directions of all elements at both keys of a segment; where an element has none at a key, that of the key
/// before.
struct SegmentEnds {
  std::vector<Vec3d> from, to;
};
[[nodiscard]] SegmentEnds segment_ends(std::span<const SequenceElement> elements, const SegmentForm& form,
                                       const std::vector<Vec3d>& before);

/// What a key adds to N, from the directions there.
[[nodiscard]] std::vector<Vec3d> unit_key_deltas(std::span<const SequenceElement> elements,
                                                 std::span<const Vec3d> directions);

/// What a segment adds where that gains; and the angles, radians, of what is shown against what is right.
struct UnitBends {
  std::vector<Vec3d> deltas;       ///< empty where no element gains
  double gain = 0;                 ///< sum over all elements of what their worst angle falls by
  double error = 0, straight = 0;  ///< the largest angle with the deltas, and without any
};
[[nodiscard]] UnitBends unit_bends(std::span<const SequenceElement> elements, const SegmentForm& form,
                                   const SegmentEnds& ends);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_HARMLESS_SEQUENCE_H_
