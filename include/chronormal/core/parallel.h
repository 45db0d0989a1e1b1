/// A parallel loop over independent pieces of work, on all cores.
#ifndef CHRONORMAL_CORE_PARALLEL_H_
#define CHRONORMAL_CORE_PARALLEL_H_

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <thread>

namespace chronormal {

// Classes and a function by which the caller of a long computation can end the computation early.

/// The exception that ends a computation at the caller's request. Afterwards files and memory that the computation was
/// writing are incomplete. An object whose non-const function was interrupted may only be destroyed.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// Lets a callback end the computations that this thread starts during the object's lifetime. The callback is called
/// between the pieces of every parallel_for, while this thread waits for other threads, and in check_interruption().
/// Computations that other threads start are not affected.
///
/// Threads    the thread that made this object calls `ask`, without holding a lock, at most every 50 ms. When `ask`
///            returns true, all threads of the computation throw Interrupted, and so does the function that was called.
/// Limits     may be nested; only the innermost is used.
class Interruption {
 public:
  explicit Interruption(std::function<bool()> ask);
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption();

 private:
  friend void check_interruption();

  std::function<bool()> ask_;
  std::thread::id asker_;
  std::chrono::steady_clock::time_point next_;
  std::atomic<bool> is_asked_to_end_ = false;
  Interruption* before_;
};

/// Throws Interrupted if an Interruption asks this thread's computation to end. Does nothing if there is no
/// Interruption.
void check_interruption();

/// Calls body(i) once for every i in [0, count), in any order and from several threads at once; returns when all calls
/// are done. The first exception that body throws is thrown again by parallel_for(). All threads use this thread's
/// rounding mode.
///
/// Threads    the threads of one pool, which are created when first needed; if the system grants fewer threads, the
///            loop uses those that it gets. A body may call parallel_for, whose loop shares the threads of the outer
///            one. A child of fork() has one thread, and a loop that was running on several threads ends with
///            Interrupted in the child. In wasm there is one thread.
/// Order      results must not depend on the order of the calls: write to slot i, and combine the slots in order
///            afterwards.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// The threads that a function uses: only the calling thread, or all cores if there is enough work.
enum class Threads { kOne, kAll };

/// Returns the number of threads that a parallel_for() called by this thread may use.
[[nodiscard]] std::size_t thread_count() noexcept;

/// Sets the number of threads that parallel_for() uses on this thread during the object's lifetime. The number may
/// exceed the number of cores, up to 64. Tests, benchmarks, and programs that reserve some cores use this class. Nested
/// loops share these threads. Objects may be nested; only the innermost is used. If the system grants no threads, loops
/// run on the calling thread.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t threads);
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;
  ~ThreadLimit();

 private:
  std::size_t before_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_PARALLEL_H_
