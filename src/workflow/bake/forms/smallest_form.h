/// The cheapest form of a mesh that is within a tolerance in the hosts that are named. Private to workflow.
///
///     as it is     what the file stores
///     own deltas   one delta for each target of the mesh
///     pruned       deltas, self terms and pairs that are worth their bytes                worthwhile_form
///     low rank     one delta for each target, and extra targets that animations drive     low_rank_form
///     harmless     where none of these is near enough                                     chosen_form
///
/// Each of them does no harm: vertices for which that cannot be said keep what the file stores (host_judge.h).
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_SMALLEST_FORM_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_SMALLEST_FORM_H_

#include <cstddef>

#include "workflow/bake/forms/chosen_form.h"

namespace chronormal::inline internal {

/// Chooses among what the file stores, deltas of the mesh's own targets of these lengths, and these with extra targets
/// of low rank (low_rank_form.h); no more than so many targets in all that hosts add up. Without extra targets the
/// deltas of free length are the best single ones.
[[nodiscard]] ChosenForm choose_low_rank(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options, FormLengths lengths, std::size_t most_extras);

/// Chooses the smallest of all forms that are within the tolerance; where there is none, the nearest one within the
/// limits of options.
[[nodiscard]] ChosenForm choose_smallest(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_SMALLEST_FORM_H_
