/// One loop over independent pieces of work, on all cores.
#ifndef CHRONORMAL_CORE_PARALLEL_H_
#define CHRONORMAL_CORE_PARALLEL_H_

#include <cstddef>
#include <functional>

namespace chronormal {

/// Calls body(i) once for every i in [0, count), in any order and from several threads at once; returns when all are
/// done. The first exception that body throws is thrown here. Over oneTBB; one after the other in a build without it.
/// A result must not depend on the order: write to slot i, and combine the slots in order afterwards.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// How many threads parallel_for may use.
[[nodiscard]] std::size_t thread_count() noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_PARALLEL_H_
