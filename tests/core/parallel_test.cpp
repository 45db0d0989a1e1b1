#include "chronormal/core/parallel.h"

#include "chronormal/core/interruption.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <thread>
#include <vector>

namespace chronormal::parallel_test {
namespace {

// Whether this build has threads at all.
bool is_serial() {
  const ThreadLimit two(2);
  return thread_count() == 1;
}

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
    // And is none the worse for it.
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
  if (is_serial()) GTEST_SKIP() << "built without oneTBB";
  for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
    const ThreadLimit limit(threads);
    std::atomic<std::size_t> at_once = 0, most = 0;
    // Bodies that wait for each other show how many run at the same time.
    parallel_for(64, [&](std::size_t) {
      const std::size_t now = ++at_once;
      for (std::size_t before = most; before < now && !most.compare_exchange_weak(before, now);) continue;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      --at_once;
    });
    EXPECT_LE(most, threads);
    EXPECT_EQ(most > 1, threads > 1);
  }
}

TEST(ThreadLimit, is_what_thread_count_says_and_the_innermost_counts) {
  if (is_serial()) GTEST_SKIP() << "built without oneTBB";
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

// A loop in a loop that takes seconds, unless it is ended.
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
