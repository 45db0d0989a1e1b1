// Compares the kernel that computes sums of products with three nested loops, bit by bit, on every instruction set.
#include "analysis/fits/kernels/products.h"

#include <gtest/gtest.h>

#include <vector>

#include "simd/targets.h"
#include "tests/support/fixtures.h"

namespace chronormal::products_test {
namespace {

TEST(Products, are_those_of_three_loops_on_every_instruction_set_and_touch_nothing_else) {
  fixtures::Random random(7);
  for (const std::size_t rows : {1U, 5U, 33U}) {
    for (const std::size_t left : {1U, 3U, 4U, 9U}) {
      for (const std::size_t right : {1U, 7U, 16U, 32U, 55U}) {
        const std::size_t stride = right + 2;
        std::vector<float> a(rows * left), b(rows * right), before(left * stride);
        for (std::vector<float>* numbers : {&a, &b, &before})
          for (float& number : *numbers) number = static_cast<float>(random.below(2001)) / 1000 - 1;
        std::vector<float> expected = before;
        for (std::size_t i = 0; i < left; ++i)
          for (std::size_t j = 0; j < right; ++j)
            for (std::size_t r = 0; r < rows; ++r) expected[i * stride + j] += a[i * rows + r] * b[r * right + j];
        for (const std::int64_t target : supported_targets()) {
          const ScopedTarget scoped(target);
          std::vector<float> sums = before;
          add_products({a.data(), rows, left, 1, rows}, {b.data(), rows, right, right, 1}, sums.data(), stride);
          EXPECT_EQ(sums, expected) << target_name(target) << ", " << rows << " rows, " << left << " x " << right;
        }
      }
    }
  }
}

}  // namespace
}  // namespace chronormal::products_test
