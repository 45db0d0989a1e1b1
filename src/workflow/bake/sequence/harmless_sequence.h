/// Computes normals of a sequence that every viewer renders alike (docs/theory.md, section 16). Private to workflow.
///
/// N is the normal of key 0. The target of each other key has the delta from N to the normal at the key, and both
/// normals have length 1. A viewer then interpolates linearly between two unit normals. A segment may have one more
/// target, the bend, whose delta leads from N to another unit normal. With the weight 4 t (1 - t), the bend makes the
/// normal right at t = 1/2 as well. Tracks are LINEAR, so this weight is played as a chain of kBendPieces straight
/// pieces.
///
/// Threads    Uses all cores. The results have the same bits on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_HARMLESS_SEQUENCE_H_
#define CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_HARMLESS_SEQUENCE_H_

#include <cstddef>
#include <span>
#include <vector>

#include "workflow/bake/sequence/sequence_deltas.h"
#include "workflow/bake/sequence/sequence_normals.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kBendPieces = 8;

/// The elements of a sequence, with their base normals. without_room is the number of elements that have a delta with a
/// component beyond 1. Compressors clamp such components.
struct HarmlessElements {
  std::vector<SequenceElement> elements;
  std::size_t without_room = 0;
};
/// Examines all segments to find the base normals of elements. Errors: those of reading keyframes.
[[nodiscard]] Result<HarmlessElements> harmless_elements(const SequenceNormals& normals);

/// The directions of the normals of all elements at both keys of a segment. If an element has no direction at a key,
/// the direction at the key before is used.
struct SegmentEnds {
  std::vector<Vec3d> from, to;
};
[[nodiscard]] SegmentEnds segment_ends(std::span<const SequenceElement> elements, const SegmentForm& form,
                                       const std::vector<Vec3d>& before);

/// Returns the deltas of a key, which lead from the base normals of the elements to the given directions.
[[nodiscard]] std::vector<Vec3d> unit_key_deltas(std::span<const SequenceElement> elements,
                                                 std::span<const Vec3d> directions);

/// The bends of a segment (the deltas of its additional target), if they reduce errors, and the largest angles between
/// rendered and true normals.
struct UnitBends {
  std::vector<Vec3d> deltas;  ///< the deltas of elements; empty if bends help no element
  /// The sum, over all elements, of the angles in radians by which bends reduce the largest error.
  double gain = 0;
  double error = 0, straight = 0;  ///< radians: the largest error with these deltas, and without bends
};
[[nodiscard]] UnitBends unit_bends(std::span<const SequenceElement> elements, const SegmentForm& form,
                                   const SegmentEnds& ends);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_SEQUENCE_HARMLESS_SEQUENCE_H_
