/// Samples of which an interrupted run wrote some rows already. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_CONTINUED_SAMPLES_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_CONTINUED_SAMPLES_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/workflow/sample.h"
#include "io/bytes/journal.h"

namespace chronormal::inline internal {

/// write_samples() (chronormal/workflow/sample.h) into a .npy file, of which each row that is written gets a record of
/// the journal. The file is OUT.partial until it is whole. Rows that the journal of an earlier run has, and that are in
/// the file with the same checksum, are not computed again. The journal stays; the caller removes it. Errors: also
/// those of the journal; kUsage for another format or a stream; kFailed where OUT.partial is no such array.
[[nodiscard]] Result<SampleSummary> continue_samples(
    MotionStream& stream, const SampleOptions& options, const Moments& moments, const SampleOutput& output,
    Journal& journal, const std::function<void(std::size_t done, std::size_t total)>& progress = {});

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
