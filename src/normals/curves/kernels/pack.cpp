#include "normals/curves/kernels/pack.h"

#include <cassert>
#include <cmath>

#include "chronormal/normals/normal_curves.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/pack.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE Lanes3 LoadTileVector(const ControlTile& tile, std::size_t k, std::size_t lane) {
  const float* const p = &tile.normals[3 * k][lane];
  return {hn::Load(kFloats, p), hn::Load(kFloats, p + kTile), hn::Load(kFloats, p + 2 * kTile)};
}

HWY_INLINE Floats MaxAbs(const Lanes3& v) { return hn::Max(hn::Max(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z)); }

// The results of the tests of all lanes. Each number has a bit for each lane, with the first lane in the lowest bit.
struct LaneTests {
  std::uint32_t certain = 0, fits11 = 0, fits16 = 0, moving = 0, bending = 0;
};

// The three control normals of a piece of a curve, and their lengths, with one curve in each lane.
struct Piece {
  Lanes3 n0, m, n1;
  Floats l0, lm, l1;
};

// The result of the test of a piece: whether n(t) certainly stays long enough for float32, and if so a lower bound of
// |n(t)|^2.
struct PieceTest {
  hn::Mask<FloatTag> certain;
  Floats shortest_square;
};

// The largest number of times that a piece is halved, if the test of the whole piece gives no answer.
inline constexpr int kPieceDepth = 2;

HWY_INLINE Floats Middle(Floats a, Floats b) { return hn::Mul(hn::Set(kFloats, 0.5f), hn::Add(a, b)); }
HWY_INLINE Lanes3 Middle(const Lanes3& a, const Lanes3& b) { return Scale(hn::Set(kFloats, 0.5f), a + b); }

// Tests eq. 11 of docs/theory.md for whole pieces first and then for halves. Stops when every lane is decided, or when
// its |n(t)|^2 is known to be at least `enough`. The result of a lane does not depend on the other lanes.
template <int kDepth>
HWY_NOINLINE PieceTest TestPiece(const Piece& p, hn::Mask<FloatTag> needed, Floats enough) {
  // The largest ratio for which float32 is exact enough is 3 (docs/theory.md, section 13). Its square is reduced from 9
  // to 8.7 for safety.
  const Floats sum_ratio_square = hn::Set(kFloats, 8.7f), third = hn::Set(kFloats, 1.0f / 3);
  const auto in_middle = [&](Floats ends, Floats middle)
                             HWY_ATTR { return hn::Mul(third, hn::Add(ends, hn::Add(middle, middle))); };
  const Floats square[5] = {Dot(p.n0, p.n0), Dot(p.n0, p.m), in_middle(Dot(p.n0, p.n1), Dot(p.m, p.m)), Dot(p.m, p.n1),
                            Dot(p.n1, p.n1)};
  const Floats limit[5] = {hn::Mul(p.l0, p.l0), hn::Mul(p.l0, p.lm),
                           in_middle(hn::Mul(p.l0, p.l1), hn::Mul(p.lm, p.lm)), hn::Mul(p.lm, p.l1),
                           hn::Mul(p.l1, p.l1)};
  PieceTest whole{hn::Ge(hn::Mul(sum_ratio_square, square[0]), limit[0]), square[0]};
  for (std::size_t k = 1; k < 5; ++k) {
    whole.certain = hn::And(whole.certain, hn::Ge(hn::Mul(sum_ratio_square, square[k]), limit[k]));
    whole.shortest_square = hn::Min(whole.shortest_square, square[k]);
  }
  if constexpr (kDepth == 0) {
    return whole;
  } else {
    const auto done = hn::And(whole.certain, hn::Ge(whole.shortest_square, enough));
    auto open = hn::AndNot(done, needed);
    if (hn::AllFalse(kFloats, open)) return whole;
    const Lanes3 a = Middle(p.n0, p.m), b = Middle(p.m, p.n1), c = Middle(a, b);
    const Floats la = Middle(p.l0, p.lm), lb = Middle(p.lm, p.l1), lc = Middle(la, lb);
    // Both halves of the piece contain this middle point, so halving does not help in lanes in which n(t) is too short
    // here.
    open = hn::And(open, hn::Ge(hn::Mul(sum_ratio_square, Dot(c, c)), hn::Mul(lc, lc)));
    if (hn::AllFalse(kFloats, open)) return whole;
    const PieceTest before = TestPiece<kDepth - 1>({p.n0, a, c, p.l0, la, lc}, open, enough);
    const PieceTest after = TestPiece<kDepth - 1>({c, b, p.n1, lc, lb, p.l1}, open, enough);
    return {hn::Or(whole.certain, hn::And(before.certain, after.certain)),
            hn::IfThenElse(done, whole.shortest_square, hn::Min(before.shortest_square, after.shortest_square))};
  }
}

