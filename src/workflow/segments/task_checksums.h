/// The checksums by which parts of one task are told from parts of another, taken of keyframes as a shard reads them.
/// Private to workflow.
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

/// The keyframes from which a shard of segments follows, and the one with which the next shard begins.
[[nodiscard]] std::set<std::size_t> keyframes_of_shard(const Motion& motion, const Shard& shard);

class KeyframeChecksums {
 public:
  /// Watches the stream, which must outlive this object.
  explicit KeyframeChecksums(MotionStream& stream) : stream_(stream) {}
  KeyframeChecksums(const KeyframeChecksums&) = delete;
  KeyframeChecksums& operator=(const KeyframeChecksums&) = delete;
  ~KeyframeChecksums() { (void)stream_.watch({}); }

  /// Takes checksums from now on. Errors: here and for each hold, kFailed for a keyframe that is read again and has
  /// other positions then.
  [[nodiscard]] Status begin();

  /// Reads what is missing of the keyframes that are needed, and adds the checksums of the keyframes and of all else in
  /// the motion. Errors: those of the stream.
  [[nodiscard]] Status finish(std::set<std::size_t> needed, TaskChecksums& result);

 private:
  [[nodiscard]] Status take(std::size_t keyframe, std::span<const float> positions);

  MotionStream& stream_;
  std::mutex mutex_;  // a keyframe that is read ahead is told of by another thread
  std::map<std::size_t, std::uint32_t> of_keyframe_;
};

/// The version of all parts, and what is said of a part that does not end with its checksum.
inline constexpr std::size_t kPartVersion = 6;
inline constexpr std::string_view kDamagedPart =
    "the part is damaged: its bytes do not have the checksum that it ends with";

/// Complains about a part of another version.
void check_part_version(const JsonView& part);

/// The member "checksums" of a part.
[[nodiscard]] TaskChecksums read_task_checksums(const JsonView& part);

/// Parts of one task, as far as their checksums tell.
class KnownParts {
 public:
  /// Errors: kUsage with the name of the part as the place, where it and one of the parts before are not of one task.
  [[nodiscard]] Status add(const std::string& part, const TaskChecksums& checksums);

 private:
  std::vector<std::string> parts_;
  std::map<std::string, std::pair<std::uint32_t, std::size_t>> first_;  // the first checksum of each name, and its part
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SEGMENTS_TASK_CHECKSUMS_H_
