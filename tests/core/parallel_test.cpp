#include "chronormal/core/parallel.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cfenv>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iostream>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

namespace chronormal::parallel_test {
namespace {

using namespace std::chrono_literals;

// A counter of the threads that are inside pass() at the same time. Keeps the largest count.
class Crowd {
 public:
  void pass(std::chrono::microseconds time) {
    const std::size_t now = ++inside_;
    for (std::size_t before = most_; before < now && !most_.compare_exchange_weak(before, now);) continue;
    std::this_thread::sleep_for(time);
    --inside_;
  }
  [[nodiscard]] std::size_t most() const { return most_; }

 private:
  std::atomic<std::size_t> inside_ = 0, most_ = 0;
};

TEST(ParallelFor, calls_every_index_once) {
  for (const std::size_t threads : {1u, 2u, 3u, 8u, 33u}) {
    const ThreadLimit limit(threads);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 1000u}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, [&](std::size_t i) { ++calls[i]; });
      for (const auto& c : calls) EXPECT_EQ(c, 1);
    }
  }
}

TEST(ParallelFor, throws_what_the_body_throws) {
  for (const std::size_t threads : {1u, 2u, 8u}) {
    const ThreadLimit limit(threads);
    const auto throwing = [](std::size_t i) {
      if (i == 13) throw std::out_of_range("thirteen");
    };
    EXPECT_THROW(parallel_for(100, throwing), std::out_of_range);
    // The pool of threads must still work after the exceptions.
    std::atomic<std::size_t> sum = 0;
    parallel_for(100, [&](std::size_t i) { sum += i; });
    EXPECT_EQ(sum, 4950u);
  }
}

TEST(ParallelFor, may_be_called_from_its_body) {
  for (const std::size_t threads : {1u, 3u, 8u}) {
    const ThreadLimit limit(threads);
    std::atomic<std::size_t> sum = 0;
    parallel_for(20, [&](std::size_t i) { parallel_for(20, [&](std::size_t k) { sum += 20 * i + k; }); });
    EXPECT_EQ(sum, 399u * 400 / 2);
  }
}

TEST(ParallelFor, runs_on_as_many_threads_as_the_limit_says) {
  for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
    const ThreadLimit limit(threads);
    Crowd crowd;
    parallel_for(64, [&](std::size_t) { crowd.pass(2ms); });
    EXPECT_LE(crowd.most(), threads);
    EXPECT_EQ(crowd.most() > 1, threads > 1);
  }
}

TEST(ParallelFor, in_its_body_shares_the_threads_of_the_outer_loop) {
  for (const std::size_t threads : {2u, 3u, 6u}) {
    const ThreadLimit limit(threads);
    Crowd crowd;
    parallel_for(8, [&](std::size_t) { parallel_for(8, [&](std::size_t) { crowd.pass(1ms); }); });
    EXPECT_LE(crowd.most(), threads);
    EXPECT_GT(crowd.most(), 1u);
  }
}

TEST(ParallelFor, helps_with_the_loops_inside_while_it_waits) {
  const ThreadLimit two(2);
  Crowd crowd;
  // The calling thread finishes its own piece at once, and waits. The other thread then runs a loop inside its piece,
  // and the calling thread must help with this inner loop.
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> is_helped = false;
  std::atomic<std::size_t> begun = 0;
  parallel_for(2, [&](std::size_t) {
    ++begun;
    while (begun < 2) std::this_thread::yield();
    if (std::this_thread::get_id() == caller) return;
    parallel_for(100, [&](std::size_t) {
      crowd.pass(1ms);
      if (std::this_thread::get_id() == caller) is_helped = true;
    });
  });
  EXPECT_TRUE(is_helped);
  EXPECT_EQ(crowd.most(), 2u);
}

TEST(ParallelFor, gives_every_thread_its_pieces_in_order) {
  const ThreadLimit limit(4);
  std::atomic<std::size_t> disorders = 0;
  for (std::size_t round = 0; round < 20; ++round) {
    parallel_for(200, [&disorders, round](std::size_t i) {
      thread_local std::size_t last_round = 0, last = 0;
      if (last_round == round && last > i) ++disorders;
      last_round = round, last = i;
    });
  }
  EXPECT_EQ(disorders, 0u);
}

