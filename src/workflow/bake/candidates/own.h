/// New deltas for the targets of a mesh, without any extra target. Private to workflow.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_OWN_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_OWN_H_

#include "workflow/bake/candidates/making.h"

namespace chronormal::inline internal {

/// Makes a candidate of what the file stores.
[[nodiscard]] Candidate stored_candidate(const DeltaSource& source);

/// Deltas that are right at weight 1 of each target alone. Where lengths are free they are those that leave least on the
/// way there, as the plan of the source has it: with fitted lines, by least squares over the weights of the file.
[[nodiscard]] Candidate own_candidate(const DeltaSource& source, const RightNormals& rights, Lengths lengths);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_OWN_H_
