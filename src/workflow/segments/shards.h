/// Shares of a task, for many machines that divide one motion. Each machine computes its share, and merge joins the
/// results (workflow/json/parts.h) into the result of one machine, to the last bit. Also declares how processes that
/// compute together communicate. Private to workflow and the program.
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

/// A share of a task: number `index`, from 0, of `count` shares. The default is the whole task.
struct Shard {
  std::size_t index = 0, count = 1;

  /// Returns the range of this shard among `total` items. All shards together have each item once and in order, and
  /// their sizes differ by at most one.
  [[nodiscard]] IndexRange of(std::size_t total) const noexcept {
    assert(index < count);
    const auto begin = [&](std::size_t i) { return total / count * i + total % count * i / count; };
    return {begin(index), begin(index + 1) - begin(index)};
  }
  [[nodiscard]] bool is_all() const noexcept { return count == 1; }
};

/// Processes that do one task together, each for its own shard. They exchange texts and numbers through the program,
/// for example by MPI. Every process makes the same calls in the same order. A process that fails makes no more calls,
/// and its program must end the other processes.
struct Peers {
  /// Returns the texts of all shards, in their order, in the process of the first shard, once all have called this;
  /// returns nothing in the others.
  std::function<std::vector<std::string>(const std::string& own)> gather;
  /// Returns the text of the first process in every process.
  std::function<std::string(const std::string& of_first)> broadcast;
  /// Replaces each number by the largest that any process has in its place. All processes must pass the same count.
  std::function<void(std::span<double> numbers)> maximize = {};
};

/// Checksums of all data that the result of a shard depends on, by name ("the faces", "the options", "keyframe 3").
/// Shards of one task have the same checksum for every name that they share. A keyframe is listed if the shard has read
/// it. A shard reads the keyframes that it needs, and, to connect shards that have no other keyframe in common, the
/// first and the last keyframe and the one with which the next shard begins; or all keyframes if they are few
/// (MotionStream::keeps_all()).
using TaskChecksums = std::map<std::string, std::uint32_t, std::less<>>;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SEGMENTS_SHARDS_H_
