/// Arithmetic of vectors of long double, and the angles between them, for oracles. The file shares no code with
/// chronormal.
#ifndef TESTS_SUPPORT_LONG_VECTORS_H_
#define TESTS_SUPPORT_LONG_VECTORS_H_

#include <array>
#include <cmath>
#include <numbers>

namespace chronormal::test {

using Real = long double;
using Vector = std::array<Real, 3>;

[[nodiscard]] inline Vector crossed(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline Real dotted(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
[[nodiscard]] inline Real length_of(const Vector& a) { return std::sqrt(dotted(a, a)); }
[[nodiscard]] inline double degrees_between(const Vector& a, const Vector& b) {
  const Real radians = std::atan2(length_of(crossed(a, b)), dotted(a, b));
  return static_cast<double>(radians * 180 / std::numbers::pi_v<Real>);
}

}  // namespace chronormal::test

#endif  // TESTS_SUPPORT_LONG_VECTORS_H_
