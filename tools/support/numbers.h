/// Numbers as they stand in a page, and what a table says about many of them.
#ifndef SUPPORT_NUMBERS_H_
#define SUPPORT_NUMBERS_H_

#include <string>
#include <vector>

namespace chronormal::pages {

[[nodiscard]] std::string grouped(double value, int decimals = 0);  ///< 1,234.5
/// Three decimals, and powers of ten where those would show nothing.
[[nodiscard]] std::string ratio(double value);
[[nodiscard]] std::string percent(double share, int decimals = 0);     ///< 12 %
[[nodiscard]] std::string scientific(double value, int decimals = 0);  ///< 1e-06 as 1e-6
/// "a, b and c"
[[nodiscard]] std::string listed(const std::vector<std::string>& items);

[[nodiscard]] double sum(const std::vector<double>& values);
[[nodiscard]] double smallest(const std::vector<double>& values);
[[nodiscard]] double largest(const std::vector<double>& values);
/// The value below which a share of the values lies.
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace chronormal::pages

#endif  // SUPPORT_NUMBERS_H_
