/// A loop that reads and writes as many bytes as an evaluation does, in the same order, and computes next to nothing:
/// the time that would be left if all arithmetic were free.
#ifndef BENCH_MEMORY_BARE_LOOP_H_
#define BENCH_MEMORY_BARE_LOOP_H_

#include <cstddef>

#include "chronormal/core/parallel.h"
#include "core/memory.h"

namespace chronormal::bench {

class BareLoop {
 public:
  /// The bytes that are read for each element.
  enum class Reads { kNothing = 0, kCompact = 20, kExact = 36 };

  /// Runs over `count` elements, rounded up to 16, and writes 12 bytes for each. Tries stores that stay in the caches
  /// and stores that go past them, and several distances of prefetch, and keeps the fastest way.
  BareLoop(Reads reads, std::size_t count, Threads threads);

  void run() const;

 private:
  Reads reads_;
  std::size_t blocks_;  // each of 16 elements
  Threads threads_;
  int way_ = 0;
  AlignedArray<float> from_;
  mutable AlignedArray<float> to_;
};

}  // namespace chronormal::bench

#endif  // BENCH_MEMORY_BARE_LOOP_H_
