// Proves for sixteen elements, in lanes of double, that n(t) stays long enough. The code does the same operations as
// certificate.h.
#include "normals/curves/kernels/certify.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "normals/curves/certificate.h"
#include "normals/curves/kernels/flagged_normals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/certify.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

using DoubleMask = hn::Mask<DoubleTag>;

HWY_INLINE Doubles AllOf(double value) { return hn::Set(kDoubles, value); }
HWY_INLINE Doubles LargestOf(const Doubles3& v) { return LargerAbs(LargerAbs(v.x, v.y), v.z); }
HWY_INLINE bool None(DoubleMask mask) { return hn::AllFalse(kDoubles, mask); }

// The Bernstein coefficients of a quadratic of vectors, and of a quadratic of numbers, in each lane.
struct Vectors {
  Doubles3 n0, m, n1;
};
struct Numbers {
  Doubles n0, m, n1;
};
struct Quartic {
  Doubles at[5];
};

// Returns the lanes among `open` in which it is proven that p >= 0 on [0, 1]. The interval is halved, as by
// certainly_not_negative().
template <int kDepth>
HWY_NOINLINE DoubleMask CertainlyNotNegative(const Quartic& p, DoubleMask open) {
  const Doubles zero = hn::Zero(kDoubles), half = AllOf(0.5);
  const auto at_ends = hn::And(open, hn::Not(hn::Or(hn::Lt(p.at[0], zero), hn::Lt(p.at[4], zero))));
  auto proven = hn::And(at_ends, hn::Ge(p.at[0], zero));
  for (std::size_t k = 1; k < 5; ++k) proven = hn::And(proven, hn::Ge(p.at[k], zero));
  if constexpr (kDepth == 0) {
    return proven;
  } else {
    open = hn::AndNot(proven, at_ends);
    if (None(open)) return proven;
    Quartic before, after, row = p;
    for (std::size_t level = 0; level < 5; ++level) {
      before.at[level] = row.at[0];
      after.at[4 - level] = row.at[4 - level];
      for (std::size_t k = 0; k + level + 1 < 5; ++k)
        row.at[k] = hn::Add(hn::Mul(half, row.at[k]), hn::Mul(half, row.at[k + 1]));
    }
    open = CertainlyNotNegative<kDepth - 1>(before, open);
    if (None(open)) return proven;
    return hn::Or(proven, CertainlyNotNegative<kDepth - 1>(after, open));
  }
}

// Returns the square of a quadratic. product(i, j) multiplies two coefficients and is symmetric, so each product is
// computed once.
template <class Product>
HWY_INLINE Quartic Square(const Product& product) {
  const Doubles sixth = AllOf(1.0 / 6), two_thirds = AllOf(4.0 / 6), ends = hn::Mul(sixth, product(0, 2));
  return {{product(0, 0), product(0, 1), hn::Add(hn::Add(ends, hn::Mul(two_thirds, product(1, 1))), ends),
           product(1, 2), product(2, 2)}};
}

HWY_INLINE Quartic Square(const Numbers& n) {
  const Doubles at[3] = {n.n0, n.m, n.n1};
  return Square([&at](std::size_t i, std::size_t j) HWY_ATTR { return hn::Mul(at[i], at[j]); });
}
HWY_INLINE Quartic Square(const Vectors& n) {
  const Doubles3 at[3] = {n.n0, n.m, n.n1};
  return Square([&at](std::size_t i, std::size_t j) HWY_ATTR { return Dot(at[i], at[j]); });
}

// Returns the lanes among `open` in which it is proven that ratio |n(t)| >= limit(t) at every t.
HWY_INLINE DoubleMask StaysAbove(const Quartic& n_square, double ratio, const Quartic& limit_square, DoubleMask open) {
  if (None(open)) return open;
  const Doubles ratio_square = AllOf(ratio * ratio);
  Quartic slack;
  for (std::size_t k = 0; k < 5; ++k) slack.at[k] = hn::Sub(hn::Mul(ratio_square, n_square.at[k]), limit_square.at[k]);
  return CertainlyNotNegative<kCertificateDepth>(slack, open);
}

