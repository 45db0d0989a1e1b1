/// Functions of <cmath> that are not exactly rounded, with the same bits on every machine and from every compiler.
///
/// The standard library's differ from system to system, and even from processor to processor, in the last bits; what is
/// computed with them would make files and reports differ. These are polynomials of Google Highway, without fused
/// operations. Square roots, rounding and remainders are exact anyway, and stay those of the standard library.
///
/// Errors     below 5 units in the last place; arguments that are not finite as in <cmath>, but sin() and cos() of them
/// Threads    pure
#ifndef CHRONORMAL_CORE_PORTABLE_MATH_H_
#define CHRONORMAL_CORE_PORTABLE_MATH_H_

namespace chronormal::inline internal::portable {

/// For |x| up to 39,000.
[[nodiscard]] double sin(double x) noexcept;
[[nodiscard]] double cos(double x) noexcept;
/// For |x| up to 1; beyond that as at 1.
[[nodiscard]] double asin(double x) noexcept;
[[nodiscard]] double atan(double x) noexcept;
/// The angle of the vector (x, y), in [-pi, pi]; that of the zero vector is 0, or pi where x is -0.
[[nodiscard]] double atan2(double y, double x) noexcept;
[[nodiscard]] double exp(double x) noexcept;
[[nodiscard]] double exp2(double x) noexcept;
/// For x above 0; of 0 it is minus infinity.
[[nodiscard]] double log(double x) noexcept;
/// Without overflow on the way.
[[nodiscard]] double hypot(double x, double y, double z = 0) noexcept;

}  // namespace chronormal::inline internal::portable

#endif  // CHRONORMAL_CORE_PORTABLE_MATH_H_
