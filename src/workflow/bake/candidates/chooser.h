/// Chooses what a bake writes for a mesh. Private to workflow.
///
/// Makers make candidates, the judge measures what viewers show of each, and this picks one. A candidate is better or worse
/// as a whole, because the eye sees a surface: a vertex that decides by itself tears it from its neighbours.
///
///     better in a viewer    the mean over all poses is smaller, by a twentieth at least; and in what the file plays, in
///                           each target alone, and in poses that a program sets, none of mean, 99.9 %, worst and torn
///                           edges (beyond 10, 20 and 40 degrees) grows beyond the tolerance
///
/// Of all candidates the best comes first by these, in this order: within the limits; better in most of the viewers that
/// are named; no worse in most of the others; within the tolerance; of a size that its file bears; and then the smallest
/// of those within the tolerance, unless another is much nearer in the viewers that are not named, or the nearest of those
/// beyond.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

/// The candidate that was chosen, and all that were looked at.
struct ChosenCandidate {
  Candidate candidate;
  std::vector<ViewerChange>
      viewers;  ///< what each viewer shows before and after: those that are named, then the others
  std::vector<BakedCandidate> candidates;  ///< every candidate that was looked at
};

/// Chooses by the encoding of the plan. tangent_bytes are those that new tangents take beside any candidate.
[[nodiscard]] ChosenCandidate choose_candidate(const DeltaSource& source, const MeshWeights& weights,
                                               const BakeOptions& options, std::size_t tangent_bytes);

/// Judges what a mesh shows that an earlier bake wrote, by the tolerance and the limits of options; extra targets that
/// nothing drives are given the weights that their formulas have.
[[nodiscard]] BakedCandidate judge_baked(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_
