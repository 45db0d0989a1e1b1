/// What a table says about many values.
#ifndef SUPPORT_STATISTICS_H_
#define SUPPORT_STATISTICS_H_

#include <vector>

namespace chronormal::pages {

[[nodiscard]] double sum(const std::vector<double>& values);
[[nodiscard]] double largest(const std::vector<double>& values);
/// The value below which a share of the values lies.
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace chronormal::pages

#endif  // SUPPORT_STATISTICS_H_
