// Runs loops on one pool of threads for the whole process. A loop is a Job on the stack of its caller, and is in the
// pool's list while it may have pieces that no thread has taken. The caller takes pieces in order, and so do workers.
// The number of workers of a loop is limited: a worker that joins takes one of the loop's seats.
//
//     a loop in a piece   is a job whose parent is the job of that piece. It shares the seats of the outermost job, so
//                         that a ThreadLimit applies to all nested loops. Workers join nested loops when they find
//                         pieces; no thread waits in a queue.
//     waiting             A caller that has no piece left waits for the helpers that work on its last pieces. Meanwhile
//                         it only helps with jobs nested in its own: everything that it waits for is on the stack of a
//                         running thread, so there is no deadlock.
//     fork()              The child has only the thread that called fork(). It creates no workers if its parent had
//                         any.
#include "chronormal/core/parallel.h"

#include <algorithm>
#include <utility>

#ifndef __EMSCRIPTEN__
#include <atomic>
#include <cfenv>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

#if __has_include(<pthread.h>) && !defined(_WIN32)
#include <pthread.h>
#endif
#ifdef __linux__
#include <sched.h>
#endif
#endif

namespace chronormal {
namespace {

constexpr std::size_t kMostThreads = 64;

// The limit of threads for loops that this thread begins; 0 if there is no limit.
thread_local std::size_t thread_limit = 0;
// The interruption that can end the computation for which this thread works.
thread_local Interruption* interruption = nullptr;

constexpr std::chrono::milliseconds kBetweenQuestions(50);

// The scope in which this thread works for the computation of an Interruption. nullptr stands for a computation
// that nobody can end.
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

#ifndef __EMSCRIPTEN__

namespace {

struct Job;
thread_local Job* current_job = nullptr;  // the job one of whose pieces this thread runs

// A running loop. The pool's mutex guards all members that are not constant or atomic.
struct Job {
  const std::function<void(std::size_t)>& body;
  const std::size_t count;
  const std::size_t threads;  // the largest number of threads for the outermost job and the jobs inside it
  Job* const parent;          // the job in one of whose pieces this job began; nullptr for an outermost job
  Job* const outermost = parent != nullptr ? parent->outermost : this;
  Interruption* const asked = interruption;
  std::fenv_t rounding = {};

  std::atomic<std::size_t> next = 0;  // index of the next piece that no thread has taken
  // For an outermost job: the number of threads that work on this job and on the jobs inside it.
  std::size_t seated = 1;
  std::size_t helpers = 0;  // number of threads that run pieces of this job, not counting its caller
  std::exception_ptr failure = nullptr;
  Job* after = nullptr;  // the next job in the pool's list

  [[nodiscard]] bool has_pieces() const noexcept { return next.load(std::memory_order_relaxed) < count; }
  [[nodiscard]] bool is_inside(const Job& other) const noexcept {
    for (const Job* job = parent; job != nullptr; job = job->parent)
      if (job == &other) return true;
    return false;
  }
};

// Returns the number of processors that this process may run on.
std::size_t processor_count() noexcept {
#ifdef __linux__
  cpu_set_t allowed;
  if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) return static_cast<std::size_t>(CPU_COUNT(&allowed));
#endif
  return std::max(std::thread::hardware_concurrency(), 1U);
}

std::size_t thread_count_without_limit() noexcept {
  static const std::size_t count = processor_count();
  return count;
}

class Pool {
 public:
  // Creates threads that are missing. Returns the number of threads that a loop may use, including the caller; at most
  // `wanted`.
  std::size_t provide(std::size_t wanted) noexcept {
    if (wanted <= 1 || is_forked_) return 1;
    if (worker_count_ + 1 < wanted) {
      const std::lock_guard lock(mutex_);
      try {
        while (!has_all_ && workers_.size() + 1 < wanted) workers_.emplace_back([this] { work(); });
        // If the system grants no thread, or no memory for one, the loop uses the existing threads.
      } catch (const std::exception&) {
        has_all_ = true;
      }
      worker_count_ = workers_.size();
    }
    return std::min(wanted, worker_count_ + 1);
  }

  void run(Job& job) {
    std::fegetenv(&job.rounding);
    open(job);
    take_pieces(job);
    finish(job);
    if (job.failure) std::rethrow_exception(job.failure);
  }

  void begin_fork() noexcept { mutex_.lock(); }
  void end_fork() noexcept { mutex_.unlock(); }
  void begin_anew() noexcept {
    is_forked_ = !workers_.empty();
    mutex_.unlock();
  }

  // Ends all workers when the process ends or when the library is unloaded. Does not wait for any thread if loops still
  // run.
  void end() noexcept {
    if (is_forked_) return;
    {
      const std::lock_guard lock(mutex_);
      has_all_ = has_ended_ = true;
      worker_count_ = 0;
      if (busy_ > 0) return;
    }
    opened_.notify_all();
    for (std::thread& worker : workers_) worker.join();
    workers_.clear();
    workers_.shrink_to_fit();
  }

