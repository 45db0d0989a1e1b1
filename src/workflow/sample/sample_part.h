/// How the .npy file of a shard of samples ends, behind its elements, where NumPy does not look:
///
///     {"chronormal_part":6,"command":"sample","first":10,"total":40,"array":305441741,"checksums":{"keyframe 0":7,
///     ...},"checksum":"1a2b3c4d"}
///
/// in one line. Private to workflow.
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

/// Longer than the end of any part: keyframes take less than 40 bytes each.
inline constexpr std::uint64_t kLongestEndOfPart = std::uint64_t{1} << 28;

struct SamplePart {
  std::uint64_t first = 0;  ///< the number of the first row among all
  std::uint64_t total = 0;  ///< how many rows there are in all
  std::uint32_t array = 0;  ///< the checksum of the bytes before this text: the header, and all rows
  TaskChecksums checksums = {};

  [[nodiscard]] std::string text() const;
  /// Reads such a text, at the end of the file of that name. Errors: kInvalidInput.
  [[nodiscard]] static Result<SamplePart> read(std::string_view text, const std::string& name);
};

/// The checksum of what is computed, and when.
[[nodiscard]] std::uint32_t checksum_of_options(const SampleOptions& options, const Moments& moments);

/// The keyframes that the moments of a shard follow from, and those with which the next shard begins. The moments must
/// be of the motion
[[nodiscard]] std::set<std::size_t> keyframes_of_moments(const Motion& motion, const Moments& moments,
                                                         const Shard& shard);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_SAMPLE_PART_H_
