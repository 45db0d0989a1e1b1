/// A share of the segments of a motion, for many machines that divide one task: each machine computes its own shard,
/// and the results are joined (workflow/parts.h) into what one machine would have found, to the last bit.
#ifndef CHRONORMAL_WORKFLOW_SHARD_H_
#define CHRONORMAL_WORKFLOW_SHARD_H_

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "chronormal/core/views.h"

namespace chronormal {

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

/// Checksums of everything that the result of a shard depends on, by name ("the faces", "the options", "keyframe 3").
/// Shards of one task have the same checksum for every name that they share. A keyframe is there where the shard has
/// read it: those that it needs, the first and the last one, and the one with which the next shard begins, which tie
/// shards together that have no other keyframe in common; all of them where they are few (MotionStream::keeps_all()).
using TaskChecksums = std::map<std::string, std::uint32_t, std::less<>>;

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_SHARD_H_
