/// Computes the changes that targets make to the tangents of normal-mapped primitives. Tangents stay perpendicular to
/// the right normals, and keep length 1. Private to workflow.
///
///     carried    A tangent lies in the faces around its vertex and moves with each of them, as texture coordinates do.
///                If the tangent is a e1 + b e2 for the edges e1, e2 of a face in the base, it is a e1' + b e2' at
///                weight 1 of a target. The results of several faces are added up, weighted by the angle of the face at
///                the vertex, as in MikkTSpace.
///     upright    The part of the tangent along the right normal is removed, and the rest is scaled to length 1.
///     stale      A stored tangent is stale if at weight 1 of the target its angle to the right normal is farther from
///                90 degrees than in the base, by more than a degree. If one vertex has a stale tangent, all tangents
///                of the target are computed anew. Otherwise all of them stay as they are.
///
/// If the normals of a mesh stay as the file stores them, its tangents have to fit these normals instead of the right
/// ones (keeps_normals).
///
/// If several targets are active, their changes of a tangent add up. Tangents are then as accurate as normals with one
/// delta for each target.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_TANGENTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_TANGENTS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/deltas/deltas.h"

namespace chronormal::inline internal {

/// Returns for each target if its stored tangents are stale (no longer nearly perpendicular to the normal). If no
/// viewer adds up tangents, all results are false. The shading must have been read with its deltas. Takes O(corners)
/// for each target that moves a vertex.
[[nodiscard]] std::vector<bool> find_stale_tangents(const DeltaSource& source, std::span<const Viewer> viewers,
                                                    bool keeps_normals);

/// Returns the deltas of tangents for a target, as arrays (vertices, 3) for each part. The array of a part without
/// tangents is empty.
[[nodiscard]] TargetDeltas tangent_deltas(const DeltaSource& source, std::size_t target, bool keeps_normals);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_TANGENTS_H_
