/// Integers as wide as needed, for sums of products of floats that must not be rounded.
///
/// Every finite float is an integer times 2^-149, so the product of two floats is an integer times 2^-298, and so is
/// every sum of such products. If the whole integer is stored, there is no rounding error, even if terms cancel. The
/// result does not depend on the floating-point unit either: it is the same in every rounding mode, and if subnormal
/// numbers are flushed to zero.
///
///     value = sum of digit(k) 2^(24 k),   24 bits each and signed
///
/// The product of two digits has 48 bits, so thousands of products can be added up in 64 bits before a digit must
/// carry. After settle() all digits are in [-2^23, 2^23). The highest nonzero digit then has the sign of the value, and
/// the value is zero only if all digits are.
///
/// Source: Kulisch, Computer Arithmetic and Validity (2008): an accumulator as long as the range of its products.
#ifndef CHRONORMAL_CORE_WIDE_INTEGER_H_
#define CHRONORMAL_CORE_WIDE_INTEGER_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/bits.h"

namespace chronormal::inline internal {

inline constexpr int kDigitBits = 24;
inline constexpr std::int64_t kDigitBase = std::int64_t{1} << kDigitBits;

/// A finite float as mantissa * 2^(shift - 149). The mantissa is a signed integer of 24 bits, and 0 <= shift <= 253.
struct FloatParts {
  std::int64_t mantissa = 0;
  unsigned shift = 0;

  [[nodiscard]] static FloatParts of(float value) noexcept {
    const auto bits = bit_cast<std::uint32_t>(value);
    const std::uint32_t exponent = bits >> 23 & 0xFF, fraction = bits & 0x7FFFFF;
    const auto size = static_cast<std::int64_t>(exponent == 0 ? fraction : fraction | 0x800000);
    return {(bits >> 31) != 0 ? -size : size, exponent == 0 ? 0 : exponent - 1};
  }
};

/// A finite double as mantissa * 2^(shift - 1074). The mantissa is a signed integer of 53 bits, and 0 <= shift <= 2045.
struct DoubleParts {
  std::int64_t mantissa = 0;
  unsigned shift = 0;

  [[nodiscard]] static DoubleParts of(double value) noexcept {
    const auto bits = bit_cast<std::uint64_t>(value);
    const std::uint64_t exponent = bits >> 52 & 0x7FF, fraction = bits & 0xFFFFFFFFFFFFF;
    const auto size = static_cast<std::int64_t>(exponent == 0 ? fraction : fraction | 0x10000000000000);
    return {(bits >> 63) != 0 ? -size : size, exponent == 0 ? 0 : static_cast<unsigned>(exponent - 1)};
  }
};

/// A double t in [2^-200, 1], or 0, as an integer of 53 bits times 2^-scale. The scale is as small as possible.
struct UnitFraction {
  std::array<std::int64_t, 3> digits{};
  unsigned scale = 0;

  [[nodiscard]] static UnitFraction of(double t) noexcept {
    assert(t == 0 || (0x1p-200 <= t && t <= 1));
    if (t == 0) return {};
    const auto bits = bit_cast<std::uint64_t>(t);
    const std::uint64_t mantissa = (bits & 0xFFFFFFFFFFFFF) | 0x10000000000000;
    const auto zeros = static_cast<unsigned>(std::countr_zero(mantissa));
    const std::uint64_t integer = mantissa >> zeros;
    constexpr std::uint64_t kMask = kDigitBase - 1;
    return {{static_cast<std::int64_t>(integer & kMask), static_cast<std::int64_t>(integer >> kDigitBits & kMask),
             static_cast<std::int64_t>(integer >> 2 * kDigitBits)},
            1075 - static_cast<unsigned>(bits >> 52) - zeros};
  }
};

/// An integer of up to kMost digits. Digits above the highest nonzero digit take no time.
template <std::size_t kMost>
class WideInteger {
 public:
  /// Adds sign * a * b. Up to 2^37 products may be added before settle().
  void add_product(const FloatParts& a, const FloatParts& b, std::int64_t sign = 1) noexcept {
    const std::int64_t product = sign * (a.mantissa * b.mantissa);
    if (product == 0) return;
    const unsigned shift = a.shift + b.shift, k = shift / kDigitBits;
    constexpr std::int64_t kMask = kDigitBase - 1;
    const std::int64_t power = std::int64_t{1} << shift % kDigitBits;
    const std::int64_t low = (product & kMask) * power, high = (product >> kDigitBits) * power;
    grow(k + 3);
    digits_[k] += low & kMask;
    digits_[k + 1] += (low >> kDigitBits) + (high & kMask);
    digits_[k + 2] += high >> kDigitBits;
  }

