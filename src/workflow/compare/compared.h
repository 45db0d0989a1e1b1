/// Adds up the results of comparisons, block by block and segment by segment, and derives figures from the sums.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
#define CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/compare.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::inline internal {

/// The sums and counts of one scheme in one segment of a comparison.
struct SchemeTally {
  Quality quality;
  std::size_t fallbacks = 0, flagged = 0;
  double bytes = 0;  ///< the bytes that the scheme keeps for all elements together
  CertifiedError certified = {};
};

/// The results of all schemes in one segment: one entry for each row of the comparison, and then an entry for `linear`
/// if no row shows this scheme.
struct ComparedSegment {
  std::size_t segment = 0;
  std::vector<SchemeTally> schemes;
};

using CompareRun = RecordedRun<ComparedSegment>;
using ComparisonShard = ShardOf<Comparison, ComparedSegment>;

/// Compares schemes in the run's share of the segments. Segments that are known from an earlier run have no times.
/// Errors: those of an undivided comparison; kUsage if single errors or samples are requested of a divided run, and for
/// known segments of another comparison; those of run.keep.
[[nodiscard]] Result<Comparison> compare(MotionStream& stream, const CompareOptions& options, CompareRun& run);

/// Joins the shards of one comparison. The result equals that of a comparison in one run, without times. There must be
/// at least one shard. Errors: those of join() for shards.
[[nodiscard]] Result<Comparison> merge(std::vector<ComparisonShard> shards);

/// Merges the bound of the error of further elements into `all`, which then has the larger bound. If the two bounds are
/// equal, keeps the bound of `all`.
void add(CertifiedError& all, const CertifiedError& other);

/// Adds the results of further elements to `all`. If the same results are added in the same order, the sums have the
/// same bits.
void add(SchemeTally& all, const SchemeTally& other);

/// Computes the figures of a comparison from the sums over all segments. `totals` has the sums of each row, and then
/// the sums of `linear` if no row shows it.
void conclude(const std::vector<SchemeTally>& totals, std::size_t segments, bool certified, Comparison& comparison);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_COMPARED_H_
