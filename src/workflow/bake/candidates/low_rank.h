/// Extra targets of low rank: what the deltas of a mesh's own targets lack along the animations of a file, as the sum
/// of a few deltas whose weights are curves in time (docs/theory.md, section 17). Private to workflow.
///
///     n(w(t)) / |n(0)|  =  N + sum_i w_i(t) D_i + sum_k s_k(t) E_k, nearly
///
/// The s_k are the leading left singular vectors of what is missing, in which points where n(w) gets short count more;
/// the E_k are the right ones. Where that leaves a point far off, its own E_k are fitted again by least squares of the
/// angles, in which the length of n(w) is free at every instant and bad instants count more.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_LOW_RANK_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_LOW_RANK_H_

#include "workflow/bake/candidates/making.h"

namespace chronormal::inline internal {

/// Fits as many extra targets as the tolerance needs, within the limit, to what new deltas of the mesh's own targets
/// leave wrong. Vertices that are right to a part of the tolerance take no part. Where animations are all that counts and
/// lengths are free, the deltas of own targets are fitted to the animations too. Cost: the right normals at all nodes of
/// the curves; 480 of these at most are fitted to, and 700 MB are used for them.
[[nodiscard]] Candidate low_rank_candidate(const Making& making, Candidate own);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_LOW_RANK_H_
