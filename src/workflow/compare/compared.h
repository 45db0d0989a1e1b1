/// What comparisons add up, block by block and segment by segment, and what follows from the sums. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
#define CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/compare.h"

namespace chronormal::inline internal {

/// Puts the bounds of the elements of a block together, or those of blocks; of equals the first counts.
void add(CertifiedError& all, const CertifiedError& other);

/// Adds what was found after it. Adding the same parts in the same order gives the same bits.
void add(SchemeTally& all, const SchemeTally& other);

/// Fills in what follows from the sums over so many segments, of each row, and of linear, behind them where it is none.
void conclude(const std::vector<SchemeTally>& totals, std::size_t segments, bool certified, Comparison& comparison);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
