/// A share of the segments of a motion, for many machines that divide one task: each machine computes its own shard,
/// and the results are joined (workflow/parts.h) into what one machine would have found, to the last bit.
#ifndef CHRONORMAL_WORKFLOW_SHARD_H_
#define CHRONORMAL_WORKFLOW_SHARD_H_

#include <cassert>
#include <cstddef>

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

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_SHARD_H_
