/// Measures a loop that reads and writes as many bytes as an evaluation, in the same order, but computes almost
/// nothing. The time of the loop is the time that would remain if all arithmetic were free.
#ifndef BENCH_MEMORY_BARE_LOOP_H_
#define BENCH_MEMORY_BARE_LOOP_H_

#include <cstddef>

#include "chronormal/core/parallel.h"
#include "core/memory.h"

namespace chronormal::bench {

class BareLoop {
 public:
  /// The number of bytes that the loop reads for each element: no bytes, or as many as compact or exact curves take.
  enum class Reads { kNothing = 0, kCompact = 20, kExact = 36 };

  /// Prepares to run over `count` elements, rounded up to a multiple of 16, and to write 12 bytes for each. Tries
  /// stores that go through the caches or bypass them, with several distances of prefetch, and keeps the fastest
  /// combination.
  BareLoop(Reads reads, std::size_t count, Threads threads);

  void run() const;

 private:
  Reads reads_;
  std::size_t blocks_;  // number of blocks of 16 elements each
  Threads threads_;
  int way_ = 0;
  AlignedArray<float> from_;
  mutable AlignedArray<float> to_;
};

}  // namespace chronormal::bench

#endif  // BENCH_MEMORY_BARE_LOOP_H_
