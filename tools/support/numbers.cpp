// Formats build on fmt; quantiles are those of the nearest rank, so that a value of the data is shown.
#include "support/numbers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace chronormal::pages {

std::string grouped(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", std::fabs(value), decimals);
  for (std::size_t i = std::min(text.find('.'), text.size()); i > 3;) {
    i -= 3;
    text.insert(i, 1, ',');
  }
  return value < 0 ? fmt::format("-{}", text) : text;
}

std::string ratio(double value) {
  if (value == 0) return "0";
  return std::fabs(value) < 1e-3 ? scientific(value) : fmt::format("{:.3f}", value);
}

std::string percent(double share, int decimals) { return fmt::format("{:.{}f} %", 100 * share, decimals); }

std::string scientific(double value, int decimals) {
  if (value == 0) return "0";
  const std::string text = fmt::format("{:.{}e}", value, decimals);
  const std::size_t e = text.find('e');
  const int exponent = std::stoi(text.substr(e + 1));
  return exponent == 0 ? text.substr(0, e) : fmt::format("{}e{}", text.substr(0, e), exponent);
}

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
double smallest(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }
double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace chronormal::pages
