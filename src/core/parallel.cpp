#include "chronormal/core/parallel.h"

#include <algorithm>

#ifdef CHRONORMAL_HAVE_TBB
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace chronormal {
namespace {

constexpr std::size_t kMostThreads = 64;

thread_local std::size_t thread_limit = 0;  // of the innermost ThreadLimit, 0: none

}  // namespace

ThreadLimit::ThreadLimit(std::size_t threads) : before_(thread_limit) {
  thread_limit = std::clamp<std::size_t>(threads, 1, kMostThreads);
}

ThreadLimit::~ThreadLimit() { thread_limit = before_; }

#ifdef CHRONORMAL_HAVE_TBB

namespace {

// Whether the system lets this process have so many threads at once, beside the one that it has: by having them.
bool can_have_threads(std::size_t count) noexcept {
  std::atomic<bool> may_end = false;
  std::vector<std::thread> threads;
  bool all = true;
  try {
    threads.reserve(count);
    while (threads.size() < count) threads.emplace_back([&may_end] { may_end.wait(false); });
  } catch (const std::exception&) {  // no thread, or no memory for one
    all = false;
  }
  may_end = true;
  may_end.notify_all();
  for (std::thread& thread : threads) thread.join();
  return all;
}

// oneTBB does not go on where it cannot make the threads that it wants: so this is found out before it is asked.
bool has_threads() noexcept {
  static const bool found =
      can_have_threads(static_cast<std::size_t>(std::max(tbb::info::default_concurrency() - 1, 1)));
  return found;
}

}  // namespace

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count == 0) return;
  if (count == 1 || thread_limit == 1 || !has_threads()) {
    for (std::size_t i = 0; i < count; ++i) body(i);
  } else if (thread_limit == 0) {
    tbb::parallel_for(std::size_t{0}, count, [&body](std::size_t i) { body(i); });
  } else {
    // An arena beyond the number of cores gets its threads only where oneTBB may make that many; told once and for all,
    // since a new permission for each call often comes too late for it.
    static const tbb::global_control allowed(
        tbb::global_control::max_allowed_parallelism,
        std::max(kMostThreads, static_cast<std::size_t>(tbb::info::default_concurrency())));
    tbb::task_arena arena(static_cast<int>(thread_limit));
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, [&body](std::size_t i) { body(i); }); });
  }
}

std::size_t thread_count() noexcept {
  if (!has_threads()) return 1;
  if (thread_limit != 0) return thread_limit;
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

#else

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  for (std::size_t i = 0; i < count; ++i) body(i);
}

std::size_t thread_count() noexcept { return 1; }

#endif

}  // namespace chronormal
