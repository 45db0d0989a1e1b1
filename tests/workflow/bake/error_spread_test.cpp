// Compares the average, the worst error and the quantile that ErrorSpread computes with the figures of a list of all
// errors.
#include "workflow/bake/judge/error_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "tests/support/fixtures.h"

namespace chronormal::error_spread_test {
namespace {

constexpr std::size_t kVertices = 400, kPoses = 50, kBatch = 20;

// Draws kVertices x kPoses errors from 1e-4 to 100 degrees. About one in nine is -1, which stands for an unknown error.
std::vector<float> errors_of_all(unsigned seed) {
  fixtures::Random random(seed);
  std::vector<float> errors;
  for (std::size_t n = 0; n < kVertices * kPoses; ++n)
    errors.push_back(random.below(9) == 0 ? -1.0F : static_cast<float>(std::pow(10, random.uniform(-4, 2))));
  return errors;
}

// Adds the errors in batches of poses, and in each batch one vertex after the other.
void add_all(const std::vector<float>& errors, ErrorSpread& to) {
  for (std::size_t first = 0; first < kPoses; first += kBatch)
    for (std::size_t v = 0; v < kVertices; ++v)
      to.add(std::span(errors).subspan(v * kPoses + first, std::min(kBatch, kPoses - first)));
}

TEST(ErrorSpread, is_that_of_a_list_of_all_errors) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const std::vector<float> errors = errors_of_all(seed);
    ErrorSpread gathered;
    add_all(errors, gathered);
    std::vector<double> known;
    double sum = 0;
    for (const float error : errors) {
      if (error < 0) continue;
      known.push_back(error);
      sum += known.back();
    }
    std::sort(known.begin(), known.end());
    const ShownErrors result = gathered.errors();
    EXPECT_EQ(result.judged, known.size());
    const auto& bins = gathered.bins;
    EXPECT_EQ(std::accumulate(bins.begin(), bins.end(), std::size_t{0}), known.size());
    EXPECT_NEAR(result.mean, sum / static_cast<double>(known.size()), 1e-5 * result.mean);
    EXPECT_EQ(result.worst, known.back());
    const double most = known[known.size() - 1 - known.size() / 1000];
    EXPECT_GE(result.most, most);
    EXPECT_LE(result.most, 1.1 * most);
  }
}

TEST(ErrorSpread, of_two_sets_is_that_of_both) {
  const std::vector<float> small(kVertices * kPoses, 0.01F), large(kVertices * kPoses, 3.0F);
  ErrorSpread a, b, both;
  add_all(small, a);
  add_all(large, b);
  add_all(small, both);
  add_all(large, both);
  ErrorSpread sum = a;
  sum.add(b);
  EXPECT_EQ(sum.bins, both.bins);
  EXPECT_EQ(sum.count, 2 * kVertices * kPoses);
  EXPECT_NEAR(sum.errors().mean, 1.505, 1e-4);
  EXPECT_EQ(sum.errors().worst, 3);
}

TEST(ErrorSpread, of_nothing_is_zero) {
  const ShownErrors none = ErrorSpread().errors();
  EXPECT_EQ(none.judged, 0U);
  EXPECT_EQ(none.mean, 0);
  EXPECT_EQ(none.most, 0);
  EXPECT_EQ(none.worst, 0);
}

}  // namespace
}  // namespace chronormal::error_spread_test