// Tests the elements in some lanes. Squares are compared, so that no root is needed. With the axis a = n0 + 2 m + n1,
// n(t).a >= min c(k).a for all t, where c(k) are the control normals.
HWY_INLINE LaneTests TestLanes(const ControlTile& tile, std::size_t lane, Floats square11, Floats square16,
                               Floats noise_square) {
  // The squared ratio that TestPiece() also uses: the largest for which float32 is exact enough.
  const Floats sum_ratio_square = hn::Set(kFloats, 8.7f);
  const Floats smallest_largest = hn::Set(kFloats, 0x1p-30f), largest_largest = hn::Set(kFloats, 0x1p50f);

  Lanes3 n0 = LoadTileVector(tile, 0, lane), m = LoadTileVector(tile, 1, lane), n1 = LoadTileVector(tile, 2, lane);
  const Floats largest = hn::Max(hn::Max(MaxAbs(n0), MaxAbs(m)), MaxAbs(n1));
  const auto in_range = hn::And(hn::Ge(largest, smallest_largest), hn::Le(largest, largest_largest));

  // Values are scaled by a power of two, so that the largest is in [1, 2). Fourth powers then stay in the range of
  // float32.
  const Ints exponent = hn::And(hn::BitCast(kInts, largest), hn::Set(kInts, 0x7F800000));
  const Floats scale = hn::BitCast(kFloats, hn::Sub(hn::Set(kInts, 0x7F000000), exponent));
  n0 = Scale(scale, n0);
  m = Scale(scale, m);
  n1 = Scale(scale, n1);
  const Floats size = hn::Mul(scale, largest), magnitude = hn::Mul(scale, hn::Load(kFloats, tile.magnitude + lane));
  const Floats size_square = hn::Mul(size, size), noise = hn::Mul(noise_square, hn::Mul(magnitude, magnitude));

  const Lanes3 axis = (n0 + n1) + (m + m);
  const Floats axis_square = Dot(axis, axis);
  const Floats along0 = Dot(n0, axis), along_m = Dot(m, axis), along1 = Dot(n1, axis);
  const Floats square0 = Dot(n0, n0), square_m = Dot(m, m), square1 = Dot(n1, n1);
  const auto within_cone = [&](Floats c_square, Floats along) HWY_ATTR {
    return hn::And(hn::Gt(along, hn::Zero(kFloats)),
                   hn::Ge(hn::Mul(sum_ratio_square, hn::Mul(along, along)), hn::Mul(c_square, axis_square)));
  };
  const Floats shortest = hn::Min(hn::Min(along0, along_m), along1);
  const Floats shortest_square = hn::Mul(shortest, shortest);
  const auto at_least = [&](Floats factor, Floats square) HWY_ATTR {  // compares |n(t)|^2 with a limit
    return hn::Ge(hn::Mul(factor, shortest_square), hn::Mul(square, axis_square));
  };
  const Floats one = hn::Set(kFloats, 1.0f);
  auto certain =
      hn::And(hn::And(within_cone(square0, along0), within_cone(square_m, along_m)), within_cone(square1, along1));
  certain = hn::And(hn::And(certain, in_range), at_least(one, noise));
  auto fits11 = at_least(square11, size_square), fits16 = at_least(square16, size_square);

  const auto unknown = hn::AndNot(certain, in_range);
  if (!hn::AllFalse(kFloats, unknown)) {
    // Elements that reach this point come so close to zero that eleven bits rarely suffice, unless the tolerance is
    // large.
    const Floats fewest = hn::Set(kFloats, 3.0f);
    const auto try11 = hn::Ge(square11, fewest), try16 = hn::Gt(square16, hn::Zero(kFloats));
    const Floats wanted = hn::IfThenElse(try11, square11, square16);
    const Floats enough = hn::IfThenElseZero(try16, hn::Div(size_square, wanted));
    const PieceTest test =
        TestPiece<kPieceDepth>({n0, m, n1, hn::Sqrt(square0), hn::Sqrt(square_m), hn::Sqrt(square1)}, unknown, enough);
    const auto proven = hn::And(hn::And(unknown, test.certain), hn::Ge(test.shortest_square, noise));
    const auto fits = [&](Floats square) HWY_ATTR {
      return hn::And(proven, hn::Ge(hn::Mul(square, test.shortest_square), size_square));
    };
    fits11 = hn::Or(hn::And(certain, fits11), hn::And(fits(square11), try11));
    fits16 = hn::Or(hn::And(certain, fits16), fits(square16));
    certain = hn::Or(certain, proven);
  }
  const Floats degree = hn::ConvertTo(kFloats, hn::Load(kInts, tile.degree + lane));
  return {BitsOf(kFloats, certain), BitsOf(kFloats, fits11), BitsOf(kFloats, fits16),
          BitsOf(kFloats, hn::Gt(degree, hn::Zero(kFloats))), BitsOf(kFloats, hn::Gt(degree, one))};
}

