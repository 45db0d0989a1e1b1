/// Adds up the results of comparisons, block by block and segment by segment, and computes what follows from the sums.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
#define CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/compare.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::inline internal {

/// The results of one scheme in one segment.
struct SchemeTally {
  Quality quality;
  std::size_t fallbacks = 0, flagged = 0;
  double bytes = 0;  ///< of all elements together
  CertifiedError certified = {};
};

/// The results of all schemes in one segment: one for each row, and a last one for linear where it is none of the rows.
struct ComparedSegment {
  std::size_t segment = 0;
  std::vector<SchemeTally> schemes;
};

using CompareRun = RecordedRun<ComparedSegment>;
using ComparisonShard = ShardOf<Comparison, ComparedSegment>;

/// compare() as the run has it. Segments that are known have no times. Errors: also kUsage for single errors or samples
/// of a run that is divided, and for known segments of another comparison; those of run.keep.
[[nodiscard]] Result<Comparison> compare(MotionStream& stream, const CompareOptions& options, CompareRun& run);

/// Joins the shards of one comparison into what one run would have found, but without times. Errors: those of join().
/// There must be at least one shard
[[nodiscard]] Result<Comparison> merge(std::vector<ComparisonShard> shards);

/// Puts the bounds of the elements of a block together, or those of blocks; of equals the first counts.
void add(CertifiedError& all, const CertifiedError& other);

/// Adds the results that come next. Adding the same parts in the same order gives the same bits.
void add(SchemeTally& all, const SchemeTally& other);

/// Fills in what follows from the sums over so many segments. The sums are those of each row, and last those of linear
/// where it is none of the rows.
void conclude(const std::vector<SchemeTally>& totals, std::size_t segments, bool certified, Comparison& comparison);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