// The values of the Bernstein polynomials of degrees 2 and 4 at an instant.
struct Instant {
  double of_degree2[3], of_degree4[5];
};
inline constexpr Instant kInstants[] = {
    {{1.0 / 4, 1.0 / 2, 1.0 / 4}, {1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16}},
    {{9.0 / 16, 6.0 / 16, 1.0 / 16}, {81.0 / 256, 108.0 / 256, 54.0 / 256, 12.0 / 256, 1.0 / 256}},
    {{1.0 / 16, 6.0 / 16, 9.0 / 16}, {1.0 / 256, 12.0 / 256, 54.0 / 256, 108.0 / 256, 81.0 / 256}}};

// A comparison of |n(t)| with its limits at a few instants, which costs far less than a proof. If n(t) is too short at
// one of these instants, no proof can succeed.
class Glance {
 public:
  HWY_INLINE Glance(const Quartic& n_square, const Doubles (&length_square)[3]) {
    for (std::size_t i = 0; i < kCount; ++i) {
      const Instant& at = kInstants[i];
      Doubles square = hn::Zero(kDoubles), limit = square;
      for (std::size_t k = 0; k < 5; ++k) square = hn::Add(square, hn::Mul(AllOf(at.of_degree4[k]), n_square.at[k]));
      for (std::size_t k = 0; k < 3; ++k)
        limit = hn::Add(limit, hn::Mul(AllOf(at.of_degree2[k] * at.of_degree2[k]), length_square[k]));
      square_[i] = square;
      limit_[i] = limit;
    }
  }

  // Returns the lanes in which ratio |n(t)| >= 1 holds at the instants kInstants, so that it may hold at every t.
  HWY_INLINE DoubleMask MayStayAboveOne(double ratio) const {
    Doubles smallest = square_[0];
    for (std::size_t i = 1; i < kCount; ++i) smallest = hn::Min(smallest, square_[i]);
    return hn::Ge(hn::Mul(AllOf(kUp * ratio * ratio), smallest), AllOf(1));
  }

  // Returns the lanes in which ratio |n(t)| >= sum w_k |c_k| may hold at every t. limit_ has sums of squares, which are
  // smaller than the square of that sum.
  HWY_INLINE DoubleMask MayStayAbove(double ratio) const {
    const Doubles factor = AllOf(kUp * ratio * ratio);
    auto may = hn::Ge(hn::Mul(factor, square_[0]), limit_[0]);
    for (std::size_t i = 1; i < kCount; ++i) may = hn::And(may, hn::Ge(hn::Mul(factor, square_[i]), limit_[i]));
    return may;
  }

 private:
  static constexpr std::size_t kCount = std::size(kInstants);
  static constexpr double kUp = 1 + 0x1p-40;  // the factor that allows for all rounding errors of these comparisons
  Doubles square_[kCount], limit_[kCount];
};

HWY_INLINE Doubles ScaledLength(const Doubles3& v) { return hn::Sqrt(Dot(v, v)); }

HWY_INLINE Numbers LengthsOf(const Vectors& n, const Quartic& n_square) {
  return {hn::Sqrt(n_square.at[0]), ScaledLength(n.m), hn::Sqrt(n_square.at[4])};
}

