/// Chooses what a bake writes for a mesh. Private to workflow.
///
/// Makers make candidates, the judge measures what viewers render with each candidate, and the chooser picks one
/// candidate for the whole mesh. If each vertex had its own candidate, its normal would not fit the normals of its
/// neighbours.
///
///     better in a viewer    The mean error over all poses is smaller by at least a twentieth. In addition, the mean
///                           error, the 99.9 % quantile, the worst error and the torn edges (beyond 10, 20 and 40
///                           degrees) must not grow beyond the tolerance. This must be true in the poses that the file
///                           plays, in each target alone, and in poses that a program sets.
///
/// The criteria for a candidate are, in this order: it is within the limits; it is better in most of the named viewers;
/// it is no worse in most of the other viewers; it is within the tolerance; its size is in proportion to the file. A
/// tolerance that the caller gave precedes the other viewers. A candidate is not chosen if the average error falls by
/// less in the named viewers than it grows in another viewer, unless the candidate keeps a tolerance that was given.
/// Among candidates that are equal by all criteria and within the tolerance, the smallest is chosen, unless another one
/// has a much smaller error in the viewers that are not named. If such candidates are beyond the tolerance, the
/// candidate with the smallest error is chosen.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

/// The candidate that was chosen, and facts about all candidates that were tried.
struct ChosenCandidate {
  Candidate candidate;
  /// The errors in each viewer before and after the bake: first in the named viewers, then in all other viewers.
  std::vector<ViewerChange> viewers;
  std::vector<BakedCandidate> candidates;  ///< all candidates that were tried
};

/// Chooses the best candidate for a mesh, in the encoding that the plan names. tangent_bytes is the number of bytes of
/// new tangents, which is added to the size of every candidate.
[[nodiscard]] ChosenCandidate choose_candidate(const DeltaSource& source, const MeshWeights& weights,
                                               const BakeOptions& options, std::size_t tangent_bytes);

/// Judges a mesh that an earlier bake wrote, by the tolerance and the limits of the options. If no animation of the
/// file drives the correction targets of the mesh, they get the weights of their formulas.
[[nodiscard]] BakedCandidate judge_baked(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CHOOSER_H_
