/// Tangents of normal-mapped primitives: what targets add to them, so that they stay perpendicular to the right normals
/// and of length 1. Private to workflow.
///
///     carried    a tangent lies in the faces around its vertex and goes along with each of them, as texture
///                coordinates do: where it is a e1 + b e2 of the edges of a face in the base, it is a e1' + b e2' where a
///                target has the weight 1. These count by the angle of the face there, as MikkTSpace counts them.
///     upright    less its part along the right normal that is shown, of length 1
///     stale      the stored tangent leans on the right normal at weight 1 by more than a degree more than in the base,
///                at some vertex; then all of the target are made anew, and else they stay as they are
///
/// With several targets at once tangents add up, and are right as far as normals of one delta are.
#ifndef CHRONORMAL_WORKFLOW_BAKE_TANGENTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_TANGENTS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/deltas/deltas.h"

namespace chronormal::inline internal {

/// The targets whose stored tangents are stale, one entry for each; none are where no viewer adds them up. The shading
/// must have its deltas. O(corners) for each target that moves something.
[[nodiscard]] std::vector<bool> find_stale_tangents(const DeltaSource& source, std::span<const Viewer> viewers);

/// What a target adds to the tangents: (vertices, 3) of each part, empty for parts without tangents.
[[nodiscard]] TargetDeltas tangent_deltas(const DeltaSource& source, std::size_t target);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_TANGENTS_H_
