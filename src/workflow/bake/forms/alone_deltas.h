/// Deltas of targets that do no harm where each of these is played alone. Private to workflow.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_ALONE_DELTAS_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_ALONE_DELTAS_H_

#include <vector>

#include "workflow/bake/exact/deltas.h"
#include "workflow/bake/forms/harmless_form.h"
#include "workflow/bake/judge/host_judge.h"

namespace chronormal::inline internal {

/// Changes the deltas of each target that are worse than what the file stores (more than 0.01 degrees, and beyond the
/// tolerance in degrees) at one of 32 weights from 0 to 1 in a host that adds up what is stored. Deltas of free length
/// get another one, with the same direction at weight 1; where none does no harm, and for unit normals in any case,
/// they come nearer to what is stored. Cost: some 50 dot products for each delta
void make_harmless_alone(const DeltaSource& source, const std::vector<VertexVectors>& stored, FormLengths lengths,
                         double tolerance, std::vector<VertexVectors>& deltas);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_ALONE_DELTAS_H_
