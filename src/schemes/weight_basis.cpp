#include "schemes/weight_basis.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>

#include "core/rounding.h"

namespace chronormal::inline internal {
namespace {

double largest_sum_of(const std::vector<WeightBasis::Coefficients>& weights) {
  WeightBasis::Coefficients sums{};
  for (const WeightBasis::Coefficients& weight : weights)
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += std::fabs(weight[i]);
  return *std::max_element(sums.begin(), sums.end());
}

}  // namespace

WeightBasis::WeightBasis(std::size_t degree, std::vector<Coefficients> weights)
    : WeightBasis(degree, weights, largest_sum_of(weights)) {}

WeightBasis::WeightBasis(std::size_t degree, std::vector<Coefficients> weights, double largest_sum)
    : degree_(degree), weights_(std::move(weights)) {
  assert(degree >= 1 && degree <= kMostDegree);
  conversion_error_ = 32 * static_cast<double>(degree) * kUnitRoundoff * largest_sum;
  // The sum of |weights| is bounded piece by piece. On a piece, a polynomial is at most its largest Bernstein
  // coefficient.
  const std::size_t pieces = 4 * degree;
  for (std::size_t i = 0; i < pieces; ++i) {
    double sum = 0;
    for (Coefficients p : weights_) {
      const std::span<double> used(p.data(), degree + 1);
      restrict_in_place(used, static_cast<double>(i) / static_cast<double>(pieces),
                        static_cast<double>(i + 1) / static_cast<double>(pieces));
      double largest = 0;
      for (const double b : used) largest = std::max(largest, std::fabs(b));
      sum += largest;
    }
    most_weight_ = std::max(most_weight_, sum + conversion_error_);
  }
}

WeightBasis WeightBasis::lagrange(std::size_t degree) {
  const double nodes = static_cast<double>(degree);
  std::vector<Coefficients> weights;
  Coefficients sums{};
  for (std::size_t k = 0; k <= degree; ++k) {
    // Weight k is the product of the factors (degree x - j) / (k - j) over all j except k. The factors have degree 1,
    // and are multiplied one after the other.
    Coefficients p{1}, sizes{1};
    std::size_t so_far = 0;
    for (std::size_t j = 0; j <= degree; ++j) {
      if (j == k) continue;
      const double scale = 1 / (static_cast<double>(k) - static_cast<double>(j));
      const double at_start = -static_cast<double>(j) * scale, at_end = (nodes - static_cast<double>(j)) * scale;
      ++so_far;
      Coefficients next{}, next_sizes{};
      for (std::size_t i = 0; i <= so_far; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(so_far);
        if (i < so_far) {
          next[i] += (1 - share) * at_start * p[i];
          next_sizes[i] += (1 - share) * std::fabs(at_start) * sizes[i];
        }
        if (i > 0) {
          next[i] += share * at_end * p[i - 1];
          next_sizes[i] += share * std::fabs(at_end) * sizes[i - 1];
        }
      }
      p = next;
      sizes = next_sizes;
    }
    weights.push_back(p);
    for (std::size_t i = 0; i <= degree; ++i) sums[i] += sizes[i];
  }
  return {degree, std::move(weights), *std::max_element(sums.begin(), sums.end())};
}

}  // namespace chronormal::inline internal
