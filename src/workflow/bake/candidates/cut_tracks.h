/// How tracks carry the weights of extra targets. Private to workflow.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CUT_TRACKS_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CUT_TRACKS_H_

#include <cstdint>
#include <span>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/right_normals.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

/// Decides how the tracks of a file carry the weights of extra targets, so that they turn no normal by more than the
/// tolerance (radians):
///
///     LINEAR        straight pieces of each gap, as far as a limit of their number allows; track_error becomes no less
///                   than what they turn. Where all viewers play cubic splines and a spline takes fewer numbers, or pieces
///                   leave too much, the track becomes one, which is exact
///     CUBICSPLINE   more keys where all viewers play them as the specification says, for formulas
///
/// The candidate must have its deltas, and its formulas or curves.
void cut_tracks(const RightNormals& rights, const MeshWeights& weights, std::span<const Viewer> viewers,
                std::span<const std::uint32_t> vertices, double tolerance, Candidate& candidate);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_CUT_TRACKS_H_
