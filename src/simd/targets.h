/// Which instruction set the kernels run on: chosen at run time, the widest that the machine has. For tests and
/// benchmarks, which go through all of them; results are the same bits on each.
#ifndef CHRONORMAL_SIMD_TARGETS_H_
#define CHRONORMAL_SIMD_TARGETS_H_

#include <cstdint>
#include <string>
#include <vector>

namespace chronormal::inline internal {

/// Those that the kernels are compiled for and that this machine runs, the best first. Values of Highway's HWY_TARGET.
[[nodiscard]] std::vector<std::int64_t> supported_targets();
/// As Highway names them: "SSE4", "AVX2", "AVX3" (AVX-512); without it there is one, "plain".
[[nodiscard]] std::string target_name(std::int64_t target);
/// The one that runs now.
[[nodiscard]] std::int64_t current_target();

/// Runs all kernels on one instruction set while it lives. Not while other threads run kernels.
class ScopedTarget {
 public:
  explicit ScopedTarget(std::int64_t target);
  ScopedTarget(const ScopedTarget&) = delete;
  ScopedTarget& operator=(const ScopedTarget&) = delete;
  ~ScopedTarget();
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SIMD_TARGETS_H_
