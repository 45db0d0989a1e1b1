/// A loop that reads and writes as many bytes as an evaluation does, in the same order, and computes next to nothing:
/// what would be left if all arithmetic were free.
#ifndef BENCH_MEMORY_BARE_LOOP_H_
#define BENCH_MEMORY_BARE_LOOP_H_

#include <cstddef>

#include "chronormal/core/parallel.h"
#include "core/memory.h"

namespace chronormal::bench {

class BareLoop {
 public:
  /// Bytes that are read for each element.
  enum class Reads { kNothing = 0, kCompact = 20, kExact = 36 };

  /// Over `count` elements, rounded up to 16, with 12 bytes written for each. Tries the ways that there are (stores
  /// that stay in the caches or go past them, prefetch of several distances), and keeps the fastest one.
  BareLoop(Reads reads, std::size_t count, Threads threads);

  void run() const;

 private:
  Reads reads_;
  std::size_t blocks_;  // of 16 elements
  Threads threads_;
  int way_ = 0;
  AlignedArray<float> from_;
  mutable AlignedArray<float> to_;
};

}  // namespace chronormal::bench

#endif  // BENCH_MEMORY_BARE_LOOP_H_
