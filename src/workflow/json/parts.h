/// Reads, writes and joins parts. Parts are the files that shards (workflow/segments/shards.h) write. The joined parts
/// equal the output of one run, byte for byte.
///
///     chronormal compare body.obj walk.pc2 --shard 1/8 -o part_1.json             ... 8/8, wherever and whenever
///     chronormal merge part_*.json -o all.json                   as compare ... --json --no-times -o all.json
///
/// A part of a comparison or an audit is a JSON object. The object describes the whole task, and has the sums of each
/// segment of the share with all of their bits. Only `merge` reads such a part, and only if the part and the program
/// have the same version of this format. A part of samples is a .npy array with the rows of its share, followed by a
/// JSON object that gives the position of these rows among all rows. Both kinds end with a checksum of all earlier
/// bytes and have the TaskChecksums of the task. For this reason a part that is damaged, or that belongs to another
/// input or task, is never joined.
///
/// Threads    Functions that read or write no files are pure. Private to workflow and the program.
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

/// Returns the text of the part that a shard of a comparison writes. `run` has the results of the segments that the
/// shard has computed.
[[nodiscard]] std::string compare_part(const NamedComparison& shard, const CompareRun& run);
/// Returns the text of the part that a shard of an audit writes. input is the name of the audited file, and tolerance
/// is in degrees.
[[nodiscard]] std::string audit_part(const std::string& input, const Audit& shard, const AuditRun& run,
                                     std::optional<double> tolerance);

/// Convert the result of one segment to its line of text in a part, and back. `name` is the name of the file for
/// messages. Errors: kInvalidInput with the place in the text.
[[nodiscard]] std::string segment_part(const ComparedSegment& segment);
[[nodiscard]] std::string segment_part(const SegmentErrors& segment);
[[nodiscard]] Result<ComparedSegment> read_compared_segment(std::string_view text, const std::string& name);
[[nodiscard]] Result<SegmentErrors> read_measured_segment(std::string_view text, const std::string& name);

struct Part {
  std::string name;  ///< the name of the file, for messages
  std::string text;
};

/// The text that one run would have printed with --json and without times. is_within tells whether that run was within
/// its tolerance.
struct MergedParts {
  std::string json;
  bool is_within = true;
};

/// Joins the parts (texts that shards wrote) of one comparison or one audit. The parts may be in any order, and there
/// must be at least one. Errors: kInvalidInput, with the place in the text, for a text that is not a part or is
/// damaged; kUsage for parts of two different tasks or inputs, with the names of both parts, or if some segment is not
/// in exactly one part.
[[nodiscard]] Result<MergedParts> merge_parts(std::span<const Part> parts);

/// Joins parts of comparisons only. The result is that of a comparison in one run, without times and names of targets.
[[nodiscard]] Result<NamedComparison> merge_compare_parts(std::span<const Part> parts);
/// Joins parts of audits only. The result is that of an audit in one run.
[[nodiscard]] Result<Audit> merge_audit_parts(std::span<const Part> parts);

/// Joins the rows of the .npy files that shards of samples wrote to `paths`, and writes all rows as one array. The
/// files may be in any order, and there must be at least one. Needs a megabyte of memory. Errors: kFailed for files
/// that cannot be read; kInvalidInput for files that no shard of samples wrote, or that are damaged; kUsage for shards
/// of different samples or inputs, or if some row is not in exactly one file; those of write_output() in io/output.h.
[[nodiscard]] Status merge_arrays(std::span<const std::string> paths, const std::string& output, bool force);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_PARTS_H_
