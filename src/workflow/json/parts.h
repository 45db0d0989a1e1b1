/// Parts are the files that shards (workflow/segments/shards.h) write. Merging the parts gives the output of one run,
/// byte for byte.
///
///     chronormal compare body.obj walk.pc2 --shard 1/8 -o part_1.json             ... 8/8, wherever and whenever
///     chronormal merge part_*.json -o all.json                   as compare ... --json --no-times -o all.json
///
/// A part of a comparison or an audit is a JSON object. The object describes the whole task, and has the sums of each
/// segment of the share with all of their bits. Only merge reads such a part, and only if the part and the program have
/// the same version of this format. A part of samples is a .npy array of the rows of its share, followed by a JSON
/// object that gives their position among all rows. Both kinds end with a checksum of all earlier bytes and have the
/// TaskChecksums of the task, so that a part that is damaged, or that belongs to another input or task, is never
/// joined.
///
/// Threads    everything here is pure, apart from reading and writing files. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_JSON_PARTS_H_
#define CHRONORMAL_WORKFLOW_JSON_PARTS_H_

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/workflow/audit.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/compare/compared.h"
#include "workflow/json/json.h"

namespace chronormal::inline internal {

/// Returns the text of the part that a shard of a comparison writes, with the segments that the run has found.
[[nodiscard]] std::string compare_part(const NamedComparison& shard, const CompareRun& run);
/// Returns the text of the part that a shard of an audit writes; input and tolerance are as in audit_json().
[[nodiscard]] std::string audit_part(const std::string& input, const Audit& shard, const AuditRun& run,
                                     std::optional<double> tolerance);

/// Convert one segment to its line of text in a part, and back; `name` is for messages. Errors: kInvalidInput with the
/// place in the text.
[[nodiscard]] std::string segment_part(const ComparedSegment& segment);
[[nodiscard]] std::string segment_part(const SegmentErrors& segment);
[[nodiscard]] Result<ComparedSegment> read_compared_segment(std::string_view text, const std::string& name);
[[nodiscard]] Result<SegmentErrors> read_measured_segment(std::string_view text, const std::string& name);

struct Part {
  std::string name;  ///< name of the file, for messages
  std::string text;
};

/// The text that one run would have printed with --json, without times, and whether that run was within its tolerance.
struct MergedParts {
  std::string json;
  bool is_within = true;
};

/// Joins the parts of one comparison or one audit, which may come in any order; there must be at least one. Errors:
/// kInvalidInput for a text that is not a part or was damaged, with the place in it; kUsage for parts of two different
/// tasks or inputs, with the names of both, or if some segment is not in exactly one part.
[[nodiscard]] Result<MergedParts> merge_parts(std::span<const Part> parts);

/// Joins parts of comparisons only, into the result of one run without times and names of targets.
[[nodiscard]] Result<NamedComparison> merge_compare_parts(std::span<const Part> parts);
/// Joins parts of audits only.
[[nodiscard]] Result<Audit> merge_audit_parts(std::span<const Part> parts);

/// Joins the rows of the files, which may come in any order, and writes them as one array. Needs a megabyte of memory.
/// Errors: kFailed for files that cannot be read; kInvalidInput for files that no shard of samples wrote, or that were
/// damaged; kUsage for shards of different samples or inputs, or if some row is not in exactly one file; errors of
/// write_output() in io/output.h. There must be at least one path.
[[nodiscard]] Status merge_arrays(std::span<const std::string> paths, const std::string& output, bool force);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_PARTS_H_
