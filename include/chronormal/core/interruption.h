/// Computations that their caller ends in the middle.
#ifndef CHRONORMAL_CORE_INTERRUPTION_H_
#define CHRONORMAL_CORE_INTERRUPTION_H_

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <thread>

namespace chronormal {

/// Is thrown through a computation that was asked to end. It leaves files and the caller's memory half written, and
/// objects that are not const good for nothing but their destruction.
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

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_INTERRUPTION_H_
