#include "core/blocks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <vector>

namespace chronormal::blocks_test {
namespace {

TEST(ParallelEach, calls_every_index_once) {
  for (const std::size_t count : {0u, 1u, 16u, 17u, 1000u}) {
    std::vector<std::atomic<int>> calls(count);
    parallel_each(count, 16, [&](std::size_t i) { ++calls[i]; });
    for (const auto& c : calls) EXPECT_EQ(c, 1);
  }
}

TEST(ParallelFold, merges_blocks_in_their_order_on_any_number_of_threads) {
  using Indices = std::vector<std::size_t>;
  for (const std::size_t threads : {1u, 3u, 8u}) {
    const ThreadLimit limit(threads);
    for (const std::size_t count : {0u, 1u, 16u, 17u, 1000u}) {
      std::size_t merges = 0;
      const auto all = parallel_fold<Indices>(
          count, 16, [](std::size_t i, Indices& of_block) { of_block.push_back(i); },
          [&](Indices& result, const Indices& of_block) {
            ++merges;
            result.insert(result.end(), of_block.begin(), of_block.end());
          });
      ASSERT_EQ(all.size(), count);
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(all[i], i);
      EXPECT_EQ(merges, block_count(count, 16));
    }
  }
}

}  // namespace
}  // namespace chronormal::blocks_test
