// A single target, of a single lane: no dispatch, and no fused operation.
#undef HWY_COMPILE_ONLY_EMU128  // which the wasm build asks for
#define HWY_COMPILE_ONLY_SCALAR
#include "core/portable_math.h"

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace chronormal::inline internal::portable {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lane = hn::ScalableTag<double>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// From here on exp() is infinite, or 0.
constexpr double kLargestExponent = 709.8, kSmallestExponent = -746;
// Highway's exp() is for less than this.
constexpr double kFarExponent = 700;

double first(hn::Vec<Lane> v) noexcept { return hn::GetLane(v); }

}  // namespace

double sin(double x) noexcept { return first(hn::Sin(Lane(), hn::Set(Lane(), x))); }
double cos(double x) noexcept { return x == 0 ? 1 : first(hn::Cos(Lane(), hn::Set(Lane(), x))); }
double asin(double x) noexcept { return first(hn::Asin(Lane(), hn::Set(Lane(), std::clamp(x, -1.0, 1.0)))); }
double atan(double x) noexcept {
  if (std::isinf(x)) return std::copysign(std::numbers::pi / 2, x);
  return first(hn::Atan(Lane(), hn::Set(Lane(), x)));
}

double atan2(double y, double x) noexcept {
  const double ax = std::fabs(x), ay = std::fabs(y);
  if (std::isnan(ax) || std::isnan(ay)) return std::numeric_limits<double>::quiet_NaN();
  double angle = 0;  // of (|x|, |y|), in the first quadrant
  if (ay > ax) {
    angle = std::numbers::pi / 2 - (std::isinf(ay) ? (std::isinf(ax) ? std::numbers::pi / 4 : 0) : atan(ax / ay));
  } else if (ay > 0) {
    angle = std::isinf(ax) ? (std::isinf(ay) ? std::numbers::pi / 4 : 0) : atan(ay / ax);
  }
  return std::copysign(std::signbit(x) ? std::numbers::pi - angle : angle, y);
}

double exp(double x) noexcept {
  if (std::isnan(x)) return x;
  if (x > kLargestExponent) return kInfinity;
  if (x < kSmallestExponent) return 0;
  if (std::fabs(x) > kFarExponent) return exp(x / 2) * exp(x - x / 2);
  return first(hn::Exp(Lane(), hn::Set(Lane(), x)));
}

double exp2(double x) noexcept {
  const double whole = std::nearbyint(x);  // of which the power is exact
  return std::ldexp(exp((x - whole) * std::numbers::ln2), static_cast<int>(std::clamp(whole, -3000.0, 3000.0)));
}

double log(double x) noexcept {
  if (x == 0) return -kInfinity;
  if (!(x > 0) || std::isinf(x)) return x > 0 ? x : std::numeric_limits<double>::quiet_NaN();
  return first(hn::Log(Lane(), hn::Set(Lane(), x)));
}

double hypot(double x, double y, double z) noexcept {
  const double largest = std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
  if (largest == 0 || !std::isfinite(largest)) return largest;
  const int exponent = std::ilogb(largest);
  x = std::ldexp(x, -exponent), y = std::ldexp(y, -exponent), z = std::ldexp(z, -exponent);
  return std::ldexp(std::sqrt(x * x + y * y + z * z), exponent);
}

}  // namespace chronormal::inline internal::portable
