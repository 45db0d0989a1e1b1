/// Checks invariants of the result of every reader of motions and caches, for any bytes.
#ifndef CHRONORMAL_FUZZ_CACHE_INVARIANTS_H_
#define CHRONORMAL_FUZZ_CACHE_INVARIANTS_H_

#include <cmath>
#include <cstddef>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "io/cache/position_cache.h"
#include "mesh_invariants.h"

namespace chronormal::fuzz {

inline void check_error(const Error& error) {
  require(error.code == ErrorCode::kInvalidInput, "the code of an error is kInvalidInput");
  require(!error.place.empty(), "an error has a place");
  require(!error.message.empty(), "an error has a message");
}

/// Aborts unless `result` is correct for an input of byte_count bytes: either an error with a code, a place and a
/// message, or a cache of finite numbers with at most one position per byte of the input.
inline void check_cache_invariants(const Result<PositionCache>& result, std::size_t byte_count) {
  if (!result) return check_error(result.error());
  const PositionCache& cache = result.value();
  require(cache.vertex_count > 0 && !cache.samples.empty(), "a cache has vertices and samples");
  require(cache.samples.size() * cache.vertex_count <= byte_count, "a position takes a byte or more");
  for (const PositionCache::Sample& sample : cache.samples) {
    require(std::isfinite(sample.time), "times are finite");
    require(sample.positions.size() == 3 * cache.vertex_count, "every sample has all vertices");
    for (const float coordinate : sample.positions) require(std::isfinite(coordinate), "positions are finite");
  }
}

/// Aborts unless `result` is correct for an input of byte_count bytes: either an error with a code, a place and a
/// message, or a valid motion of at most most_per_byte * byte_count positions.
inline void check_motion_invariants(const Result<Motion>& result, std::size_t byte_count, std::size_t most_per_byte) {
  if (!result) return check_error(result.error());
  const Motion& motion = result.value();
  require(motion.keyframes.size() * motion.topology.vertex_count() <= most_per_byte * byte_count,
          "positions are there");
  require(motion.topology.corner_count() <= most_per_byte * byte_count, "corners are there");
  require(validate(motion).ok(), "a motion that was read is valid");
}

}  // namespace chronormal::fuzz

#endif  // CHRONORMAL_FUZZ_CACHE_INVARIANTS_H_
