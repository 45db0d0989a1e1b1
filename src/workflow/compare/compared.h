/// Adds up the results of comparisons, block by block and segment by segment, and derives figures from the sums.
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
  double bytes = 0;  ///< bytes of all elements together
  CertifiedError certified = {};
};

/// The results of all schemes in one segment: one for each row, then one for linear if no row is linear.
struct ComparedSegment {
  std::size_t segment = 0;
  std::vector<SchemeTally> schemes;
};

using CompareRun = RecordedRun<ComparedSegment>;
using ComparisonShard = ShardOf<Comparison, ComparedSegment>;

/// Runs compare() on the share of the run. Known segments have no times. Errors: also kUsage for single errors or
/// samples of a run that is divided, and for known segments of another comparison; errors of run.keep.
[[nodiscard]] Result<Comparison> compare(MotionStream& stream, const CompareOptions& options, CompareRun& run);

/// Joins the shards of one comparison into the result of one run, without times. Errors: as join() returns them. There
/// must be at least one shard.
[[nodiscard]] Result<Comparison> merge(std::vector<ComparisonShard> shards);

/// Merges the bounds of elements or of blocks. If two bounds are equal, the first is kept.
void add(CertifiedError& all, const CertifiedError& other);

/// Adds the next results. Adding the same parts in the same order gives the same bits.
void add(SchemeTally& all, const SchemeTally& other);

/// Derives the figures of a comparison from sums over this many segments. totals has the sums of each row, then the
/// sums of linear if linear is not a row.
void conclude(const std::vector<SchemeTally>& totals, std::size_t segments, bool certified, Comparison& comparison);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
