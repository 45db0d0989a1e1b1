/// Shares of a task, for many machines that divide one motion: each computes its own, and merge joins the results
/// (workflow/json/parts.h) into what one machine would have found, to the last bit; and how processes that compute
/// together talk to each other. Private to workflow and the program.
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

/// The index-th of count shares, from 0. By default a shard is everything.
struct Shard {
  std::size_t index = 0, count = 1;

  /// The share of a row of `total` things that this shard has. All shards together have each thing once and in order,
  /// and their sizes differ by at most one.
  [[nodiscard]] IndexRange of(std::size_t total) const noexcept {
    assert(index < count);
    const auto begin = [&](std::size_t i) { return total / count * i + total % count * i / count; };
    return {begin(index), begin(index + 1) - begin(index)};
  }
  [[nodiscard]] bool is_all() const noexcept { return count == 1; }
};

/// Processes that do one task together, each its own shard: they can send texts and numbers to each other, by whatever
/// the program has for that, such as MPI. Every process makes the same calls in the same order. One that fails makes
/// none any more, and its program must end the others.
struct Peers {
  /// Returns in the process of the first shard the texts of all, in the order of the shards, once all have called this;
  /// in the others nothing.
  std::function<std::vector<std::string>(const std::string& own)> gather;
  /// Returns in every process the text of the first.
  std::function<std::string(const std::string& of_first)> broadcast;
  /// Makes each number the largest of those that all processes have in its place; all have as many.
  std::function<void(std::span<double> numbers)> maximize = {};
};

/// Checksums of everything that the result of a shard depends on, by name ("the faces", "the options", "keyframe 3").
/// Shards of one task have the same checksum for every name that they share. A keyframe is there where the shard has
/// read it: those that it needs, the first and the last one, and the one with which the next shard begins, which tie
/// shards together that have no other keyframe in common; all of them where they are few (MotionStream::keeps_all()).
using TaskChecksums = std::map<std::string, std::uint32_t, std::less<>>;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SEGMENTS_SHARDS_H_
