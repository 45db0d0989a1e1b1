/// Corrections of any length as unit normals: two for each, with opposite weights. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_OPPOSITE_TARGETS_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_OPPOSITE_TARGETS_H_

#include <vector>

#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/judge/right_normals.h"
#include "workflow/bake/write/tracks.h"

namespace chronormal::inline internal {

/// Replaces each extra target by two, u - N with its weight and v - N with the opposite one, where u - v is what it was
/// (eq. 48). Vectors that are too long for that are brought down by a factor, of 8 at most, that their weights have
/// instead; of those that do not fit beside N, what goes along N is left out.
void split_into_opposites(const RightNormals& rights, std::vector<ExtraWeight>& weights,
                          std::vector<VertexVectors>& extras);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_OPPOSITE_TARGETS_H_
