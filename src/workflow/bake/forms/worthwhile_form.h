/// Forms of a mesh whose extra targets products of weights drive, with nothing that is not worth its bytes. Private to
/// workflow.
///
///     of each target      what is stored | one delta | the delta to its end | that and its corrections (self terms)
///     of each pair        nothing | its corrections
///
/// Where all hosts add up what is stored, corrections are the terms of eq. 32, and nothing is missing with all of them;
/// elsewhere they are those of harmless (harmless_form.h).
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_WORTHWHILE_FORM_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_WORTHWHILE_FORM_H_

#include <cstddef>
#include <functional>

#include "workflow/bake/forms/chosen_form.h"

namespace chronormal::inline internal {

/// Calls take(form), which returns the bytes of the form, for forms that should be within the tolerance in all hosts,
/// from the cheapest one on, until is_enough(bytes) returns true, where no form that is left takes fewer bytes than
/// these; the last may be off by more, where none is within. Where none of them takes most_bytes or fewer, those come
/// last that leave out the least for that. Extra targets are left out where nothing drives them, and where there are so
/// many products that it takes too long to look at them; forms that have none are not looked at where deltas alone are
/// known to be not near enough. Returns whether there are extra targets among what was looked at.
bool find_worthwhile_forms(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                           FormLengths lengths, bool are_near_alone, std::size_t most_bytes,
                           const std::function<bool(std::size_t bytes)>& is_enough,
                           const std::function<std::size_t(ChosenForm)>& take);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_WORTHWHILE_FORM_H_