void SummarizeTiles(const ControlTile* tiles, std::size_t count, const PrecisionLimits& limits,
                    TileSummary* summaries) {
  // The limits are reduced slightly to allow for the rounding of the tests themselves.
  constexpr double kSafe = 0.99;
  const auto square = [](double ratio) { return static_cast<float>(kSafe * ratio * ratio); };
  const Floats square11 = hn::Set(kFloats, square(limits.largest_ratio11));
  const Floats square16 = hn::Set(kFloats, square(limits.largest_ratio16));
  const Floats noise_square =
      hn::Set(kFloats, static_cast<float>(1 / (limits.largest_magnitude * limits.largest_magnitude)));
  const Precision above16 = limits.sum_ratio_scaled16 >= 3 ? Precision::kScaled16 : Precision::k32;

  for (std::size_t i = 0; i < count; ++i) {
    LaneTests all;
    for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
      const LaneTests some = TestLanes(tiles[i], lane, square11, square16, noise_square);
      all.certain |= some.certain << lane;
      all.fits11 |= some.fits11 << lane;
      all.fits16 |= some.fits16 << lane;
      all.moving |= some.moving << lane;
      all.bending |= some.bending << lane;
    }
    constexpr std::uint32_t kAll = 0xFFFF;
    const std::uint32_t uncertain = ~all.certain & kAll;
    Precision precision = above16;
    if ((all.fits11 | uncertain) == kAll) {
      precision = Precision::k11;
    } else if ((all.fits16 | uncertain) == kAll) {
      precision = Precision::k16;
    }
    summaries[i] = {uncertain, all.moving, all.bending, precision};
  }
}

HWY_INLINE void StoreVector(const Lanes3& v, float* plane) {
  hn::Store(v.x, kFloats, plane);
  hn::Store(v.y, kFloats, plane + kTile);
  hn::Store(v.z, kFloats, plane + 2 * kTile);
}

HWY_INLINE Ints PairOf(Ints low, Ints high) {
  return hn::Or(hn::And(low, hn::Set(kInts, 0xFFFF)), hn::ShiftLeft<16>(high));
}

struct Lanes3i {
  Ints x, y, z;
};

HWY_INLINE Lanes3i Rounded(Floats scale, const Lanes3& v) {
  const Lanes3 scaled = Scale(scale, v);
  return {RoundToInt(scaled.x), RoundToInt(scaled.y), RoundToInt(scaled.z)};
}

HWY_INLINE Floats Largest(const Lanes3& n0, const Lanes3& m, const Lanes3& n1) {
  return hn::Max(hn::Max(MaxAbs(n0), MaxAbs(m)), MaxAbs(n1));
}

// Returns the factor that maps components of up to `largest` to numbers from -limit to limit.
HWY_INLINE Floats IntegersPer(float limit, Floats largest) { return hn::Div(hn::Set(kFloats, limit), largest); }

void PackUnit(const ControlTile& tile, bool with_length, float* to) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const Lanes3 n = LoadTileVector(tile, 0, lane);
    StoreVector(Normalized(n), to + lane);
    if (with_length) hn::Store(hn::Sqrt(Dot(n, n)), kFloats, to + 3 * kTile + lane);
  }
}

void PackLinear32(const ControlTile& tile, float* to) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    StoreVector(LoadTileVector(tile, 0, lane), to + lane);
    StoreVector(LoadTileVector(tile, 2, lane), to + 3 * kTile + lane);
  }
}

void PackQuadratic32(const ControlTile& tile, float* to) {
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t lane = 0; lane < kTile; lane += kLanes)
      StoreVector(LoadTileVector(tile, k, lane), to + 3 * k * kTile + lane);
  }
}

HWY_INLINE void StoreEnds(const Lanes3i& n0, const Lanes3i& n1, std::int32_t* to) {
  hn::Store(PairOf(n0.x, n1.x), kInts, to);
  hn::Store(PairOf(n0.y, n1.y), kInts, to + kTile);
  hn::Store(PairOf(n0.z, n1.z), kInts, to + 2 * kTile);
}

