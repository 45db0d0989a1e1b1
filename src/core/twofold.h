/// Numbers with twice the digits of double, for sums of products that cancel. Each number is the sum of two doubles,
/// and the second double is at most half a unit in the last place of the first.
///
/// Source: Dekker, A floating-point technique for extending the available precision (1971). Sums and products of two
/// doubles are exact if nothing overflows or underflows. Sums and products of two Twofold have an error of at most
/// 2^-100 relative to their operands.
#ifndef CHRONORMAL_CORE_TWOFOLD_H_
#define CHRONORMAL_CORE_TWOFOLD_H_

#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace chronormal::inline internal {

struct Twofold {
  double high = 0, low = 0;

  [[nodiscard]] static Twofold sum(double a, double b) noexcept {
    const double high = a + b, of_b = high - a, of_a = high - of_b;
    return {high, (a - of_a) + (b - of_b)};
  }
  [[nodiscard]] static Twofold product(double a, double b) noexcept {
    // The factor that splits doubles into halves of 26 bits, whose products are exact.
    constexpr double kSplit = 0x1p27 + 1;
    const double a_scaled = kSplit * a, b_scaled = kSplit * b;
    const double a1 = a_scaled - (a_scaled - a), a2 = a - a1, b1 = b_scaled - (b_scaled - b), b2 = b - b1;
    const double high = a * b;
    return {high, ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2};
  }

  [[nodiscard]] double value() const noexcept { return high + low; }

  friend Twofold operator-(const Twofold& a) noexcept { return {-a.high, -a.low}; }
  friend Twofold operator+(const Twofold& a, const Twofold& b) noexcept {
    const Twofold of_highs = sum(a.high, b.high);
    return sum(of_highs.high, of_highs.low + (a.low + b.low));
  }
  friend Twofold operator*(const Twofold& a, const Twofold& b) noexcept {
    const Twofold of_highs = product(a.high, b.high);
    return sum(of_highs.high, of_highs.low + (a.high * b.low + a.low * b.high));
  }
};

/// Returns a + a_low - (b + b_low). The error is at most one rounding plus 2^-9 of a rounding, even if terms cancel.
/// Precondition: |a_low| and |b_low| are at most 2^-23 of |a| and |b|.
[[nodiscard]] inline double difference(double a, double a_low, double b, double b_low) noexcept {
  const double of_high = a - b, of_low = a_low - b_low, sum = of_high + of_low;
  // Usually a and b are float32 values. Their difference is then exact in double, and much larger than a_low - b_low.
  // The sum of both differences in double is then accurate enough.
  if (a - of_high == b && b + of_high == a && std::fabs(of_low) <= 0x1p-10 * std::fabs(sum)) return sum;
  const Twofold high = Twofold::sum(a, -b), low = Twofold::sum(a_low, -b_low), both = Twofold::sum(high.high, low.high);
  return both.high + (both.low + (high.low + low.low));
}

/// Many sums of products side by side, each in twice the digits of double, so that cancellation leaves no rounding
/// error. The part that an addition loses is added up separately.
class LongSums {
 public:
  explicit LongSums(std::size_t count) : high_(count), low_(count) {}

  /// Adds factor * values[i] to sum i. Each product is split into two products that are exact.
  void add(double factor, std::span<const float> values) noexcept {
    // The upper half of the factor has 26 bits (Dekker 1971), so its products with floats have at most 50 bits.
    const double far = 0x1p27 * factor, large = far + factor - far;
    const double upper = std::isfinite(large) ? large : factor;
    add_products(upper, values);
    if (upper != factor) add_products(factor - upper, values);
  }
  /// Adds factor * values[i] to sum i. Each product is rounded to 53 bits, which is enough for products that are small
  /// compared with the sums.
  void add(double factor, std::span<const double> values) noexcept { add_products(factor, values); }

  /// Normalises the two parts of each sum: low becomes at most half a unit in the last place of high. The sums are high
  /// + low.
  void settle() noexcept {
    for (std::size_t i = 0; i < high_.size(); ++i) set(i, Twofold::sum(high_[i], low_[i]));
  }
  [[nodiscard]] std::span<const double> high() const noexcept { return high_; }
  [[nodiscard]] std::span<const double> low() const noexcept { return low_; }

  [[nodiscard]] Twofold operator[](std::size_t i) const noexcept { return {high_[i], low_[i]}; }
  void set(std::size_t i, const Twofold& sum) noexcept {
    high_[i] = sum.high;
    low_[i] = sum.low;
  }

 private:
  template <class Value>
  void add_products(double factor, std::span<const Value> values) noexcept {
    assert(values.size() == high_.size());
    double *const high = high_.data(), *const low = low_.data();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Twofold sum = Twofold::sum(high[i], factor * static_cast<double>(values[i]));
      high[i] = sum.high;
      low[i] += sum.low;
    }
  }

  std::vector<double> high_, low_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_TWOFOLD_H_
