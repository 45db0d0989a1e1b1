// Evaluations prefetch curves at the distance of the shortest trial, and there are only so many trials.

#include "normals/curves/kernels/prefetch.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>
#include <thread>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "tests/support/fixtures.h"

namespace chronormal::prefetch_test {
namespace {

TEST(PrefetchRule, the_shortest_of_all_trials_decides) {
  for (std::size_t fastest = 0; fastest < PrefetchRule::kDistances.size(); ++fastest) {
    PrefetchRule rule;
    EXPECT_EQ(rule.best(), PrefetchRule::kDistances[0]);  // before any trial
    std::array<std::size_t, PrefetchRule::kDistances.size()> trials{};
    while (const std::optional<std::size_t> trial = rule.next()) {
      // Every distance is slow at times, and the fastest one most of the time.
      const bool is_quiet = ++trials[*trial] == 3;
      rule.take(*trial, is_quiet ? (*trial == fastest ? 0.1f : 0.12f) : (*trial == fastest ? 5.0f : 2.0f));
    }
    EXPECT_EQ(rule.best(), PrefetchRule::kDistances[fastest]);
    for (const std::size_t count : trials) EXPECT_EQ(count, PrefetchRule::kTrials);
  }
}

// Threads meet at the last trial in some of many rounds only, in which they begin together and with few trials left.
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
  EXPECT_EQ(prefetch_in_shared_cache().next(), std::nullopt);
  EXPECT_EQ(first, later);
}

}  // namespace
}  // namespace chronormal::prefetch_test