// Returns the lanes among `open` in which it is proven, as by stays_certain(), that n(t) stays above the relative size
// `certain` at every t. The control normals `n` are scaled to a size of 1.
HWY_INLINE DoubleMask StaysCertain(const Vectors& n, const Quartic& n_square, Doubles certain, DoubleMask open) {
  const Doubles share = hn::Mul(AllOf(4), certain);
  const Doubles height = hn::Abs(Dot(n.n0, Cross(n.m, n.n1)));
  const Doubles area = ScaledLength(Cross(n.m - n.n0, n.n1 - n.n0));
  const auto proven = hn::And(open, hn::Ge(height, hn::Add(hn::Mul(share, area), AllOf(kDeterminantRounding))));
  open = hn::AndNot(proven, open);
  if (None(open)) return proven;
  const Numbers lengths = LengthsOf(n, n_square);
  const auto too_short = [](const Doubles3& v, Doubles size) HWY_ATTR {
    return hn::And(hn::Gt(LargestOf(v), hn::Zero(kDoubles)), hn::Lt(size, AllOf(kSmallestLength)));
  };
  const auto unknown =
      hn::Or(hn::Or(too_short(n.n0, lengths.n0), too_short(n.m, lengths.m)), too_short(n.n1, lengths.n1));
  open = hn::AndNot(unknown, open);
  if (None(open)) return proven;
  const Doubles limit = hn::Max(share, AllOf(kSmallestProvenShare));
  const Numbers limits{hn::Mul(limit, lengths.n0), hn::Mul(limit, lengths.m), hn::Mul(limit, lengths.n1)};
  return hn::Or(proven, StaysAbove(n_square, 1, Square(limits), open));
}

HWY_INLINE Doubles3 VectorAt(const BoundedTile& tile, std::size_t k, std::size_t lane) {
  return {hn::Load(kDoubles, tile.normals[k] + lane), hn::Load(kDoubles, tile.normals[k + 1] + lane),
          hn::Load(kDoubles, tile.normals[k + 2] + lane)};
}

HWY_INLINE void StoreScaled(Doubles scale, const Doubles3& v, FlaggedTile& tile, std::size_t k, std::size_t lane) {
  const Doubles3 scaled = Scale(scale, v);
  hn::Store(scaled.x, kDoubles, tile.normals[k] + lane);
  hn::Store(scaled.y, kDoubles, tile.normals[k + 1] + lane);
  hn::Store(scaled.z, kDoubles, tile.normals[k + 2] + lane);
}

