/// What shards (workflow/shard.h) leave in files, and how these become what one run would have written, byte for byte.
///
///     chronormal compare body.obj walk.pc2 --shard 1/8 --json -o part_1.json      ... 8/8, wherever and whenever
///     chronormal merge part_*.json -o all.json                   as compare ... --json --no-times -o all.json
///
/// A part of a comparison or an audit is a JSON object: what the whole work is, and of each segment of the share the sums,
/// with all of their bits. Only merge reads it, and only that of the same version. A part of samples is an array, .npy.
///
/// Threads    everything here is pure, but for files.
#ifndef CHRONORMAL_WORKFLOW_PARTS_H_
#define CHRONORMAL_WORKFLOW_PARTS_H_

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/json.h"

namespace chronormal {

/// The text of the part that a shard is.
[[nodiscard]] std::string compare_part(const NamedComparison& shard);
/// input and tolerance as audit_json() has them.
[[nodiscard]] std::string audit_part(const std::string& input, const Audit& shard, std::optional<double> tolerance);

struct Part {
  std::string name;  ///< of the file, for messages
  std::string text;
};

/// What one run would have printed with --json, without times, and whether it kept its tolerance.
struct MergedParts {
  std::string json;
  bool is_within = true;
};

/// Puts the parts of one comparison or one audit together, in any order. Errors: kInvalidInput for a text that is no part, with
/// the place in it; kUsage for parts of two works, and where not each segment is in one of them.
/// There must be one at least
[[nodiscard]] Result<MergedParts> merge_parts(std::span<const Part> parts);

/// Writes one array of the rows of all, in the order given: .npy files in C order whose elements and rows are alike. Memory:
/// a megabyte. Errors: kFailed for files that can not be read; kInvalidInput for those that are no such array or unlike the
/// first; those of write_output() in io/output.h.
[[nodiscard]] Status merge_arrays(std::span<const std::string> paths, const std::string& output, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_PARTS_H_
