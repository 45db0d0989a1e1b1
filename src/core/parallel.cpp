#include "chronormal/core/parallel.h"

#include <algorithm>
#include <utility>

#include "chronormal/core/interruption.h"

#ifdef CHRONORMAL_HAVE_TBB
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#if __has_include(<pthread.h>)
#include <pthread.h>
#endif

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace chronormal {
namespace {

constexpr std::size_t kMostThreads = 64;

thread_local std::size_t thread_limit = 0;          // of the innermost ThreadLimit, 0: none
thread_local Interruption* interruption = nullptr;  // of the computation that this thread works for

constexpr std::chrono::milliseconds kBetweenQuestions(50);

// While it lives, this thread works for the computation of an Interruption, or for one that nobody ends.
class InterruptionScope {
 public:
  explicit InterruptionScope(Interruption* of) : before_(std::exchange(interruption, of)) {}
  InterruptionScope(const InterruptionScope&) = delete;
  InterruptionScope& operator=(const InterruptionScope&) = delete;
  ~InterruptionScope() { interruption = before_; }

 private:
  Interruption* before_;
};

}  // namespace

Interruption::Interruption(std::function<bool()> ask)
    : ask_(std::move(ask)),
      asker_(std::this_thread::get_id()),
      next_(std::chrono::steady_clock::now() + kBetweenQuestions),
      before_(std::exchange(interruption, this)) {}

Interruption::~Interruption() { interruption = before_; }

void check_interruption() {
  Interruption* const asked = interruption;
  if (asked == nullptr) return;
  if (!asked->is_asked_to_end_ && asked->asker_ == std::this_thread::get_id() &&
      std::chrono::steady_clock::now() >= asked->next_) {
    if (asked->ask_()) asked->is_asked_to_end_ = true;
    asked->next_ = std::chrono::steady_clock::now() + kBetweenQuestions;
  }
  if (asked->is_asked_to_end_) throw Interrupted();
}

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

// A child that fork() made has one thread. Where oneTBB has been asked for others before, it goes on waiting for them
// there.
std::atomic<bool> has_asked_for_threads = false, has_lost_threads = false;
#if __has_include(<pthread.h>)
[[maybe_unused]] const int kHeardOfForks = pthread_atfork(nullptr, nullptr, [] {
  if (has_asked_for_threads) has_lost_threads = true;
});
#endif

// oneTBB does not go on where it cannot make the threads that it wants: so this is found out before it is asked.
bool has_threads() noexcept {
  if (has_lost_threads) return false;
  has_asked_for_threads = true;
  static const bool found =
      can_have_threads(static_cast<std::size_t>(std::max(tbb::info::default_concurrency() - 1, 1)));
  return found;
}

}  // namespace

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count == 0) return;
  const auto piece = [&body, of = interruption](std::size_t i) {
    const InterruptionScope scope(of);
    check_interruption();
    body(i);
  };
  if (count == 1 || thread_limit == 1 || !has_threads()) {
    for (std::size_t i = 0; i < count; ++i) piece(i);
  } else if (thread_limit == 0) {
    tbb::parallel_for(std::size_t{0}, count, piece);
  } else {
    // An arena beyond the number of cores gets its threads only where oneTBB may make that many; told once and for all,
    // since a new permission for each call often comes too late for it.
    static const tbb::global_control allowed(
        tbb::global_control::max_allowed_parallelism,
        std::max(kMostThreads, static_cast<std::size_t>(tbb::info::default_concurrency())));
    tbb::task_arena arena(static_cast<int>(thread_limit));
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, piece); });
  }
}

std::size_t thread_count() noexcept {
  if (!has_threads()) return 1;
  if (thread_limit != 0) return thread_limit;
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

#else

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  for (std::size_t i = 0; i < count; ++i) {
    check_interruption();
    body(i);
  }
}

std::size_t thread_count() noexcept { return 1; }

#endif

}  // namespace chronormal
