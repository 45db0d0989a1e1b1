/// Divides a task into shares, so that many machines can work on one motion. Each machine computes its share, and merge
/// (workflow/json/parts.h) joins the results. The joined result has the same bits as the result of a single machine.
/// Also declares how processes that compute together communicate. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_SEGMENTS_SHARDS_H_
#define CHRONORMAL_WORKFLOW_SEGMENTS_SHARDS_H_

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/views.h"

namespace chronormal::inline internal {

/// A share of a task. The shares have the numbers 0 to count - 1. The default is the whole task.
struct Shard {
  std::size_t index = 0, count = 1;

  /// Returns the range of this shard among `total` items. The ranges of all shards follow each other without gaps, and
  /// their sizes differ by at most one.
  [[nodiscard]] IndexRange of(std::size_t total) const noexcept {
    assert(index < count);
    const auto begin = [&](std::size_t i) { return total / count * i + total % count * i / count; };
    return {begin(index), begin(index + 1) - begin(index)};
  }
  [[nodiscard]] bool is_all() const noexcept { return count == 1; }
};

/// The processes that do one task together. Each process has its own shard. The processes exchange texts and numbers
/// through the program, for example by MPI. Every process makes the same calls in the same order. A process that fails
/// makes no more calls, and its program must end the other processes.
struct Peers {
  /// Waits until every process has called this function. In the process of the first shard, returns the texts of all
  /// shards, in order. In all other processes, returns nothing.
  std::function<std::vector<std::string>(const std::string& own)> gather;
  /// Returns in every process the text that the first process passes.
  std::function<std::string(const std::string& of_first)> broadcast;
  /// Replaces each number by the largest number that any process has at the same index. All processes must pass the
  /// same count.
  std::function<void(std::span<double> numbers)> maximize = {};
};

/// Checksums of all data on which the result of a shard depends, by name ("the faces", "the options", "keyframe 3"). If
/// two shards of one task both have a checksum with some name, the two checksums are equal.
///
/// A shard lists the keyframes that it has read. If the stream keeps all keyframes in memory
/// (MotionStream::keeps_all()), the shard lists all keyframes. Otherwise it lists the keyframes of its segments, the
/// first and the last keyframe, and the keyframe with which the next shard begins. For this reason two neighbouring
/// shards have a keyframe in common.
using TaskChecksums = std::map<std::string, std::uint32_t, std::less<>>;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SEGMENTS_SHARDS_H_
