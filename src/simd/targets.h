/// The instruction set on which the kernels run. The instruction set is chosen at run time, and is the widest that the
/// machine has. Tests and benchmarks try all instruction sets, and results have the same bits on each of them.
#ifndef CHRONORMAL_SIMD_TARGETS_H_
#define CHRONORMAL_SIMD_TARGETS_H_

#include <cstdint>
#include <string>
#include <vector>

namespace chronormal::inline internal {

/// Returns the instruction sets that the kernels are compiled for and that this machine runs, the best first. The
/// results are values of Highway's HWY_TARGET.
[[nodiscard]] std::vector<std::int64_t> supported_targets();
/// Returns the name that Highway has for a target: "SSE4", "AVX2", "AVX3" (AVX-512); without Highway there is only
/// "plain".
[[nodiscard]] std::string target_name(std::int64_t target);
/// Returns the instruction set on which the kernels run now.
[[nodiscard]] std::int64_t current_target();

/// A scope in which all kernels run on one instruction set. Other threads must not run kernels meanwhile.
class ScopedTarget {
 public:
  explicit ScopedTarget(std::int64_t target);
  ScopedTarget(const ScopedTarget&) = delete;
  ScopedTarget& operator=(const ScopedTarget&) = delete;
  ~ScopedTarget();
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SIMD_TARGETS_H_