void PackLinear16(const ControlTile& tile, std::int32_t* to) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const Lanes3 n0 = LoadTileVector(tile, 0, lane), n1 = LoadTileVector(tile, 2, lane);
    const Floats scale = IntegersPer(32767, hn::Max(MaxAbs(n0), MaxAbs(n1)));
    StoreEnds(Rounded(scale, n0), Rounded(scale, n1), to + lane);
  }
}

void PackQuadratic16(const ControlTile& tile, std::int32_t* to) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const Lanes3 n0 = LoadTileVector(tile, 0, lane), m = LoadTileVector(tile, 1, lane),
                 n1 = LoadTileVector(tile, 2, lane);
    const Floats scale = IntegersPer(32767, Largest(n0, m, n1));
    StoreEnds(Rounded(scale, n0), Rounded(scale, n1), to + lane);
    const Lanes3i middle = Rounded(scale, m);
    hn::Store(PairOf(middle.x, middle.y), kInts, to + 3 * kTile + lane);
    hn::Store(hn::And(middle.z, hn::Set(kInts, 0xFFFF)), kInts, to + 4 * kTile + lane);
  }
}

// Returns the largest e for which 2^e times the largest component of c does not exceed `largest`, but at most 31.
HWY_INLINE Ints ExponentBelow(Floats largest, const Lanes3& c) {
  const auto field = [](Floats v) HWY_ATTR { return hn::ShiftRight<23>(hn::BitCast(kInts, v)); };
  const Floats own = MaxAbs(c);
  const Ints difference = hn::Sub(field(largest), field(own));
  // If the fraction of `own` is above that of `largest`, the exponent is reduced by one, so that own 2^e does not
  // exceed `largest`.
  const auto fraction = [](Floats v) HWY_ATTR { return hn::And(hn::BitCast(kInts, v), hn::Set(kInts, 0x7FFFFF)); };
  const Ints one_less = hn::VecFromMask(kInts, hn::Gt(fraction(own), fraction(largest)));
  const Ints exponent = hn::Add(difference, one_less);
  return hn::Min(hn::Max(exponent, hn::Zero(kInts)), hn::Set(kInts, kMaxScaleExponent));
}

HWY_INLINE Floats PowerOfTwo(Ints exponent) {
  return hn::BitCast(kFloats, hn::ShiftLeft<23>(hn::Add(hn::Set(kInts, 127), exponent)));
}

void PackScaled16(const ControlTile& tile, std::int32_t* to) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const Lanes3 n0 = LoadTileVector(tile, 0, lane), m = LoadTileVector(tile, 1, lane),
                 n1 = LoadTileVector(tile, 2, lane);
    const Floats largest = Largest(n0, m, n1);
    const Floats scale = IntegersPer(32767, largest);
    const Ints e0 = ExponentBelow(largest, n0), em = ExponentBelow(largest, m), e1 = ExponentBelow(largest, n1);
    StoreEnds(Rounded(hn::Mul(scale, PowerOfTwo(e0)), n0), Rounded(hn::Mul(scale, PowerOfTwo(e1)), n1), to + lane);
    const Lanes3i middle = Rounded(hn::Mul(scale, PowerOfTwo(em)), m);
    hn::Store(PairOf(middle.x, middle.y), kInts, to + 3 * kTile + lane);
    const Ints exponents = hn::Or(e0, hn::Or(hn::ShiftLeft<5>(em), hn::ShiftLeft<10>(e1)));
    hn::Store(PairOf(middle.z, exponents), kInts, to + 4 * kTile + lane);
  }
}

// Puts 11 bits of each end and two pieces of 5 bits of m into one word. The pieces are high and low in m - 16 = 32 high
// + low. Precondition: m is in [-512, 511].
HWY_INLINE Ints Word11(Ints n0, Ints m, Ints n1) {
  const Ints bits5 = hn::Set(kInts, 31), bits11 = hn::Set(kInts, 2047);
  const Ints high = hn::ShiftRight<5>(m);
  const Ints low = hn::Sub(hn::Sub(m, hn::Set(kInts, 16)), hn::ShiftLeft<5>(high));
  const Ints lower = hn::Or(hn::And(low, bits5), hn::ShiftLeft<5>(hn::And(n0, bits11)));
  const Ints upper = hn::Or(hn::And(high, bits5), hn::ShiftLeft<5>(hn::And(n1, bits11)));
  return hn::Or(lower, hn::ShiftLeft<16>(upper));
}