// Runs a random tree of nested loops. Returns a number that depends on every piece of every loop.
std::uint64_t run_tree(std::uint64_t seed, std::size_t depth,
                       const std::function<void(std::size_t, const std::function<void(std::size_t)>&)>& loop) {
  std::mt19937_64 random(seed);
  const std::size_t count = random() % (depth == 0 ? 2 : 12);
  std::vector<std::uint64_t> results(count);
  const std::size_t limit = random() % 5;
  const auto body = [&](std::size_t i) { results[i] = run_tree(seed * 31 + i, depth - 1, loop); };
  if (depth > 0 && limit > 0) {
    const ThreadLimit some(limit);
    loop(count, body);
  } else if (depth > 0) {
    loop(count, body);
  }
  std::uint64_t sum = seed;
  for (const std::uint64_t result : results) sum = sum * 6364136223846793005u + result;
  return sum;
}

TEST(ParallelFor, of_random_trees_of_loops_on_many_threads_gives_what_plain_loops_give) {
  constexpr std::uint64_t kSeed = 20261126;
  std::cout << "seed " << kSeed << '\n';
  const auto plain = [](std::size_t count, const std::function<void(std::size_t)>& body) {
    for (std::size_t i = 0; i < count; ++i) body(i);
  };
  std::vector<std::uint64_t> expected;
  for (std::uint64_t k = 0; k < 30; ++k) expected.push_back(run_tree(kSeed + k, 4, plain));
  std::vector<std::thread> callers;
  for (const std::size_t threads : {0u, 2u, 3u, 7u}) {
    callers.emplace_back([threads, &expected] {
      const ThreadLimit limit(threads == 0 ? thread_count() : threads);
      for (std::uint64_t k = 0; k < 30; ++k) EXPECT_EQ(run_tree(kSeed + k, 4, parallel_for), expected[k]) << k;
    });
  }
  for (std::thread& caller : callers) caller.join();
}

TEST(ParallelFor, rounds_on_all_threads_as_its_caller_does) {
  const ThreadLimit limit(4);
  for (const int mode : {FE_UPWARD, FE_TONEAREST, FE_DOWNWARD, FE_TONEAREST}) {
    std::fesetround(mode);
    std::atomic<std::size_t> others = 0;
    parallel_for(32, [&](std::size_t) {
      if (std::fegetround() != mode) ++others;
      std::this_thread::sleep_for(200us);
    });
    EXPECT_EQ(others, 0u) << mode;
  }
}

TEST(ParallelFor, that_helps_with_a_loop_of_another_rounding_goes_on_with_its_own) {
  const ThreadLimit two(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<std::size_t> begun = 0;
  std::atomic<bool> is_helped = false;
  parallel_for(2, [&](std::size_t) {
    ++begun;
    while (begun < 2) std::this_thread::yield();
    if (std::this_thread::get_id() == caller) return;
    std::fesetround(FE_UPWARD);
    parallel_for(100, [&](std::size_t) {
      EXPECT_EQ(std::fegetround(), FE_UPWARD);
      if (std::this_thread::get_id() == caller) is_helped = true;
      std::this_thread::sleep_for(1ms);
    });
  });
  EXPECT_TRUE(is_helped);
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
}

// Runs `body` in a child process made by fork(). Returns the exit code of the child.
int exit_code_of_child(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(30);  // a SIGALRM ends the child if it hangs
    ::_exit(body());
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ParallelFor, in_a_child_of_fork_has_one_thread_and_does_all_pieces) {
  const ThreadLimit limit(4);
  std::atomic<bool> is_over = false;
  parallel_for(4, [](std::size_t) {});
  std::thread busy([&] {  // this thread runs loops while other threads fork
    const ThreadLimit others(3);
    while (!is_over) parallel_for(8, [](std::size_t) {});
  });
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(exit_code_of_child([] {
                if (thread_count() != 1) return 1;
                std::size_t sum = 0;
                parallel_for(100, [&](std::size_t k) { parallel_for(10, [&](std::size_t j) { sum += 10 * k + j; }); });
                return sum == 999 * 1000 / 2 ? 0 : 2;
              }),
              0);
  }
  is_over = true;
  busy.join();
  EXPECT_EQ(thread_count(), 4u);
}

