/// Decides how the tracks of a file carry the weights of correction targets. Private to workflow.
///
/// Threads    Uses all cores. The result has the same bits on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CUT_TRACKS_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CUT_TRACKS_H_

#include <cstdint>
#include <span>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/right_normals.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

/// Decides how tracks carry the weights of correction targets. The errors of these weights must turn no normal by more
/// than the tolerance, in radians:
///
///     LINEAR        Each gap between keys is cut into straight pieces, within a limit of their number. track_error is
///                   raised to the angle by which these pieces turn normals. If all viewers play cubic splines, the
///                   track may become a spline, which is exact. It does so if a spline takes fewer numbers, or if the
///                   pieces leave too large an error.
///     CUBICSPLINE   More keys are added for the weights of formulas, if all viewers play splines as specified.
///
/// The candidate must have its deltas, and its formulas or curves.
void cut_tracks(const RightNormals& rights, const MeshWeights& weights, std::span<const Viewer> viewers,
                std::span<const std::uint32_t> vertices, double tolerance, Candidate& candidate);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CUT_TRACKS_H_
