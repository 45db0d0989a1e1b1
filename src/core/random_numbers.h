/// Random numbers that are the same with every standard library.
#ifndef CHRONORMAL_CORE_RANDOM_NUMBERS_H_
#define CHRONORMAL_CORE_RANDOM_NUMBERS_H_

#include <algorithm>
#include <cstddef>
#include <random>

namespace chronormal::inline internal {

/// Returns a random number in [0, 1).
[[nodiscard]] inline double random_part(std::mt19937& random) { return static_cast<double>(random()) / 4294967296.0; }

/// Returns a random index below count, which must not be 0.
[[nodiscard]] inline std::size_t random_below(std::mt19937& random, std::size_t count) {
  return std::min(count - 1, static_cast<std::size_t>(random_part(random) * static_cast<double>(count)));
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_RANDOM_NUMBERS_H_
