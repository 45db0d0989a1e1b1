/// Computes checksums that show whether two parts (files of shards) belong to the same task. The checksums are computed
/// while a shard reads keyframes. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_SEGMENTS_TASK_CHECKSUMS_H_
#define CHRONORMAL_WORKFLOW_SEGMENTS_TASK_CHECKSUMS_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/json/json.h"
#include "workflow/segments/shards.h"

namespace chronormal::inline internal {

/// Returns the keyframes that the segments of a shard need, and the keyframe with which the next shard begins.
[[nodiscard]] std::set<std::size_t> keyframes_of_shard(const Motion& motion, const Shard& shard);

class KeyframeChecksums {
 public:
  /// Creates an object for the keyframes of a stream. The stream must outlive the object.
  explicit KeyframeChecksums(MotionStream& stream) : stream_(stream) {}
  KeyframeChecksums(const KeyframeChecksums&) = delete;
  KeyframeChecksums& operator=(const KeyframeChecksums&) = delete;
  ~KeyframeChecksums() { (void)stream_.watch({}); }

  /// Starts to compute checksums of the keyframes that the stream reads. Errors: here and in each later hold() of the
  /// stream, kFailed if a keyframe is read again with different positions.
  [[nodiscard]] Status begin();

  /// Reads those keyframes in `needed` that have not been read yet. Adds the checksums of all keyframes in `needed`,
  /// and of all other data of the motion, to the result. Errors: those of the stream.
  [[nodiscard]] Status finish(std::set<std::size_t> needed, TaskChecksums& result);

 private:
  [[nodiscard]] Status take(std::size_t keyframe, std::span<const float> positions);

  MotionStream& stream_;
  std::mutex mutex_;  // guards of_keyframe_, since another thread reports keyframes that it reads ahead
  std::map<std::size_t, std::uint32_t> of_keyframe_;
};

/// The version of the format of parts, and the message for a part whose checksum is wrong.
inline constexpr std::size_t kPartVersion = 6;
inline constexpr std::string_view kDamagedPart =
    "the shard is damaged, since its checksum is wrong; run this shard again";

/// Records an error in `part` if the part has another version of the format than kPartVersion.
void check_part_version(const JsonView& part);

/// Returns the member "checksums" of a part (the file of a shard).
[[nodiscard]] TaskChecksums read_task_checksums(const JsonView& part);

/// The parts of one task that were read so far. The checksums of the parts show that they belong to the same task.
class KnownParts {
 public:
  /// Adds a part by its name and its checksums. Errors: kUsage if this part and an earlier part belong to different
  /// tasks; the place of the error is the name of this part.
  [[nodiscard]] Status add(const std::string& part, const TaskChecksums& checksums);

 private:
  std::vector<std::string> parts_;
  // For each name of a checksum, the first checksum with this name, and the index of the part that has it.
  std::map<std::string, std::pair<std::uint32_t, std::size_t>> first_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SEGMENTS_TASK_CHECKSUMS_H_
