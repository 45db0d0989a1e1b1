// Tests the search for the best prefetch distance, with which evaluations read curves ahead of time, and the limit on
// the number of trials. The best distance is the one whose trials took the shortest time, in the median.

#include "normals/curves/kernels/prefetch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "tests/support/fixtures.h"

namespace chronormal::prefetch_test {
namespace {

TEST(PrefetchRule, the_fastest_distance_in_the_median_decides) {
  for (std::size_t fastest = 0; fastest < PrefetchRule::kDistances.size(); ++fastest) {
    PrefetchRule rule;
    EXPECT_EQ(rule.best(), PrefetchRule::kDistances[0]);  // the result before any trial
    std::array<std::size_t, PrefetchRule::kDistances.size()> trials{};
    while (const std::optional<std::size_t> trial = rule.next()) {
      const std::size_t turn = trials[*trial]++;
      // Simulates interruptions by the system: two trials of the fastest distance are slow. One trial of each other
      // distance is faster than all trials of the fastest distance.
      const bool is_odd = turn == 3 || (*trial == fastest && turn == 7);
      rule.take(*trial, *trial == fastest ? (is_odd ? 500.0f : 0.1f) : (is_odd ? 0.09f : 0.13f));
    }
    EXPECT_EQ(rule.best(), PrefetchRule::kDistances[fastest]);
    for (const std::size_t count : trials) EXPECT_EQ(count, PrefetchRule::kTrials);
  }
}

TEST(PrefetchRule, trials_are_repeated_after_a_while_and_replace_those_before) {
  PrefetchRule rule;
  const auto try_all = [&rule](std::size_t fastest) {
    std::size_t count = 0;
    while (const std::optional<std::size_t> trial = rule.next()) {
      rule.take(*trial, *trial == fastest ? 0.1f : 0.13f);
      ++count;
    }
    return count;
  };
  constexpr std::size_t kAll = PrefetchRule::kTrials * PrefetchRule::kDistances.size();
  EXPECT_EQ(try_all(3), kAll);
  for (const std::size_t fastest : {1U, 4U}) {
    // The call that ended the trials was the first call without a trial. Call number kCallsBetween starts the next
    // round of trials.
    for (std::size_t call = 2; call < PrefetchRule::kCallsBetween; ++call) ASSERT_FALSE(rule.next()) << call;
    EXPECT_EQ(try_all(fastest), kAll);
    EXPECT_EQ(rule.best(), PrefetchRule::kDistances[fastest]);
  }
}

TEST(PrefetchRule, all_elements_are_evaluated_once_in_order) {
  constexpr std::size_t kBytes = 36;
  constexpr std::size_t kPart = PrefetchRule::kTrialBytes / kBytes / kTile * kTile;
  for (const std::size_t elements : {std::size_t{0}, std::size_t{1}, kPart - 1, kPart, 3 * kPart + 5, 20 * kPart}) {
    PrefetchRule rule;
    for (std::size_t pass = 0; pass < 2 * PrefetchRule::kTrials * PrefetchRule::kDistances.size(); ++pass) {
      std::size_t done = 0;
      rule.over(elements, kBytes, [&](std::size_t first, std::size_t count, std::size_t ahead) {
        EXPECT_EQ(first, done);
        EXPECT_GT(count, 0U);
        EXPECT_NE(std::find(PrefetchRule::kDistances.begin(), PrefetchRule::kDistances.end(), ahead),
                  PrefetchRule::kDistances.end());
        done += count;
      });
      ASSERT_EQ(done, elements);
    }
    EXPECT_EQ(rule.next().has_value(), elements < kPart);
  }
}

TEST(PrefetchRule, a_rule_of_few_distances_tries_no_others) {
  PrefetchRule rule(2);
  for (std::size_t trial = 0; trial < 2 * PrefetchRule::kTrials; ++trial) EXPECT_EQ(rule.next(), trial % 2);
  EXPECT_EQ(rule.next(), std::nullopt);
}

// Threads compete for the last trial only in few of many rounds, so all threads start at the same time when few trials
// are left.
TEST(PrefetchRule, threads_share_trials) {
  constexpr std::size_t kAll = PrefetchRule::kTrials * PrefetchRule::kDistances.size();
  constexpr std::size_t kThreads = 4, kLeft = 3;
  for (int round = 0; round < 2000; ++round) {
    PrefetchRule rule;
    std::atomic<std::size_t> count = 0, ready = 0;
    const auto try_one = [&] {
      const std::optional<std::size_t> trial = rule.next();
      if (!trial) return false;
      rule.take(*trial, *trial == 2 ? 1.0f : 2.0f);
      ++count;
      return true;
    };
    while (count < kAll - kLeft) ASSERT_TRUE(try_one());
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < kThreads; ++i) {
      threads.emplace_back([&] {
        ++ready;
        while (ready < kThreads) std::this_thread::yield();
        while (try_one()) {
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    ASSERT_EQ(count, kAll) << "round " << round;
    ASSERT_EQ(rule.best(), PrefetchRule::kDistances[2]) << "round " << round;
  }
}

TEST(PrefetchRule, large_evaluations_try_until_they_know_and_keep_their_bits) {
  const Motion motion = fixtures::smooth_morph(600);  // 720,000 faces, 26 MB of curves
  const NormalCurves curves = NormalCurves::of_faces(motion.segment(0));
  std::vector<float> first(3 * curves.size()), later(3 * curves.size());
  (void)curves.unit_normals(0.3, VectorView<float>::packed(first));
  for (std::size_t i = 0; i < PrefetchRule::kTrials; ++i)
    (void)curves.unit_normals(0.3, VectorView<float>::packed(later));
  // All trials are done now, unless tests that ran earlier in the same process have begun a new round of trials.
  std::size_t left = 0;
  while (left <= PrefetchRule::kTrials * PrefetchRule::kDistances.size() &&
         prefetch_of_curves(WorkingSet::kSharedCache).next())
    ++left;
  EXPECT_LE(left, PrefetchRule::kTrials * PrefetchRule::kDistances.size());
  EXPECT_EQ(first, later);
}

}  // namespace
}  // namespace chronormal::prefetch_test
