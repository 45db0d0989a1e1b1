/// Numbers of twice the digits of double, for sums of products that cancel: each is the sum of two, the second of which
/// is at most half a unit in the last place of the first.
///
/// Source: Dekker, A floating-point technique for extending the available precision (1971). Sums and products of
/// doubles are exact where nothing leaves their range, and those of such numbers are within 2^-100 of their operands.
#ifndef CHRONORMAL_CORE_TWOFOLD_H_
#define CHRONORMAL_CORE_TWOFOLD_H_

namespace chronormal::inline internal {

struct Twofold {
  double high = 0, low = 0;

  [[nodiscard]] static Twofold sum(double a, double b) noexcept {
    const double high = a + b, of_b = high - a, of_a = high - of_b;
    return {high, (a - of_a) + (b - of_b)};
  }
  [[nodiscard]] static Twofold product(double a, double b) noexcept {
    // Halves of 26 digits, whose products are exact.
    constexpr double kSplit = 0x1p27 + 1;
    const double a_scaled = kSplit * a, b_scaled = kSplit * b;
    const double a1 = a_scaled - (a_scaled - a), a2 = a - a1, b1 = b_scaled - (b_scaled - b), b2 = b - b1;
    const double high = a * b;
    return {high, ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2};
  }

  [[nodiscard]] double value() const noexcept { return high + low; }

  friend Twofold operator-(const Twofold& a) noexcept { return {-a.high, -a.low}; }
  friend Twofold operator+(const Twofold& a, const Twofold& b) noexcept {
    const Twofold high = sum(a.high, b.high);
    return sum(high.high, high.low + (a.low + b.low));
  }
  friend Twofold operator*(const Twofold& a, const Twofold& b) noexcept {
    const Twofold high = product(a.high, b.high);
    return sum(high.high, high.low + (a.high * b.low + a.low * b.high));
  }
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_TWOFOLD_H_
