/// The functions of <cmath> that are not exactly rounded, with the same bits on every machine and from every compiler.
///
/// The last bits of the results of the standard library differ from system to system, and even from processor to
/// processor. Files and reports that were computed with these functions would differ, too. The functions here are
/// polynomials of Google Highway, without fused operations. Square roots, rounding and remainders are exact everywhere,
/// so the library uses those of the standard library.
///
/// Errors     below 5 units in the last place; for infinity and NaN the results equal those of <cmath>, except in sin()
///            and cos()
/// Threads    pure
#ifndef CHRONORMAL_CORE_PORTABLE_MATH_H_
#define CHRONORMAL_CORE_PORTABLE_MATH_H_

namespace chronormal::inline internal::portable {

/// Return the sine and the cosine of x, which is in radians, for |x| <= 39,000.
[[nodiscard]] double sin(double x) noexcept;
[[nodiscard]] double cos(double x) noexcept;
/// Returns the arc sine of x in radians. If |x| > 1, returns the arc sine of 1 or -1, whichever is nearer to x.
[[nodiscard]] double asin(double x) noexcept;
[[nodiscard]] double atan(double x) noexcept;
/// Returns the angle of the vector (x, y) in radians, in [-pi, pi]. The zero vector has the angle 0, or pi if x is -0.
[[nodiscard]] double atan2(double y, double x) noexcept;
[[nodiscard]] double exp(double x) noexcept;
[[nodiscard]] double exp2(double x) noexcept;
/// Returns the natural logarithm of x >= 0, which is minus infinity for 0.
[[nodiscard]] double log(double x) noexcept;
/// Returns the length of (x, y, z), computed without overflow in between.
[[nodiscard]] double hypot(double x, double y, double z = 0) noexcept;

}  // namespace chronormal::inline internal::portable

#endif  // CHRONORMAL_CORE_PORTABLE_MATH_H_