void PackQuadratic11(const ControlTile& tile, std::int32_t* to) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const Lanes3 n0 = LoadTileVector(tile, 0, lane), m = LoadTileVector(tile, 1, lane),
                 n1 = LoadTileVector(tile, 2, lane);
    const Floats scale = IntegersPer(1023, Largest(n0, m, n1));
    const Lanes3i start = Rounded(scale, n0), end = Rounded(scale, n1);
    Lanes3i middle = Rounded(hn::Mul(scale, hn::Set(kFloats, 0.5f)), m);
    const Ints largest_middle = hn::Set(kInts, 511);
    middle = {hn::Min(middle.x, largest_middle), hn::Min(middle.y, largest_middle), hn::Min(middle.z, largest_middle)};
    hn::Store(Word11(start.x, middle.x, end.x), kInts, to + lane);
    hn::Store(Word11(start.y, middle.y, end.y), kInts, to + kTile + lane);
    hn::Store(Word11(start.z, middle.z, end.z), kInts, to + 2 * kTile + lane);
  }
}

void PackTile(const ControlTile& tile, BlockKind kind, std::byte* block) {
  float* const floats = reinterpret_cast<float*>(block);
  std::int32_t* const ints = reinterpret_cast<std::int32_t*>(block);
  switch (kind) {
    case BlockKind::kUnit:
      return PackUnit(tile, false, floats);
    case BlockKind::kUnitLength:
      return PackUnit(tile, true, floats);
    case BlockKind::kLinear16:
      return PackLinear16(tile, ints);
    case BlockKind::kQuadratic11:
      return PackQuadratic11(tile, ints);
    case BlockKind::kQuadratic16:
      return PackQuadratic16(tile, ints);
    case BlockKind::kScaled16:
      return PackScaled16(tile, ints);
    case BlockKind::kLinear32:
      return PackLinear32(tile, floats);
    case BlockKind::kQuadratic32:
      return PackQuadratic32(tile, floats);
    case BlockKind::kNone:
      return;
  }
}

void PackTiles(const ControlTile* tiles, std::size_t count, BlockKind kind, std::byte* blocks) {
  for (std::size_t i = 0; i < count; ++i) PackTile(tiles[i], kind, blocks + i * kTile * bytes_of(kind));
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

PrecisionLimits PrecisionLimits::for_tolerance(double radians) noexcept {
  constexpr double kSqrt3 = 1.7320508075688772;
  // The tolerance is an angle, but the errors are chords, which are slightly shorter. A part of the tolerance is left
  // for the rounding of float32 itself.
  const double error = 0.99 * (std::fmin(radians, kLargestTolerance) - 5e-7);

  PrecisionLimits limits;
  limits.sum_ratio32 = 3;  // keeps the tolerance kExactTolerance
  if (!(radians > kExactTolerance)) return limits;
  const double weights = kSqrt3 * kWeightError;
  limits.largest_ratio16 = error / (kSqrt3 / 2 / 32767 + weights);
  limits.largest_ratio11 = error / (0.75 * kSqrt3 / 1023 + weights + 0x1p-15);
  limits.sum_ratio_scaled16 = error / (kSqrt3 / 32767 + 4e-7);
  // The ratio is at most 64. |n(t)|^2 then stays in the range of float32.
  limits.sum_ratio32 = std::fmin(64, std::fmax(limits.sum_ratio32, radians / 3.4e-7));
  return limits;
}

std::optional<PrecisionLimits> PrecisionLimits::for_float_tiles(double radians) noexcept {
  constexpr double kSqrt3 = 1.7320508075688772, kShare = 1.0 / 32, kSmallest = 0x1p-12;
  if (!(radians >= kSmallest)) return std::nullopt;
  const double tolerance = std::fmin(radians, kLargestTolerance);
  PrecisionLimits limits = for_tolerance((1 - kShare) * tolerance);
  limits.largest_magnitude = 0.99 * kShare * tolerance / kSqrt3;
  return limits;
}

HWY_EXPORT(SummarizeTiles);
HWY_EXPORT(PackTiles);

void summarize_tiles(std::span<const ControlTile> tiles, const PrecisionLimits& limits,
                     std::span<TileSummary> summaries) noexcept {
  assert(summaries.size() == tiles.size());
  HWY_DYNAMIC_DISPATCH(SummarizeTiles)(tiles.data(), tiles.size(), limits, summaries.data());
}

void pack_tiles(std::span<const ControlTile> tiles, BlockKind kind, std::byte* blocks) noexcept {
  HWY_DYNAMIC_DISPATCH(PackTiles)(tiles.data(), tiles.size(), kind, blocks);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
