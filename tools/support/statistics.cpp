#include "support/statistics.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace chronormal::pages {

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace chronormal::pages
