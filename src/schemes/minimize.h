/// Finds the minimum of a function of one variable that may have several local minima.
#ifndef CHRONORMAL_SCHEMES_MINIMIZE_H_
#define CHRONORMAL_SCHEMES_MINIMIZE_H_

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <span>

namespace chronormal::inline internal {

/// Returns an x at which f is small. Evaluates f at every point, and then refines the lowest local minima by golden
/// section. f is never larger at the result than at any of the given points. Precondition: points ascend, and there are
/// at most 64.
template <class F>
[[nodiscard]] double minimize(std::span<const double> points, F f) {
  constexpr std::size_t kMaxPoints = 64, kMinima = 3;
  constexpr double kGolden = 0.6180339887498949;
  // A bracket is narrow enough if a better x could gain at most this fraction of f, or if the bracket itself is
  // narrower than kNarrowest.
  constexpr double kGain = 2e-3, kNarrowest = 1e-7;
  const std::size_t n = points.size();
  assert(0 < n && n <= kMaxPoints);

  std::array<double, kMaxPoints> values;
  for (std::size_t i = 0; i < n; ++i) values[i] = f(points[i]);
  double best_x = points[0], best = values[0];
  const auto offer = [&](double x, double value) {
    if (value < best) {
      best = value;
      best_x = x;
    }
  };

  std::array<std::size_t, kMaxPoints> minima;
  std::size_t minimum_count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    offer(points[i], values[i]);
    const bool below_left = i == 0 || values[i] <= values[i - 1],
               below_right = i + 1 == n || values[i] <= values[i + 1];
    if (below_left && below_right) minima[minimum_count++] = i;
  }
  std::sort(minima.begin(), minima.begin() + static_cast<std::ptrdiff_t>(minimum_count),
            [&values](std::size_t a, std::size_t b) { return values[a] != values[b] ? values[a] < values[b] : a < b; });

  for (std::size_t k = 0; k < std::min(minimum_count, kMinima); ++k) {
    const std::size_t i = minima[k];
    double a = points[i == 0 ? 0 : i - 1], b = points[i + 1 == n ? i : i + 1];
    double x1 = b - kGolden * (b - a), x2 = a + kGolden * (b - a);
    double f1 = f(x1), f2 = f(x2);
    while (b - a > kNarrowest) {
      offer(x1, f1);
      offer(x2, f2);
      // The slope across the bracket bounds the possible gain, whether the minimum is smooth or a kink.
      const double span = b - a;
      if (std::fabs(f1 - f2) / (x2 - x1) * span < kGain * best && span < 1e-2) break;
      if (f1 <= f2) {
        b = x2;
        x2 = x1;
        f2 = f1;
        x1 = b - kGolden * (b - a);
        f1 = f(x1);
      } else {
        a = x1;
        x1 = x2;
        f1 = f2;
        x2 = a + kGolden * (b - a);
        f2 = f(x2);
      }
    }
  }
  return best_x;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_MINIMIZE_H_