// A child process that is forked during a loop does not run the pieces that other threads had begun. In the child, the
// loop ends with an error.
TEST(ParallelFor, that_is_forked_in_the_middle_ends_as_interrupted_in_the_child) {
  const ThreadLimit two(2);
  const auto caller = std::this_thread::get_id();
  const pid_t parent = ::getpid();
  std::atomic<std::size_t> begun = 0;
  std::atomic<bool> may_end = false;
  int code = -1;
  bool is_interrupted = false;
  try {
    parallel_for(2, [&](std::size_t) {
      ++begun;
      while (begun < 2) std::this_thread::yield();
      if (std::this_thread::get_id() != caller) {
        while (!may_end) std::this_thread::yield();
        return;
      }
      const pid_t child = ::fork();
      if (child == 0) return void(::alarm(30));
      int status = -1;
      ::waitpid(child, &status, 0);
      code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      may_end = true;
    });
  } catch (const Interrupted&) {
    is_interrupted = true;
  }
  if (::getpid() != parent) ::_exit(is_interrupted ? 0 : 1);
  EXPECT_FALSE(is_interrupted);
  EXPECT_EQ(code, 0);
}

TEST(ThreadLimit, is_what_thread_count_says_and_the_innermost_counts) {
  const std::size_t without = thread_count();
  {
    const ThreadLimit outer(3);
    EXPECT_EQ(thread_count(), 3u);
    {
      const ThreadLimit inner(8);
      EXPECT_EQ(thread_count(), 8u);
      const ThreadLimit innermost(1);
      EXPECT_EQ(thread_count(), 1u);
    }
    EXPECT_EQ(thread_count(), 3u);
  }
  EXPECT_EQ(thread_count(), without);
}

TEST(ThreadLimit, of_none_is_one) {
  const ThreadLimit none(0);
  EXPECT_EQ(thread_count(), 1u);
}

TEST(ThreadLimit, is_given_back_when_an_exception_leaves_it) {
  const std::size_t without = thread_count();
  try {
    const ThreadLimit limit(5);
    throw std::runtime_error("");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(thread_count(), without);
}

TEST(ThreadLimit, belongs_to_the_thread_that_made_it) {
  const std::size_t without = thread_count();
  const ThreadLimit limit(without + 3);
  std::size_t elsewhere = 0;
  std::thread([&] { elsewhere = thread_count(); }).join();
  EXPECT_EQ(elsewhere, without);
}

// Runs nested loops that take several seconds unless they are interrupted.
void loop_for_long() {
  parallel_for(40, [](std::size_t) {
    parallel_for(40, [](std::size_t) { std::this_thread::sleep_for(std::chrono::milliseconds(5)); });
  });
}

TEST(Interruption, ends_loops_and_those_inside_them) {
  for (const std::size_t threads : {1u, 2u, 8u}) {
    const ThreadLimit limit(threads);
    std::size_t asked = 0;
    {
      const Interruption interruption([&] { return ++asked == 2; });
      EXPECT_THROW(loop_for_long(), Interrupted);
      EXPECT_EQ(asked, 2u);
      EXPECT_THROW(check_interruption(), Interrupted);
    }
    check_interruption();
    std::atomic<std::size_t> sum = 0;
    parallel_for(100, [&](std::size_t i) { sum += i; });
    EXPECT_EQ(sum, 4950u);
  }
}

TEST(Interruption, is_asked_while_its_thread_waits_for_another) {
  const ThreadLimit two(2);
  const auto caller = std::this_thread::get_id();
  std::atomic<std::size_t> begun = 0;
  std::atomic<bool> is_ended = false;
  const Interruption interruption([&] { return begun == 2; });
  EXPECT_THROW(parallel_for(2,
                            [&](std::size_t) {
                              ++begun;
                              while (begun < 2) std::this_thread::yield();
                              if (std::this_thread::get_id() == caller) return;
                              try {
                                for (int i = 0; i < 10'000; ++i, std::this_thread::sleep_for(1ms)) check_interruption();
                              } catch (const Interrupted&) {
                                is_ended = true;
                                throw;
                              }
                            }),
               Interrupted);
  EXPECT_TRUE(is_ended);
}

TEST(Interruption, is_asked_by_the_thread_that_made_it_and_ends_no_loop_of_others) {
  const auto here = std::this_thread::get_id();
  std::atomic<std::size_t> calls = 0;
  std::thread other([&] {
    parallel_for(200, [&](std::size_t) { (++calls, std::this_thread::sleep_for(std::chrono::milliseconds(1))); });
  });
  {
    const Interruption interruption([&] {
      EXPECT_EQ(std::this_thread::get_id(), here);
      return true;
    });
    EXPECT_THROW(loop_for_long(), Interrupted);
  }
  other.join();
  EXPECT_EQ(calls, 200u);
}

TEST(Interruption, the_innermost_counts) {
  const Interruption outer([] { return true; });
  {
    const Interruption inner([] { return false; });
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    check_interruption();
  }
  EXPECT_THROW(check_interruption(), Interrupted);
}

}  // namespace
}  // namespace chronormal::parallel_test
