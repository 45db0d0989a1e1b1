/// A candidate with extra targets that products of weights drive (docs/theory.md, section 16). Private to workflow.
///
/// Each target of the mesh gets the delta to the right normal at its weight 1. What this leaves wrong on the way, and
/// where targets meet, extra targets correct; they move no vertex, and their weights follow from those of the targets:
///
///     turn      w_i            where a turn to weight 1 is so large that a delta of unit length would not fit; two
///     self      4 w_i (1-w_i)  right at w_i = 1/2 as well
///     pair      s w_i w_j      right where both are strongest in the file; one or two
///
/// Where lengths are not free, every one of them is a unit normal beside N, with a weight from 0 to 1 where those of the
/// file are: what a viewer leaves of it, be it the direction or 8 bits, is the same.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_PRODUCTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_PRODUCTS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "workflow/bake/candidates/making.h"

namespace chronormal::inline internal {

/// Computes the deltas of the mesh's own targets to their ends, for all vertices of elements that these move.
[[nodiscard]] std::vector<VertexVectors> end_deltas(const GltfShading& shading, const NormalTerms& terms,
                                                    const RightNormals& rights, Lengths lengths);

/// Counts the pairs of targets that move a normal both and are active together, a target with itself among them, but no
/// more than one beyond `most`.
[[nodiscard]] std::size_t count_products(const Making& making, std::size_t most);

/// Makes the candidate, for the poses of the file or of the rig. Vertices that are right to half the tolerance take part
/// in no extra target; of those beyond the limit the ones that gain most are kept.
[[nodiscard]] Candidate products_candidate(const Making& making);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_PRODUCTS_H_