  /// Adds sign * a / 2^(shift - 1074). a.shift must be at least `shift` unless a is 0. Up to 2^9 such terms may be
  /// added before settle().
  void add(const DoubleParts& a, unsigned shift, std::int64_t sign = 1) noexcept {
    if (a.mantissa == 0) return;
    const std::int64_t mantissa = sign * a.mantissa;
    const std::size_t k = (a.shift - shift) / kDigitBits;
    const std::int64_t power = std::int64_t{1} << (a.shift - shift) % kDigitBits;
    grow(k + 2);
    digits_[k] += (mantissa & (kDigitBase - 1)) * power;
    digits_[k + 1] += (mantissa >> kDigitBits) * power;
  }

  /// Adds factor * other. The digits of `other` must be settled, and |factor| must be at most 2^24.
  template <std::size_t kOther>
  void add(const WideInteger<kOther>& other, std::int64_t factor) noexcept {
    grow(other.size());
    for (std::size_t k = 0; k < other.size(); ++k) digits_[k] += factor * other.digit(k);
  }

  /// Adds sign * a * b. The digits of a and b must be settled. Thousands of products may be added before settle().
  template <std::size_t kA, std::size_t kB>
  void add_product(const WideInteger<kA>& a, const WideInteger<kB>& b, std::int64_t sign = 1) noexcept {
    if (a.size() == 0 || b.size() == 0) return;
    grow(a.size() + b.size() - 1);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const std::int64_t factor = sign * a.digit(i);
      if (factor == 0) continue;
      for (std::size_t k = 0; k < b.size(); ++k) digits_[i + k] += factor * b.digit(k);
    }
  }

  /// Add a multiple of `other`: t 2^t.scale times `other`, or 2^shift times `other`. The digits of `other` must be
  /// below 2^26.
  template <std::size_t kOther>
  void add_product(const WideInteger<kOther>& other, const UnitFraction& t) noexcept {
    for (std::size_t i = 0; i < t.digits.size(); ++i) {
      if (t.digits[i] == 0) continue;
      grow(other.size() + i);
      for (std::size_t k = 0; k < other.size(); ++k) digits_[k + i] += t.digits[i] * other.digit(k);
    }
  }
  template <std::size_t kOther>
  void add_shifted(const WideInteger<kOther>& other, unsigned shift) noexcept {
    const std::size_t by = shift / kDigitBits;
    const std::int64_t power = std::int64_t{1} << shift % kDigitBits;
    grow(other.size() + by);
    for (std::size_t k = 0; k < other.size(); ++k) digits_[k + by] += power * other.digit(k);
  }

  /// Carries until every digit is in [-2^23, 2^23), and drops leading zeros.
  void settle() noexcept {
    std::int64_t carry = 0;
    for (std::size_t k = 0; k < size_ || carry != 0; ++k) {
      grow(k + 1);
      const std::int64_t sum = digits_[k] + carry;
      carry = (sum + kDigitBase / 2) >> kDigitBits;
      digits_[k] = sum - carry * kDigitBase;
    }
    while (size_ > 0 && digits_[size_ - 1] == 0) --size_;
  }

  /// Returns the sign, -1, 0 or 1. The digits must be settled.
  [[nodiscard]] int sign() const noexcept { return size_ == 0 ? 0 : digits_[size_ - 1] < 0 ? -1 : 1; }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::int64_t digit(std::size_t k) const noexcept { return digits_[k]; }
  void set_digit(std::size_t k, std::int64_t value) noexcept {
    grow(k + 1);
    digits_[k] = value;
  }

  /// Returns value * 2^exponent with a relative error of at most 2^-51, if the result is in the range of normal
  /// doubles. The digits must be settled.
  [[nodiscard]] double to_double(int exponent) const noexcept {
    // The four highest digits have at least 71 bits, counted from the highest bit that is set. All lower digits
    // together are less than one unit of the last of these four.
    constexpr std::size_t kTaken = 4;
    const std::size_t end = size_ < kTaken ? 0 : size_ - kTaken;
    double value = 0;
    for (std::size_t k = size_; k > end; --k)
      value = value * static_cast<double>(kDigitBase) + static_cast<double>(digits_[k - 1]);
    return std::ldexp(value, static_cast<int>(end) * kDigitBits + exponent);
  }

 private:
  void grow(std::size_t size) noexcept {
    assert(size <= kMost);
    size_ = std::max(size_, size);
  }

  std::array<std::int64_t, kMost> digits_{};
  std::size_t size_ = 0;  // number of digits in use; all higher digits are zero
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_WIDE_INTEGER_H_