void CertifyLanes(const BoundedTile& tile, const PrecisionLimits& limits, std::size_t lane, std::uint32_t asked,
                  TileCertificates& result) {
  const Doubles zero = hn::Zero(kDoubles), one = AllOf(1);
  const Vectors given{VectorAt(tile, 0, lane), VectorAt(tile, 3, lane), VectorAt(tile, 6, lane)};
  const Doubles size0 = LargestOf(given.n0), size_m = LargestOf(given.m), size1 = LargestOf(given.n1);
  const Doubles largest = hn::Max(hn::Max(size0, size_m), size1);
  // A NaN may be lost in the maximum of two numbers, so the sum of all nine components is computed, which is NaN if any
  // component is NaN.
  const Doubles3 sums = (given.n0 + given.m) + given.n1;
  const Doubles sum = hn::Add(hn::Add(sums.x, sums.y), sums.z);
  const auto in_range =
      hn::And(hn::And(hn::Ge(hn::Min(size0, size1), AllOf(kSmallestEnd)), hn::Le(largest, AllOf(kLargestComponent))),
              hn::Eq(sum, sum));

  const auto share_of = [&](std::size_t k, Doubles size) HWY_ATTR {
    const Doubles error = hn::Load(kDoubles, tile.errors[k] + lane);
    return hn::IfThenZeroElse(hn::Eq(error, zero), hn::Div(error, size));
  };
  const Doubles share = hn::Max(hn::Max(share_of(0, size0), share_of(1, size_m)), share_of(2, size1));
  const auto known = hn::And(in_range, hn::Le(share, AllOf(kLargestShare)));
  const std::uint32_t known_bits = BitsOf(kDoubles, known) & asked;
  if (known_bits == 0) return;

  const Doubles scale = hn::Div(one, largest);
  const Vectors n{Scale(scale, given.n0), Scale(scale, given.m), Scale(scale, given.n1)};
  const Quartic n_square = Square(n);
  const Glance glance(n_square, {n_square.at[0], Dot(n.m, n.m), n_square.at[4]});
  auto open = known;
  const auto settle = [&](DoubleMask fits, Precision precision) HWY_ATTR {
    if ((BitsOf(kDoubles, fits) & asked) != 0) result.precision = std::max(result.precision, precision);
    open = hn::AndNot(fits, open);
  };
  if (limits.largest_ratio16 > 0) {
    const Quartic ones{{one, one, one, one, one}};
    const auto may_fit16 = hn::And(open, glance.MayStayAboveOne(limits.largest_ratio16));
    const auto fits16 = StaysAbove(n_square, limits.largest_ratio16, ones, may_fit16);
    const auto fits11 = StaysAbove(n_square, limits.largest_ratio11, ones, fits16);
    settle(fits11, Precision::k11);
    settle(hn::AndNot(fits11, fits16), Precision::k16);
  }
  const auto may_fit_scaled = hn::And(open, glance.MayStayAbove(limits.sum_ratio_scaled16));
  if (limits.sum_ratio_scaled16 > 0 && !None(may_fit_scaled)) {
    const Doubles more = AllOf(kSmallestScale);
    const Numbers lengths = LengthsOf(n, n_square);
    const Numbers scales{hn::Add(lengths.n0, more), hn::Add(lengths.m, more), hn::Add(lengths.n1, more)};
    settle(StaysAbove(n_square, limits.sum_ratio_scaled16, Square(scales), may_fit_scaled), Precision::kScaled16);
  }
  const auto may_fit32 = hn::And(open, glance.MayStayAbove(limits.sum_ratio32));
  if (!None(may_fit32))
    settle(StaysAbove(n_square, limits.sum_ratio32, Square(LengthsOf(n, n_square)), may_fit32), Precision::k32);

  result.known |= known_bits << lane;
  const std::uint32_t flagged = BitsOf(kDoubles, open) & asked;
  if (flagged == 0) return;
  const Doubles certain = hn::Max(AllOf(0x1p-26), hn::Mul(AllOf(0x1p22), share));
  // Elements are scaled by a power of two, which is the inverse of their largest component up to a factor of 2. The
  // power of two and the largest component are normal numbers here.
  const hn::RebindToSigned<DoubleTag> bits;
  const auto exponent = hn::And(hn::BitCast(bits, largest), hn::Set(bits, std::int64_t{0x7FF} << 52));
  const Doubles power = hn::BitCast(kDoubles, hn::Sub(hn::Set(bits, std::int64_t{0x7FE} << 52), exponent));
  StoreScaled(power, given.n0, result.scaled, 0, lane);
  StoreScaled(power, given.m, result.scaled, 3, lane);
  StoreScaled(power, given.n1, result.scaled, 6, lane);
  const HalfFloatTag floats;
  alignas(64) std::int64_t exponents[kDoubleLanes];
  hn::Store(exponent, bits, exponents);
  for (std::size_t i = 0; i < kDoubleLanes; ++i)
    result.exponents[lane + i] = static_cast<std::int16_t>((exponents[i] >> 52) - 1023);
  const Doubles sizes[3] = {size0, size_m, size1};
  for (std::size_t k = 0; k < 3; ++k) {
    const Doubles limit = hn::Mul(AllOf(kLimitUp), hn::Mul(certain, hn::Mul(power, sizes[k])));
    hn::StoreU(hn::DemoteTo(floats, hn::Max(AllOf(kLeastLimit), limit)), floats, result.scaled.limits[k] + lane);
  }
  const auto stays = StaysCertain(n, n_square, certain, open);
  result.flagged |= flagged << lane;
  result.needs_exact |= (flagged & ~BitsOf(kDoubles, stays)) << lane;
}

void CertifyTile(const BoundedTile& tile, const PrecisionLimits& limits, std::uint32_t asked,
                 TileCertificates& result) {
  constexpr std::uint32_t kOfVector = (1u << kDoubleLanes) - 1;
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    const std::uint32_t some = asked >> lane & kOfVector;
    if (some != 0) CertifyLanes(tile, limits, lane, some, result);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(CertifyTile);

void certify_tile(const BoundedTile& tile, const PrecisionLimits& limits, std::uint32_t asked,
                  TileCertificates& result) noexcept {
  result.clear();
  HWY_DYNAMIC_DISPATCH(CertifyTile)(tile, limits, asked, result);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
