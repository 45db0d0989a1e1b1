/// Computes the changes that targets make to the tangents of normal-mapped primitives, so that tangents stay
/// perpendicular to the right normals and keep length 1. Private to workflow.
///
///     carried    a tangent lies in the faces around its vertex and follows each of them, as texture coordinates do: if
///                it is a e1 + b e2 of the edges of a face in the base, it is a e1' + b e2' at weight 1 of a target.
///                The results are weighted by the angle of the face there, as in MikkTSpace.
///     upright    the part of the tangent along the right normal is removed, and the rest is scaled to length 1
///     stale      at weight 1 of the target, the angle between a stored tangent and the right normal is farther from 90
///                degrees than in the base, by more than a degree. One such vertex is enough to compute all tangents of
///                the target anew; otherwise they all stay as they are
///
/// With several active targets, changes of tangents add up; they are then as accurate as normals with one delta per
/// target.
#ifndef CHRONORMAL_WORKFLOW_BAKE_TANGENTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_TANGENTS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/deltas/deltas.h"

namespace chronormal::inline internal {

/// Returns for each target whether its stored tangents are stale. If no viewer adds up tangents, all are false. The
/// shading must have its deltas. O(corners) for each target that moves something.
[[nodiscard]] std::vector<bool> find_stale_tangents(const DeltaSource& source, std::span<const Viewer> viewers);

/// Returns the deltas of a target for tangents: (vertices, 3) for each part, empty for parts without tangents.
[[nodiscard]] TargetDeltas tangent_deltas(const DeltaSource& source, std::size_t target);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_TANGENTS_H_
