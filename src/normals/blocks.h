/// Elements in blocks, one after the other or on all cores.
#ifndef CHRONORMAL_NORMALS_BLOCKS_H_
#define CHRONORMAL_NORMALS_BLOCKS_H_

#include <algorithm>
#include <cstddef>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"

namespace chronormal {

/// Calls body(range) for ranges of up to `block` indices that cover [0, count).
template <class Body>
void parallel_blocks(std::size_t count, std::size_t block, Body body) {
  parallel_for((count + block - 1) / block, [&](std::size_t i) {
    body(IndexRange{i * block, std::min(block, count - i * block)});
  });
}

/// The same on all cores, or body of the whole range on this one.
template <class Body>
void blocks_on(Threads threads, std::size_t count, std::size_t block, Body body) {
  if (threads == Threads::kOne) {
    body(IndexRange{0, count});
  } else {
    parallel_blocks(count, block, body);
  }
}

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_BLOCKS_H_
