/// Loops over blocks of indices, on this thread or on all cores. The blocks are the same for every number of threads.
#ifndef CHRONORMAL_CORE_BLOCKS_H_
#define CHRONORMAL_CORE_BLOCKS_H_

#include <algorithm>
#include <cstddef>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"

namespace chronormal::inline internal {

[[nodiscard]] constexpr std::size_t block_count(std::size_t count, std::size_t block) noexcept {
  return (count + block - 1) / block;
}

/// Calls body(range) on all cores, for ranges of up to `block` indices that together cover [0, count).
template <class Body>
void parallel_blocks(std::size_t count, std::size_t block, Body body) {
  parallel_for(block_count(count, block), [&](std::size_t i) {
    body(IndexRange{i * block, std::min(block, count - i * block)});
  });
}

/// Calls body(i, first, last) on all cores for the ranges [first, last) of up to `block` indices, where i is the number
/// of the range. A single range runs on this thread, since it is not worth a task.
template <class Body>
void numbered_blocks(std::size_t count, std::size_t block, const Body& body) {
  if (count == 0) return;
  if (count <= block) return body(std::size_t{0}, std::size_t{0}, count);
  parallel_for(block_count(count, block), [&](std::size_t i) { body(i, i * block, std::min(count, (i + 1) * block)); });
}

/// Calls body(i) for every i in [0, count), in blocks on all cores.
template <class Body>
void parallel_each(std::size_t count, std::size_t block, const Body& body) {
  numbered_blocks(count, block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

/// Calls body(i, result) for every i in [0, count), in blocks on all cores. Each block has its own result. Then calls
/// merge(all, result) with the result of each block, in the order of the blocks, and returns `all`.
template <class T, class Body, class Merge>
[[nodiscard]] T parallel_fold(std::size_t count, std::size_t block, const Body& body, const Merge& merge) {
  std::vector<T> of_blocks(block_count(count, block));
  numbered_blocks(count, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i, of_blocks[b]);
  });
  T all{};
  for (const T& of_block : of_blocks) merge(all, of_block);
  return all;
}

/// Calls body(range) for blocks on all cores, or once for the whole range on this thread if `threads` is kOne or if
/// there is only one block.
template <class Body>
void blocks_on(Threads threads, std::size_t count, std::size_t block, Body body) {
  if (threads == Threads::kOne || (0 < count && count <= block)) {
    body(IndexRange{0, count});
  } else {
    parallel_blocks(count, block, body);
  }
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_BLOCKS_H_
