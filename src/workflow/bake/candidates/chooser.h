/// Chooses what a bake writes for a mesh. Private to workflow.
///
/// Makers make candidates, the judge measures what viewers render with each, and the chooser picks one. It picks one
/// candidate for the whole mesh: if vertices chose separately, their normals would not fit those of their neighbours.
///
///     better in a viewer    the mean over all poses is smaller, by a twentieth at least; and in what the file plays,
///                           in each target alone, and in poses that a program sets, none of mean, 99.9 %, worst and
///                           torn edges (beyond 10, 20 and 40 degrees) grows beyond the tolerance
///
/// Candidates are compared by these criteria, in this order: within the limits; better in most of the named viewers; no
/// worse in most of the others; within the tolerance; of a size that is in proportion to the file. Among candidates
/// that are equal by all of these and within the tolerance, the smallest is chosen, unless another one has a much
/// smaller error in the viewers that are not named. If they are beyond the tolerance, the one with the smallest error
/// is chosen.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

/// The candidate that was chosen, and all that were tried.
struct ChosenCandidate {
  Candidate candidate;
  std::vector<ViewerChange> viewers;  ///< what each viewer renders before and after: the named ones, then the others
  std::vector<BakedCandidate> candidates;  ///< every candidate that was tried
};

/// Chooses a candidate of the encoding in the plan. tangent_bytes are the bytes of new tangents, beside any candidate.
[[nodiscard]] ChosenCandidate choose_candidate(const DeltaSource& source, const MeshWeights& weights,
                                               const BakeOptions& options, std::size_t tangent_bytes);

/// Judges a mesh that an earlier bake wrote, by the tolerance and the limits of the options. If nothing drives its
/// correction targets, they get the weights of their formulas.
[[nodiscard]] BakedCandidate judge_baked(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_
