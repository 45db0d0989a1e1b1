/// A share of the segments of a motion, for many machines that divide one work: each computes its own, and what they found is
/// put together (workflow/parts.h) into what one machine would have found, to the last bit.
#ifndef CHRONORMAL_WORKFLOW_SHARD_H_
#define CHRONORMAL_WORKFLOW_SHARD_H_

#include <cassert>
#include <cstddef>

#include "chronormal/core/views.h"

namespace chronormal {

/// The index-th of count shares, from 0; as it stands, all of it.
struct Shard {
  std::size_t index = 0, count = 1;

  /// Its share of so many things in a row: all shares together have each of them once, in order, and as many as each
  /// other but for one.
  [[nodiscard]] IndexRange of(std::size_t total) const noexcept {
    assert(index < count);
    const auto begin = [&](std::size_t i) { return total / count * i + total % count * i / count; };
    return {begin(index), begin(index + 1) - begin(index)};
  }
  [[nodiscard]] bool is_all() const noexcept { return count == 1; }
};

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_SHARD_H_
