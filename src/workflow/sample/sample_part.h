/// The text at the end of the .npy file that a shard of samples writes. The text follows the elements of the array,
/// where NumPy does not look:
///
///     {"chronormal_part":6,"command":"sample","first":10,"total":40,"array":305441741,"checksums":{"keyframe 0":7,
///     ...},"checksum":"1a2b3c4d"}
///
/// The text is one line. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_SAMPLE_PART_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_SAMPLE_PART_H_

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/workflow/sample.h"
#include "workflow/segments/task_checksums.h"

namespace chronormal::inline internal {

/// The largest length, in bytes, of the text at the end of a shard's file. The text has less than 40 bytes for each
/// keyframe.
inline constexpr std::uint64_t kLongestEndOfPart = std::uint64_t{1} << 28;

struct SamplePart {
  std::uint64_t first = 0;  ///< the index of this part's first row among all rows
  std::uint64_t total = 0;  ///< the number of rows of all shards
  std::uint32_t array = 0;  ///< the checksum of the bytes before this text: of the header, and of all rows
  TaskChecksums checksums = {};

  [[nodiscard]] std::string text() const;
  /// Reads the text at the end of a shard's file. `name` is the name of the file for messages. Errors: kInvalidInput if
  /// the text is not what a shard writes.
  [[nodiscard]] static Result<SamplePart> read(std::string_view text, const std::string& name);
};

/// Returns a checksum of the options and the moments of a sampling.
[[nodiscard]] std::uint32_t checksum_of_options(const SampleOptions& options, const Moments& moments);

/// Returns the keyframes on which the moments of a shard depend, and the keyframes with which the next shard begins.
/// The moments must belong to the motion.
[[nodiscard]] std::set<std::size_t> keyframes_of_moments(const Motion& motion, const Moments& moments,
                                                         const Shard& shard);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_SAMPLE_PART_H_
