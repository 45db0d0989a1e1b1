/// Samples that a process writes with others, as a share, or behind the rows that an interrupted run wrote already.
/// Private to workflow and the program.
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

/// The files that `count` moments are written to. Of several shards, other files may be there. Errors: also kUsage for
/// a shard of .npz, and for peers and a stream.
[[nodiscard]] Result<std::vector<std::string>> sample_files(const SampleOutput& output, ElementKind kind,
                                                            std::size_t count, const SegmentRun& run);

/// write_samples() as the run has it, of which each moment is a segment:
///
///     shard      its share of the moments: .ply and .obj files with the numbers that they would have among all, or
///                .npy with as many rows (workflow/json/parts.h joins them). The bits are those of one run
///     peers      the shards have one output among them, which no one sees before all are done: a .npy or .npz file
///                that every process writes its rows into, or .ply and .obj files. The first process gets the summary
///                of all, and each of the others its own
///     journal    each row of a .npy file gets a record. The file is OUT.partial until it is whole. Rows that the
///                journal of an earlier run has, and that are in the file with the same checksum, are not computed
///                again. The journal stays; the caller removes it
///
/// Errors: also those of the journal; kUsage for a journal with another format or a stream; kFailed where OUT.partial
/// is no such array.
[[nodiscard]] Result<SampleSummary> write_samples(MotionStream& stream, const SampleOptions& options,
                                                  const Moments& moments, const SampleOutput& output, SegmentRun& run);

/// A row that was written, as the journal has it.
struct WrittenRow {
  std::uint32_t checksum = 0;
  std::size_t zeros = 0;  ///< normals that are (0, 0, 0)

  [[nodiscard]] static WrittenRow of(std::string_view bytes, std::size_t zeros);
  [[nodiscard]] std::string text() const;
};

/// What earlier runs left.
struct WrittenRows {
  std::vector<WrittenRow> rows;
  /// What follows the last row in the output itself, where that is there with all rows: then nothing is left to do but
  /// to remove the journal, if this is how the output ends.
  std::optional<std::string> end = {};
};

/// Finds the rows of the journal that are in the file, each of row_bytes bytes behind the header, and drops the other
/// records. `count` is the number of rows of the whole output.
[[nodiscard]] Result<WrittenRows> find_written_rows(const std::string& output, std::string_view header,
                                                    std::size_t row_bytes, std::size_t count, Journal& journal);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_CONTINUED_SAMPLES_H_
