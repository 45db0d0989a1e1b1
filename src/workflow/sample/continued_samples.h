/// Writes samples together with other processes, as a share of the work, or after rows that an interrupted run has
/// written. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_CONTINUED_SAMPLES_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_CONTINUED_SAMPLES_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/workflow/sample.h"
#include "io/bytes/journal.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::inline internal {

/// Returns the names of the files to write for `count` moments, and checks that they may be written. In a shard, files
/// of other shards may exist already. Errors: also kUsage for a shard of .npz, and for a stream that several processes
/// share.
[[nodiscard]] Result<std::vector<std::string>> sample_files(const SampleOutput& output, ElementKind kind,
                                                            std::size_t count, const SegmentRun& run);

/// Runs write_samples() on the share of the run, in which each moment is a segment:
///
///     shard      writes its share of the moments: .ply and .obj files with the numbers that they would have among all
///                files, or .npy with as many rows (workflow/json/parts.h joins them). The bits are the same as in one
///                run
///     peers      the shards share one output, which nobody sees before all are done: a .npy or .npz file that every
///                process writes its rows into, or .ply and .obj files. The first process gets the summary of all, and
///                each other process its own
///     journal    each row of a .npy file gets a record. The file is OUT.partial until it is complete. Rows that the
///                journal of an earlier run has, and that are in the file with the same checksum, are not computed
///                again. The journal stays; the caller removes it
///
/// Errors: also the errors of the journal; kUsage for a journal with another format or a stream; kFailed if OUT.partial
/// is not such an array.
[[nodiscard]] Result<SampleSummary> write_samples(MotionStream& stream, const SampleOptions& options,
                                                  const Moments& moments, const SampleOutput& output, SegmentRun& run);

/// A row that was written, as recorded in the journal.
struct WrittenRow {
  std::uint32_t checksum = 0;
  std::size_t zeros = 0;  ///< normals that are (0, 0, 0)

  [[nodiscard]] static WrittenRow of(std::string_view bytes, std::size_t zeros);
  [[nodiscard]] std::string text() const;
};

/// The rows that earlier runs have written.
struct WrittenRows {
  std::vector<WrittenRow> rows;
  /// Set if the output itself already has all rows: the bytes after the last row. If these bytes are right, the output
  /// is complete and only the journal remains to be removed.
  std::optional<std::string> end = {};
};

/// Finds the rows of the journal that are in the file, and drops all other records. Each row has row_bytes bytes, and
/// the first follows the header. `count` is the number of rows of the whole output.
[[nodiscard]] Result<WrittenRows> find_written_rows(const std::string& output, std::string_view header,
                                                    std::size_t row_bytes, std::size_t count, Journal& journal);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_CONTINUED_SAMPLES_H_
