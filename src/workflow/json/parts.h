/// Parts, the files that shards (workflow/segments/shards.h) write, and how they become what one run would have
/// written, byte for byte.
///
///     chronormal compare body.obj walk.pc2 --shard 1/8 -o part_1.json             ... 8/8, wherever and whenever
///     chronormal merge part_*.json -o all.json                   as compare ... --json --no-times -o all.json
///
/// A part of a comparison or an audit is a JSON object. It describes the whole task, and has the sums of each segment
/// of the share with all of their bits. Only merge reads it, and only where both have the same version of this format.
/// A part of samples is a .npy array of the rows of its share, behind which an object of JSON says which of how many
/// they are. Either ends with a checksum of all bytes before, and has the TaskChecksums of the task, so that
/// neither a damaged part nor one of another input or task is joined.
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

/// The text of the part that a shard of a comparison writes, which the run has found.
[[nodiscard]] std::string compare_part(const NamedComparison& shard, const CompareRun& run);
/// The text of the part that a shard of an audit writes; input and tolerance are those of audit_json().
[[nodiscard]] std::string audit_part(const std::string& input, const Audit& shard, const AuditRun& run,
                                     std::optional<double> tolerance);

/// The text of one segment as a part has it, in one line, and the segment of such a text; name is for messages. Errors:
/// kInvalidInput with the place in the text.
[[nodiscard]] std::string segment_part(const ComparedSegment& segment);
[[nodiscard]] std::string segment_part(const SegmentErrors& segment);
[[nodiscard]] Result<ComparedSegment> read_compared_segment(std::string_view text, const std::string& name);
[[nodiscard]] Result<SegmentErrors> read_measured_segment(std::string_view text, const std::string& name);

struct Part {
  std::string name;  ///< of the file, for messages
  std::string text;
};

/// A merge gives the text that one run would have printed with --json, without times, and says whether that run was
/// within its tolerance.
struct MergedParts {
  std::string json;
  bool is_within = true;
};

/// Joins the parts of one comparison or one audit, which may come in any order. Errors: kInvalidInput for a text that
/// is no part, with the place in it, or that was damaged; kUsage for parts of two different tasks or inputs, with the
/// names of both, and unless each segment is in exactly one of them.
/// There must be at least one part
[[nodiscard]] Result<MergedParts> merge_parts(std::span<const Part> parts);

/// The same of parts of comparisons alone, as what one run would have returned, without times and names of targets.
[[nodiscard]] Result<NamedComparison> merge_compare_parts(std::span<const Part> parts);
/// The same of parts of audits alone.
[[nodiscard]] Result<Audit> merge_audit_parts(std::span<const Part> parts);

/// Writes the array of which the files have the rows, in any order. Memory: a megabyte. Errors: kFailed for files that
/// cannot be read; kInvalidInput for those that no shard of samples has left, or that were damaged; kUsage for shards
/// of different samples or inputs, and unless each row is in exactly one of them; those of write_output() in
/// io/output.h. There must be at least one path
[[nodiscard]] Status merge_arrays(std::span<const std::string> paths, const std::string& output, bool force);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_PARTS_H_
