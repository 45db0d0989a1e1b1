/// The functions of <cmath> that are not exactly rounded, with the same bits on every machine and from every compiler.
///
/// The last bits of the standard library's functions differ from system to system, and even from processor to
/// processor, so files and reports that are computed with them would differ. The functions here are polynomials of
/// Google Highway, without fused operations. Square roots, rounding and remainders are exact everywhere, so the
/// standard library's are used.
///
/// Errors     below 5 units in the last place; for infinity and NaN the results equal those of <cmath>, except in sin()
///            and cos()
/// Threads    pure
#ifndef CHRONORMAL_CORE_PORTABLE_MATH_H_
#define CHRONORMAL_CORE_PORTABLE_MATH_H_

namespace chronormal::inline internal::portable {

/// Return the sine and the cosine of x, |x| <= 39,000.
[[nodiscard]] double sin(double x) noexcept;
[[nodiscard]] double cos(double x) noexcept;
/// Returns the arc sine of x. Beyond |x| = 1 the result is that at the nearer end.
[[nodiscard]] double asin(double x) noexcept;
[[nodiscard]] double atan(double x) noexcept;
/// Returns the angle of the vector (x, y), in [-pi, pi]. The zero vector has the angle 0, or pi if x is -0.
[[nodiscard]] double atan2(double y, double x) noexcept;
[[nodiscard]] double exp(double x) noexcept;
[[nodiscard]] double exp2(double x) noexcept;
/// Returns the logarithm of x >= 0, which is minus infinity for 0.
[[nodiscard]] double log(double x) noexcept;
/// Returns the length of (x, y, z), without overflow on the way.
[[nodiscard]] double hypot(double x, double y, double z = 0) noexcept;

}  // namespace chronormal::inline internal::portable

#endif  // CHRONORMAL_CORE_PORTABLE_MATH_H_
