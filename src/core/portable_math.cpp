// Computes sine, cosine, arc sine, arc tangent, exponential and logarithm of one number by the polynomials in Google
// Highway's math-inl.h. Every operation is rounded separately, so all compilers give the same bits, which also do not
// change from version to version of this library.
#include "core/portable_math.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/bits.h"

namespace chronormal::inline internal::portable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The argument above which exp() is infinite, and the argument below which exp() is 0.
constexpr double kLargestExponent = 709.8, kSmallestExponent = -746;
// The largest |x| for which the argument reduction of exp() is valid.
constexpr double kFarExponent = 700;

constexpr double kSine[] = {
    -0.166666666666666657414808,    +0.00833333333333332974823815,  -0.000198412698412696162806809,
    +2.75573192239198747630416e-6,  -2.50521083763502045810755e-8,  +1.60590430605664501629054e-10,
    -7.64712219118158833288484e-13, +2.81009972710863200091251e-15, -7.97255955009037868891952e-18};
constexpr double kArcSine[] = {+0.1666666666666497543,  +0.07500000000378581611, +0.04464285681377102438,
                               +0.03038195928038132237, +0.02237176181932048341, +0.01735956991223614604,
                               +0.01388715184501609218, +0.01215360525577377331, +0.006606077476277170610,
                               +0.01929045477267910674, -0.01581918243329996643, +0.03161587650653934628};
constexpr double kArcTangent[] = {
    -0.333333333333311110369124,   +0.199999999996591265594148,   -0.14285714266771329383765,
    +0.111111105648261418443745,   -0.090908995008245008229153,   +0.0769219538311769618355029,
    -0.0666573579361080525984562,  +0.0587666392926673580854313,  -0.0523674852303482457616113,
    +0.0466667150077840625632675,  -0.0407629191276836500001934,  +0.0337852580001353069993897,
    -0.0254517624932312641616861,  +0.016599329773529201970117,   -0.00889896195887655491740809,
    +0.00370026744188713119232403, -0.00110611831486672482563471, +0.000209850076645816976906797,
    -1.88796008463073496563746e-5};
constexpr double kExp[] = {+0.5,
                           +0.166666666666666851703837,
                           +0.0416666666666665047591422,
                           +0.00833333333331652721664984,
                           +0.00138888888889774492207962,
                           +0.000198412698960509205564975,
                           +2.4801587159235472998791e-5,
                           +2.75572362911928827629423e-6,
                           +2.75573911234900471893338e-7,
                           +2.51112930892876518610661e-8,
                           +2.08860621107283687536341e-9};

// Returns the sum of coefficients[i] x^i by Estrin's scheme. The scheme splits the sum at the largest power of two, and
// multiplies the upper half by that power of x.
template <std::size_t kCount>
double polynomial(double x, const double* coefficients) noexcept {
  if constexpr (kCount == 1) {
    return coefficients[0];
  } else {
    constexpr std::size_t kLower = std::bit_floor(kCount - 1);
    double power = x;
    for (std::size_t n = 1; n < kLower; n *= 2) power *= power;
    return power * polynomial<kCount - kLower>(x, coefficients + kLower) + polynomial<kLower>(x, coefficients);
  }
}
template <std::size_t kCount>
double polynomial(double x, const double (&coefficients)[kCount]) noexcept {
  return polynomial<kCount>(x, static_cast<const double*>(coefficients));
}

// Returns the sine of r, or minus the sine if `half_turns` is odd. Precondition: |r| is at most pi / 2.
double sine_of_reduced(double r, std::uint32_t half_turns) noexcept {
  const double x = (half_turns & 1) != 0 ? -r : r, y = x * x;
  return polynomial(y, kSine) * (y * x) + x;
}

// Returns x - q pi in extended precision, with pi as a sum of four numbers.
double reduced(double x, double q) noexcept {
  x = x + q * -3.1415926218032836914;
  x = x + q * -3.1786509424591713469e-8;
  x = x + q * -1.2246467864107188502e-16;
  return x + q * -1.2736634327021899816e-24;
}

// Returns the integer part of x >= 0, or 2^31 - 1 if x is larger or NaN.
std::uint32_t whole_part(double x) noexcept { return x < 0x7FFFFFFF ? static_cast<std::uint32_t>(x) : 0x7FFFFFFF; }

double power_of_two(std::int32_t exponent) noexcept {
  return bit_cast<double>(static_cast<std::uint64_t>(exponent + 0x3FF) << 52);
}

}  // namespace

double sin(double x) noexcept {
  const double size = std::fabs(x);
  const std::uint32_t q = whole_part(size * 0.31830988618379067153 + 0.5);
  const double r = reduced(size, q);
  return sine_of_reduced(std::signbit(x) ? -r : r, q);
}

