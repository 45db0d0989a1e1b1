#include "chronormal/core/parallel.h"

#ifdef CHRONORMAL_HAVE_TBB
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace chronormal {

#ifdef CHRONORMAL_HAVE_TBB

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(std::size_t{0}, count, [&body](std::size_t i) { body(i); });
}

std::size_t thread_count() noexcept { return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()); }

#else

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  for (std::size_t i = 0; i < count; ++i) body(i);
}

std::size_t thread_count() noexcept { return 1; }

#endif

}  // namespace chronormal
