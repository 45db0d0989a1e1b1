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
#include <cstdint>
#include <vector>

#include "workflow/bake/forms/chosen_form.h"

namespace chronormal::inline internal {

/// The deltas that a form with extra targets of low rank starts from.
struct OwnForm {
  std::vector<VertexVectors> stored;    ///< the deltas of the file
  std::vector<VertexVectors> deltas;    ///< new ones of the mesh's own targets
  std::vector<std::uint32_t> vertices;  ///< that are judged
};

/// Computes deltas of these lengths: right at the end of each target, or where they may have any length, the best
/// single ones. Unless nothing but animations is ever played, they do no harm to targets alone.
[[nodiscard]] OwnForm own_form(const DeltaSource& source, const RightNormals& rights, const BakeOptions& options,
                               FormLengths lengths);

/// Chooses among what the file stores, the new deltas of the mesh's own targets, and these with extra targets of low
/// rank (low_rank_form.h); no more than so many extra ones in all that hosts add up.
[[nodiscard]] ChosenForm choose_low_rank(const DeltaSource& source, const RightNormals& rights,
                                         const MeshWeights& weights, const BakeOptions& options, FormLengths lengths,
                                         const OwnForm& own, std::size_t most_extras);

/// Chooses the smallest of all forms that are within the tolerance; where there is none, the nearest one within the
/// limits of options. tangent_bytes are those that new tangents take beside any form.
[[nodiscard]] ChosenForm choose_smallest(const DeltaSource& source, const MeshWeights& weights,
                                         const BakeOptions& options, std::size_t tangent_bytes);

/// Judges what a mesh shows that an earlier bake wrote, by the tolerance and the limits of options; extra targets that
/// nothing drives are given the weights that their formulas have.
[[nodiscard]] BakeChoice judge_baked(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_SMALLEST_FORM_H_
