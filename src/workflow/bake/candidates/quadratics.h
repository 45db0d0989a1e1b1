/// Candidates of a mesh that nothing drives, with extra targets whose weights are quadratics of the weights. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_QUADRATICS_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_QUADRATICS_H_

#include <functional>

#include "workflow/bake/candidates/making.h"

namespace chronormal::inline internal {

/// Adds more and more extra targets to the deltas of a candidate that has none, and calls take(candidate) for each number
/// of them, until that returns false. A file whose extra targets nobody drives shows the deltas of `own` alone.
/// making.weights must have a rig
void quadratics_candidates(const Making& making, const Candidate& own,
                           const std::function<bool(Candidate candidate)>& take);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_QUADRATICS_H_
