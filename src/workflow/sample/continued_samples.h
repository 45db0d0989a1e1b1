/// Writes samples together with other processes, as a share of the work, or in continuation of an interrupted run.
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

/// Returns the names of the files to write for `count` moments, and checks that these files may be written. If the run
/// is a shard, files of other shards may exist already. Errors: those of a run that is not divided; kUsage for a shard
/// that writes a .npz file, and for an output stream that several processes share.
[[nodiscard]] Result<std::vector<std::string>> sample_files(const SampleOutput& output, ElementKind kind,
                                                            std::size_t count, const SegmentRun& run);

/// Runs write_samples() on the share of the run, in which each moment is a segment:
///
///     shard      The run writes its share of the moments. .ply and .obj files have the numbers that they would have
///                among all files. A .npy file has as many rows as the share has moments (workflow/json/parts.h joins
///                such files). The bits are the same as in one run.
///     peers      The shards share one output, which becomes visible when all shards are done. Every process writes its
///                rows into the same .npy or .npz file, or writes its .ply and .obj files. The first process returns
///                the summary of all processes, and each other process its own summary.
///     journal    Each row of a .npy file gets a record in the journal. The file has the name OUT.partial until it is
///                complete. A row is not computed again if the journal of an earlier run and the file have this row
///                with the same checksum. The caller removes the journal.
///
/// Errors: also the errors of the journal; kUsage for a journal if the output has another format or is a stream;
/// kFailed if OUT.partial is not such an array.
[[nodiscard]] Result<SampleSummary> write_samples(MotionStream& stream, const SampleOptions& options,
                                                  const Moments& moments, const SampleOutput& output, SegmentRun& run);

/// A row of normals in the output, as the journal records it.
struct WrittenRow {
  std::uint32_t checksum = 0;
  std::size_t zeros = 0;  ///< the number of normals that are (0, 0, 0)

  [[nodiscard]] static WrittenRow of(std::string_view bytes, std::size_t zeros);
  [[nodiscard]] std::string text() const;
};

/// The rows of the output that earlier runs wrote.
struct WrittenRows {
  std::vector<WrittenRow> rows;
  /// The bytes that follow the last row, if the output itself already has all rows. If the file has these bytes, the
  /// output is complete and only the journal remains to be removed.
  std::optional<std::string> end = {};
};

/// Finds the rows of the journal that are in the file. Removes all other rows from the journal. Each row has row_bytes
/// bytes, and the first row follows the header. `count` is the number of rows of the whole output.
[[nodiscard]] Result<WrittenRows> find_written_rows(const std::string& output, std::string_view header,
                                                    std::size_t row_bytes, std::size_t count, Journal& journal);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_CONTINUED_SAMPLES_H_