 private:
  void open(Job& job) noexcept {
    const std::lock_guard lock(mutex_);
    Job** last = &jobs_;
    while (*last != nullptr) last = &(*last)->after;
    *last = &job;
    const std::size_t useful = std::min({job.count - 1, job.threads - 1, workers_.size() - busy_});
    for (std::size_t i = 0; i < useful; ++i) opened_.notify_one();
    if (waiting_ > 0) changed_.notify_all();
  }

  void take_pieces(Job& job) noexcept {
    const InterruptionScope scope(job.asked);
    Job* const job_before = std::exchange(current_job, &job);
    const std::size_t limit_before = std::exchange(thread_limit, job.outermost->threads);
    for (std::size_t i; (i = job.next.fetch_add(1, std::memory_order_relaxed)) < job.count;) {
      try {
        check_interruption();
        job.body(i);
      } catch (...) {
        fail(job, std::current_exception());
      }
    }
    current_job = job_before;
    thread_limit = limit_before;
  }

  void fail(Job& job, std::exception_ptr failure) noexcept {
    job.next = job.count;
    const std::lock_guard lock(mutex_);
    if (!job.failure) job.failure = std::move(failure);
  }

  void help(Job& job, std::unique_lock<std::mutex>& lock) noexcept {
    ++job.helpers;
    lock.unlock();
    std::fesetenv(&job.rounding);
    take_pieces(job);
    lock.lock();
    if (--job.helpers == 0 && waiting_ > 0) changed_.notify_all();
  }

  // Removes the job from the pool's list, and waits until no other thread works on it. Meanwhile helps with the jobs
  // inside it.
  void finish(Job& job) noexcept {
    std::unique_lock lock(mutex_);
    Job** place = &jobs_;
    while (*place != &job) place = &(*place)->after;
    *place = job.after;
    while (job.helpers > 0) {
      if (is_forked_) {  // pieces that helpers had begun will not be done in this process
        job.failure = std::make_exception_ptr(Interrupted());
        return;
      }
      Job* inside = jobs_;
      while (inside != nullptr && !(inside->has_pieces() && inside->is_inside(job))) inside = inside->after;
      if (inside != nullptr) {
        help(*inside, lock);
        std::fesetenv(&job.rounding);
        continue;
      }
      ++waiting_;
      if (job.asked != nullptr) {
        changed_.wait_for(lock, kBetweenQuestions);
      } else {
        changed_.wait(lock);
      }
      --waiting_;
      // An interruption's callback may only be called on the thread to which the interruption belongs. This thread,
      // which waits for the job, may be that thread.
      if (job.asked != nullptr) {
        lock.unlock();
        try {
          check_interruption();
        } catch (...) {
          fail(job, std::current_exception());
        }
        lock.lock();
      }
    }
  }

  void work() noexcept {
    std::unique_lock lock(mutex_);
    while (!has_ended_) {
      Job* job = jobs_;
      while (job != nullptr && !(job->has_pieces() && job->outermost->seated < job->outermost->threads))
        job = job->after;
      if (job == nullptr) {
        opened_.wait(lock);
        continue;
      }
      // The job, which is on its caller's stack, may be destroyed as soon as nobody helps with it. So its outermost job
      // is read first.
      Job& outermost = *job->outermost;
      ++outermost.seated, ++busy_;
      help(*job, lock);
      --outermost.seated, --busy_;
    }
  }

  std::mutex mutex_;
  std::condition_variable opened_;  // notified when there is a job for workers
  // Is notified when a job has no helpers any more, or when there is a job with which a waiting caller can help.
  std::condition_variable changed_;
  std::vector<std::thread> workers_;
  std::atomic<std::size_t> worker_count_ = 0;
  std::atomic<bool> is_forked_ = false;
  bool has_all_ = false, has_ended_ = false;
  std::size_t busy_ = 0;     // number of workers that help with a job
  std::size_t waiting_ = 0;  // number of callers that wait for helpers
  Job* jobs_ = nullptr;      // list of the jobs, in the order in which they began
};

// Returns the pool, which is never destroyed, since a thread may use the pool until the process ends.
Pool& pool() {
  alignas(Pool) static std::byte room[sizeof(Pool)];
  static Pool* const made = [] {
    Pool* const begun = new (room) Pool;
#if __has_include(<pthread.h>) && !defined(_WIN32)
    (void)::pthread_atfork([] { pool().begin_fork(); }, [] { pool().end_fork(); }, [] { pool().begin_anew(); });
#endif
    return begun;
  }();
  static const struct Ending {
    ~Ending() { pool().end(); }
  } ending;
  return *made;
}

}  // namespace

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  const std::size_t threads = count < 2 ? 1 : thread_count();
  if (threads == 1) {
    for (std::size_t i = 0; i < count; ++i) {
      check_interruption();
      body(i);
    }
    return;
  }
  const bool is_inside = current_job != nullptr && current_job->outermost->threads == threads;
  Job job = {.body = body, .count = count, .threads = threads, .parent = is_inside ? current_job : nullptr};
  pool().run(job);
}

std::size_t thread_count() noexcept {
  const std::size_t wanted = thread_limit != 0 ? thread_limit : thread_count_without_limit();
  return wanted == 1 ? 1 : pool().provide(wanted);
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