double cos(double x) noexcept {
  if (x == 0) return 1;
  const double size = std::fabs(x);
  // The zero of the cosine that is nearest to x, as a number of quarter turns, which is odd.
  const std::uint32_t q = 2 * whole_part(size * 0.31830988618379067153) + 1;
  return sine_of_reduced(reduced(size, 0.5 * static_cast<std::int32_t>(q)), (q & 2) == 0 ? 1 : 0);
}

double asin(double x) noexcept {
  const double size = std::fabs(std::clamp(x, -1.0, 1.0));
  const bool is_small = size < 0.5;
  const double yy = is_small ? size * size : 0.5 - size * 0.5;
  const double y = is_small ? size : std::sqrt(yy);
  const double angle = polynomial(yy, kArcSine) * (yy * y) + y;
  return std::copysign(is_small ? angle : std::numbers::pi / 2 - angle * 2, x);
}

double atan(double x) noexcept {
  if (std::isinf(x)) return std::copysign(std::numbers::pi / 2, x);
  const double size = std::fabs(x), q = size > 1 ? 1 / size : size, y = q * q;
  const double angle = polynomial(y, kArcTangent) * (y * q) + q;
  return std::copysign(size > 1 ? std::numbers::pi / 2 - angle : angle, x);
}

double atan2(double y, double x) noexcept {
  const double ax = std::fabs(x), ay = std::fabs(y);
  if (std::isnan(ax) || std::isnan(ay)) return std::numeric_limits<double>::quiet_NaN();
  double angle = 0;  // the angle of (|x|, |y|), in the first quadrant
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
  const double shifted = x * 1.442695040888963407359924681 + std::copysign(0.5, x);
  const auto q = static_cast<std::int32_t>(shifted);  // the nearest whole number to x / log(2)
  const double r = (x + q * -0.6931471805596629565116018) + q * -0.28235290563031577122588448175e-12;
  const double power = (polynomial(r, kExp) * (r * r) + r) + 1;
  const std::int32_t half = q >> 1;
  return power * power_of_two(half) * power_of_two(q - half);
}

double exp2(double x) noexcept {
  const double whole = std::nearbyint(x);  // 2 to this power is exact
  return std::ldexp(exp((x - whole) * std::numbers::ln2), static_cast<int>(std::clamp(whole, -3000.0, 3000.0)));
}

double log(double x) noexcept {
  if (x == 0) return -kInfinity;
  if (!(x > 0) || std::isinf(x)) return x > 0 ? x : std::numeric_limits<double>::quiet_NaN();
  // x is written as 2^exponent y with y in [sqrt(1/2), sqrt(2)), by operations on the upper half of the bits. Subnormal
  // numbers are first multiplied by 2^54.
  constexpr std::uint64_t kOne = 0x3FF0000000000000, kRootOfHalf = 0x3FE6A09E00000000;
  const bool is_subnormal = x < std::numeric_limits<double>::min();
  const auto bits = bit_cast<std::uint64_t>(is_subnormal ? x * 0x1p54 : x);
  const std::uint64_t moved = bits + (kOne - kRootOfHalf);
  const double exponent =
      static_cast<double>(static_cast<std::int64_t>(moved >> 52) - (is_subnormal ? 0x3FF + 54 : 0x3FF));
  const double y = bit_cast<double>((bits & 0xFFFFFFFF) | ((moved & 0xFFFFF00000000) + kRootOfHalf));
  const double z = (y - 1) / (y + 1), z2 = z * z, z4 = z2 * z2;
  const double even = ((1.479819860511658591e-1 * z4 + 1.818357216161805012e-1) * z4 + 2.857142874366239149e-1) * z4 +
                      6.666666666666735130e-1;
  const double odd = (1.531383769920937332e-1 * z4 + 2.222219843214978396e-1) * z4 + 3.999999999940941908e-1;
  const double series = even * z2 + odd * z4;
  return exponent * 6.93147180369123816490e-1 -
         ((z * ((y - 1) - series) - exponent * 1.90821492927058770002e-10) - (y - 1));
}

double hypot(double x, double y, double z) noexcept {
  const double largest = std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
  if (largest == 0 || !std::isfinite(largest)) return largest;
  const int exponent = std::ilogb(largest);
  x = std::ldexp(x, -exponent), y = std::ldexp(y, -exponent), z = std::ldexp(z, -exponent);
  return std::ldexp(std::sqrt(x * x + y * y + z * z), exponent);
}

}  // namespace chronormal::inline internal::portable
