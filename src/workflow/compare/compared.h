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

/// Compares the run's share of the segments. Segments that are known from an earlier run have no times. Errors: also
/// kUsage for single errors or samples of a run that is divided, and for known segments of another comparison; errors
/// of run.keep.
[[nodiscard]] Result<Comparison> compare(MotionStream& stream, const CompareOptions& options, CompareRun& run);

/// Joins the shards of one comparison into the result of one run, without times. Errors: as join() returns them. There
/// must be at least one shard.
[[nodiscard]] Result<Comparison> merge(std::vector<ComparisonShard> shards);

/// Merges the bounds of elements or of blocks into `all`. If two bounds are equal, keeps the first.
void add(CertifiedError& all, const CertifiedError& other);

/// Adds the results that follow. The same results added in the same order give the same bits.
void add(SchemeTally& all, const SchemeTally& other);

/// Computes the figures of a comparison from sums over this many segments. `totals` has the sums of each row, and after
/// these the sums of linear if no row is linear.
void conclude(const std::vector<SchemeTally>& totals, std::size_t segments, bool certified, Comparison& comparison);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
