/// Adds up the results of comparisons, block by block and segment by segment, and computes what follows from the sums.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
#define CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/compare.h"

namespace chronormal::inline internal {

/// Puts the bounds of the elements of a block together, or those of blocks; of equals the first counts.
void add(CertifiedError& all, const CertifiedError& other);

/// Adds the results that come next. Adding the same parts in the same order gives the same bits.
void add(SchemeTally& all, const SchemeTally& other);

/// Fills in what follows from the sums over so many segments. The sums are those of each row, and last those of linear
/// where it is none of the rows.
void conclude(const std::vector<SchemeTally>& totals, std::size_t segments, bool certified, Comparison& comparison);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
