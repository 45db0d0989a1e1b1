/// One loop over independent pieces of work, on all cores.
#ifndef CHRONORMAL_CORE_PARALLEL_H_
#define CHRONORMAL_CORE_PARALLEL_H_

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <thread>

namespace chronormal {

// A computation can be ended in the middle by its caller.

/// Is thrown through a computation that was asked to end. Files and the caller's memory are left half written, and
/// objects that are not const may only be destroyed.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// While it lives, the computations that this thread starts ask it whether to end: between the pieces of every
/// parallel_for, while this thread waits for other threads, and wherever check_interruption() stands. Computations that
/// other threads start do not.
///
/// Threads    the thread that made this calls `ask`, with no lock held, at most every 50 ms. Where `ask` returns true,
///            all threads of the computation throw Interrupted, and so does the function that was called.
/// Limits     may be nested; the innermost counts.
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

/// Throws Interrupted where the computation that this thread works for is to end; does nothing without an Interruption.
void check_interruption();

/// Calls body(i) once for every i in [0, count), in any order and from several threads at once; returns when all are
/// done. The first exception that body throws is thrown here. All threads round as this one does.
///
/// Threads    those of one pool, which are made when they are first asked for; where the system grants fewer, the loop
///            runs on these. A body may call parallel_for, whose loop shares the threads of the outer one. A child of
///            fork() has one thread, and a loop that was under way on several ends with Interrupted there. In wasm
///            there is one thread.
/// Order      a result must not depend on it: write to slot i, and combine the slots in order afterwards.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Selects the thread that calls a function, or all cores where there is enough to do.
enum class Threads { kOne, kAll };

/// Returns the number of threads that parallel_for may use.
[[nodiscard]] std::size_t thread_count() noexcept;

/// Sets the number of threads of parallel_for on this thread while it lives; it may be more than there are cores (64 at
/// most). It serves tests, benchmarks, and programs that want some cores for themselves. Loops inside its loops share
/// these threads. Limits may be nested; the innermost counts. If the system grants no threads, there is one whatever
/// the limit.
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
