/// Measures how fast this machine reads memory and streams through it, at the working set of a benchmark.
///
/// Each figure is the best of several methods, on one thread, with the widest vectors that the machine has:
///
///     read     all bytes are added up; with software prefetch and without
///     stream   copy, one half to the other, and triad a = b + s c, in thirds; with ordinary stores, with stores past
///              the caches, and with prefetch; all bytes read and written count
///
/// The bytes of a working set are rounded to a power of 1.2. Working sets above 256 MiB are measured at 256 MiB, since
/// they all lie in DRAM.
#ifndef BENCH_MEMORY_BANDWIDTH_H_
#define BENCH_MEMORY_BANDWIDTH_H_

#include <cstddef>
#include <map>
#include <vector>

#include "core/memory.h"
#include "measure/timing.h"

namespace chronormal::bench {

struct Bandwidth {
  std::size_t bytes = 0;  ///< size of the working set
  double read = 0;        ///< bandwidth of reading in GB/s
  double stream = 0;      ///< bandwidth of streaming in GB/s
  double copy = 0;        ///< GB/s of the best copy; `stream` may be larger
};

class BandwidthMeter {
 public:
  /// Requests a measurement of the bandwidth for a working set of this many bytes. append() adds the functions that
  /// measure this bandwidth.
  void want(std::size_t working_set);
  /// Appends to `functions` the functions that measure the bandwidths for which want() asked.
  void append(std::vector<Timed>& functions);
  /// Reads the measured times of the functions that append() added last. `first` is the index in `functions` of the
  /// first function that append() added.
  void take(const std::vector<Timed>& functions, std::size_t first);

  /// Returns the bandwidth at a working set for which want() asked. Call take() before.
  [[nodiscard]] Bandwidth at(std::size_t working_set) const;
  [[nodiscard]] std::vector<Bandwidth> all() const;

 private:
  AlignedBytes arena_;
  // The bandwidths for which want() asked. The key is the working set in bytes, rounded. An entry has no figures until
  // its bandwidth is measured.
  std::map<std::size_t, Bandwidth> measured_;
};

}  // namespace chronormal::bench

#endif  // BENCH_MEMORY_BANDWIDTH_H_
