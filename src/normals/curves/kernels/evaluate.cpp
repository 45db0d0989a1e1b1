// Unpacks blocks of curves, evaluates them in lanes, and writes unit normals in the layout that the caller requested.
#include "normals/curves/kernels/evaluate.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/curves/kernels/evaluate.cpp"
#include "simd/foreach_target-inl.h"
// This header must come after foreach_target, so that it is compiled for one instruction set at a time.
#include "simd/highway-inl.h"

#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

constexpr std::size_t kPrefetchStep = 64;

// The following structs evaluate the kinds of blocks. Each struct keeps the weights in registers. Its function
// `direction` computes the vectors of kLanes elements of a block, from the lane `lane` on. These vectors have unit
// length only if kUnitLength is true.

struct Unit {
  static constexpr bool kUnitLength = true;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kUnit);
  explicit Unit(const CurveWeights&) {}
  HWY_INLINE Lanes3 direction(const std::byte* block, std::size_t lane) const {
    const float* const p = reinterpret_cast<const float*>(block) + lane;
    return {hn::Load(kFloats, p), hn::Load(kFloats, p + kTile), hn::Load(kFloats, p + 2 * kTile)};
  }
};

struct UnitLength : Unit {
  using Unit::Unit;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kUnitLength);
};

HWY_INLINE Lanes3 LoadVector(const float* plane) {
  return {hn::Load(kFloats, plane), hn::Load(kFloats, plane + kTile), hn::Load(kFloats, plane + 2 * kTile)};
}

struct Linear32 {
  static constexpr bool kUnitLength = false;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kLinear32);
  HWY_INLINE explicit Linear32(const CurveWeights& w)
      : start(hn::Set(kFloats, w.linear[0])), end(hn::Set(kFloats, w.linear[1])) {}
  HWY_INLINE Lanes3 direction(const std::byte* block, std::size_t lane) const {
    const float* const p = reinterpret_cast<const float*>(block) + lane;
    return Scale(start, LoadVector(p)) + Scale(end, LoadVector(p + 3 * kTile));
  }
  Floats start, end;
};

struct Quadratic32 {
  static constexpr bool kUnitLength = false;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kQuadratic32);
  HWY_INLINE explicit Quadratic32(const CurveWeights& w)
      : start(hn::Set(kFloats, w.quadratic[0])),
        middle(hn::Set(kFloats, w.quadratic[1])),
        end(hn::Set(kFloats, w.quadratic[2])) {}
  HWY_INLINE Lanes3 direction(const std::byte* block, std::size_t lane) const {
    const float* const p = reinterpret_cast<const float*>(block) + lane;
    return Scale(start, LoadVector(p)) + Scale(middle, LoadVector(p + 3 * kTile)) +
           Scale(end, LoadVector(p + 6 * kTile));
  }
  Floats start, middle, end;
};

#if HWY_TARGET == HWY_SCALAR
// On this target, a lane of 32 bits cannot be read as two lanes of 16, so the halves of a pair are processed one after
// the other.
using Shorts = Ints;

HWY_INLINE Shorts PairSet(std::int32_t pair) { return hn::Set(kInts, pair); }
HWY_INLINE Shorts LoadPairs(const std::int32_t* p) { return hn::Load(kInts, p); }
HWY_INLINE Shorts ShiftHalvesLeft11(Shorts a) {
  return hn::And(hn::ShiftLeft<11>(a), hn::Set(kInts, static_cast<std::int32_t>(0xF800F800u)));
}

HWY_INLINE Ints PairProduct(Shorts a, Shorts v) {
  const auto low = [](Shorts pair) { return hn::ShiftRight<16>(hn::ShiftLeft<16>(pair)); };
  return hn::Add(hn::Mul(low(a), low(v)), hn::Mul(hn::ShiftRight<16>(a), hn::ShiftRight<16>(v)));
}
HWY_INLINE Floats PairSum(Ints start, Shorts a, Shorts v, Shorts b, Shorts w) {
  return hn::ConvertTo(kFloats, hn::Add(hn::Add(PairProduct(a, v), start), PairProduct(b, w)));
}
HWY_INLINE Floats PairSum(Shorts a, Shorts v) { return hn::ConvertTo(kFloats, PairProduct(a, v)); }

#else
using ShortTag = hn::Repartition<std::int16_t, IntTag>;
using Shorts = hn::Vec<ShortTag>;
inline constexpr ShortTag kShorts;

HWY_INLINE Shorts PairSet(std::int32_t pair) { return hn::BitCast(kShorts, hn::Set(kInts, pair)); }
HWY_INLINE Shorts LoadPairs(const std::int32_t* p) { return hn::BitCast(kShorts, hn::Load(kInts, p)); }
HWY_INLINE Shorts ShiftHalvesLeft11(Shorts a) { return hn::ShiftLeft<11>(a); }

// Returns start + a.low v.low + a.high v.high + b.low w.low + b.high w.high for each pair. The order of these additions
// does not matter, since integers are exact. On NEON, sum and rest have their lanes in a different order until they are
// rearranged, so `start` is added afterwards.
HWY_INLINE Floats PairSum(Ints start, Shorts a, Shorts v, Shorts b, Shorts w) {
  Ints rest = hn::Zero(kInts);
  Ints sum = hn::ReorderWidenMulAccumulate(kInts, a, v, hn::Zero(kInts), rest);
  sum = hn::ReorderWidenMulAccumulate(kInts, b, w, sum, rest);
  return hn::ConvertTo(kFloats, hn::Add(start, hn::RearrangeToOddPlusEven(sum, rest)));
}
HWY_INLINE Floats PairSum(Shorts a, Shorts v) {
  Ints rest = hn::Zero(kInts);
  const Ints sum = hn::ReorderWidenMulAccumulate(kInts, a, v, hn::Zero(kInts), rest);
  return hn::ConvertTo(kFloats, hn::RearrangeToOddPlusEven(sum, rest));
}
#endif

struct Linear16 {
  static constexpr bool kUnitLength = false;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kLinear16);
  HWY_INLINE explicit Linear16(const CurveWeights& w) : ends(PairSet(w.linear16)) {}
  HWY_INLINE Lanes3 direction(const std::byte* block, std::size_t lane) const {
    const std::int32_t* const p = reinterpret_cast<const std::int32_t*>(block) + lane;
    return {PairSum(LoadPairs(p), ends), PairSum(LoadPairs(p + kTile), ends), PairSum(LoadPairs(p + 2 * kTile), ends)};
  }
  Shorts ends;
};

struct Quadratic16 {
  static constexpr bool kUnitLength = false;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kQuadratic16);
  HWY_INLINE explicit Quadratic16(const CurveWeights& w)
      : ends(PairSet(w.ends16)), low(PairSet(w.middle16)), high(PairSet(w.middle16 * 65536)) {}
  HWY_INLINE Lanes3 direction(const std::byte* block, std::size_t lane) const {
    const std::int32_t* const p = reinterpret_cast<const std::int32_t*>(block) + lane;
    const Shorts middle_xy = LoadPairs(p + 3 * kTile), middle_z = LoadPairs(p + 4 * kTile);
    const Ints zero = hn::Zero(kInts);
    return {PairSum(zero, LoadPairs(p), ends, middle_xy, low),
            PairSum(zero, LoadPairs(p + kTile), ends, middle_xy, high),
            PairSum(zero, LoadPairs(p + 2 * kTile), ends, middle_z, low)};
  }
  Shorts ends, low, high;  // the weights of the ends, and the weight of m in the low and in the high half of a pair
};

struct Scaled16 {
  static constexpr bool kUnitLength = false;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kScaled16);
  HWY_INLINE explicit Scaled16(const CurveWeights& w)
      : start(hn::Set(kFloats, w.quadratic[0])),
        middle(hn::Set(kFloats, w.quadratic[1])),
        end(hn::Set(kFloats, w.quadratic[2])) {}
  HWY_INLINE Lanes3 direction(const std::byte* block, std::size_t lane) const {
    const std::int32_t* const p = reinterpret_cast<const std::int32_t*>(block) + lane;
    const Ints x = hn::Load(kInts, p), y = hn::Load(kInts, p + kTile), z = hn::Load(kInts, p + 2 * kTile);
    const Ints middle_xy = hn::Load(kInts, p + 3 * kTile), middle_z = hn::Load(kInts, p + 4 * kTile);
    const Ints exponents = hn::ShiftRight<16>(middle_z);
    return Scale(hn::Mul(start, PowerOfTwo(exponents)), {Low(x), Low(y), Low(z)}) +
           Scale(hn::Mul(middle, PowerOfTwo(hn::ShiftRight<5>(exponents))),
                 {Low(middle_xy), High(middle_xy), Low(middle_z)}) +
           Scale(hn::Mul(end, PowerOfTwo(hn::ShiftRight<10>(exponents))), {High(x), High(y), High(z)});
  }
  HWY_INLINE static Floats Low(Ints pair) {
    return hn::ConvertTo(kFloats, hn::ShiftRight<16>(hn::ShiftLeft<16>(pair)));
  }
  HWY_INLINE static Floats High(Ints pair) { return hn::ConvertTo(kFloats, hn::ShiftRight<16>(pair)); }
  // Returns 2^-e, where e is in the lowest five bits. The result is made by setting the exponent field of a float, in
  // which 127 stands for 2^0.
  HWY_INLINE static Floats PowerOfTwo(Ints exponent) {
    const Ints e = hn::And(exponent, hn::Set(kInts, kMaxScaleExponent));
    return hn::BitCast(kFloats, hn::ShiftLeft<23>(hn::Sub(hn::Set(kInts, 127), e)));
  }
  Floats start, middle, end;
};

struct Quadratic11 {
  static constexpr bool kUnitLength = false;
  static constexpr std::size_t kBytes = bytes_of(BlockKind::kQuadratic11);
  HWY_INLINE explicit Quadratic11(const CurveWeights& w)
      : ends(PairSet(w.ends16)),
        middle(PairSet(w.middle_low | (w.middle16 * 65536))),
        mask(PairSet(kEndBits)),
        start(hn::Set(kInts, 16 * 64 * w.middle16)) {}
  HWY_INLINE Lanes3 direction(const std::byte* block, std::size_t lane) const {
    const std::int32_t* const p = reinterpret_cast<const std::int32_t*>(block) + lane;
    return {Component(p), Component(p + kTile), Component(p + 2 * kTile)};
  }
  // Returns one component of n(t). n0 and n1 are in the upper 11 bits of the halves of a word, so they are multiplied
  // by 32. The two parts of m, shifted to the upper 5 bits of their halves, are multiplied by 2048. The part of m that
  // is in the low bits of the halves is added first, so that no partial sum leaves the range of int32.
  HWY_INLINE Floats Component(const std::int32_t* p) const {
    const Shorts words = LoadPairs(p);
    return PairSum(start, hn::And(words, mask), ends, ShiftHalvesLeft11(words), middle);
  }
  static constexpr std::int32_t kEndBits = static_cast<std::int32_t>(0xFFE0FFE0u);
  Shorts ends, middle, mask;
  Ints start;
};

// The common base of the following structs, which write results to memory, kLanes vectors at a time.

template <bool kPastCaches>
struct Accesses {
  static constexpr bool kStream = kPastCaches;
  std::size_t ahead;  // number of bytes by which a kernel prefetches blocks in advance; 0 for no prefetch
};

template <bool kPastCaches>
struct ToPacked : Accesses<kPastCaches> {
  using Accesses<kPastCaches>::kStream;
  float* xyz;
  template <class Kind>
  HWY_INLINE void Put(const Lanes3& v, std::size_t i) const {
    if constexpr (Kind::kUnitLength) {
      StorePacked<kStream>(v, xyz + 3 * i);
    } else {
      StorePacked<kStream>(Normalized(v), xyz + 3 * i);
    }
  }
};

template <bool kPastCaches>
struct ToPlanes : Accesses<kPastCaches> {
  using Accesses<kPastCaches>::kStream;
  float *x, *y, *z;
  template <class Kind>
  HWY_INLINE void Put(const Lanes3& v, std::size_t i) const {
    const Lanes3 u = Kind::kUnitLength ? v : Normalized(v);
    StoreOne<kStream>(u.x, x + i);
    StoreOne<kStream>(u.y, y + i);
    StoreOne<kStream>(u.z, z + i);
  }
};

template <bool kPastCaches>
struct ToOctahedral : Accesses<kPastCaches> {
  using Accesses<kPastCaches>::kStream;
  std::uint32_t* bits;
  // Encodes and writes the vectors of elements from i on. The octahedral encoding is the same for vectors of any
  // length, so no square root is needed.
  template <class Kind>
  HWY_INLINE void Put(const Lanes3& v, std::size_t i) const {
    const Floats one = hn::Set(kFloats, 1.0f);
    const Floats ax = hn::Abs(v.x), ay = hn::Abs(v.y), az = hn::Abs(v.z);
    const Floats scale = hn::Div(one, hn::Add(hn::Add(ax, ay), az));
    const Floats x = hn::Mul(v.x, scale), y = hn::Mul(v.y, scale);
    const auto below = hn::Lt(v.z, hn::Zero(kFloats));
    const Floats folded_x = hn::CopySign(hn::Sub(one, hn::Abs(y)), x);
    const Floats folded_y = hn::CopySign(hn::Sub(one, hn::Abs(x)), y);
    const Floats limit = hn::Set(kFloats, 32767.0f);
    const Ints low = RoundToInt(hn::Mul(hn::IfThenElse(below, folded_x, x), limit));
    const Ints high = RoundToInt(hn::Mul(hn::IfThenElse(below, folded_y, y), limit));
    const Ints both = hn::Or(hn::And(low, hn::Set(kInts, 0xFFFF)), hn::ShiftLeft<16>(high));
    StoreOne<kStream>(hn::BitCast(kFloats, both), reinterpret_cast<float*>(bits + i));
  }
};

template <bool kPastCaches>
struct ToRgb10A2 : Accesses<kPastCaches> {
  using Accesses<kPastCaches>::kStream;
  std::uint32_t* bits;
  template <class Kind>
  HWY_INLINE void Put(const Lanes3& v, std::size_t i) const {
    const Lanes3 u = Kind::kUnitLength ? v : Normalized(v);
    const Floats limit = hn::Set(kFloats, 511.0f);
    const Ints mask = hn::Set(kInts, 0x3FF);
    const Ints x = hn::And(RoundToInt(hn::Mul(u.x, limit)), mask);
    const Ints y = hn::And(RoundToInt(hn::Mul(u.y, limit)), mask);
    const Ints z = hn::And(RoundToInt(hn::Mul(u.z, limit)), mask);
    const Ints all = hn::Or(x, hn::Or(hn::ShiftLeft<10>(y), hn::ShiftLeft<20>(z)));
    StoreOne<kStream>(hn::BitCast(kFloats, all), reinterpret_cast<float*>(bits + i));
  }
};

// Evaluates all full blocks of a span.
template <class Kind, class To>
HWY_NOINLINE void WholeBlocks(const BlockSpan& span, const CurveWeights& weights, To to) {
  const Kind kind(weights);
  const std::size_t ahead = to.ahead;
  // The pointer is copied, since the compiler assumes that stores may change an object that is passed by reference.
  const std::byte* const blocks = span.blocks;
  const std::size_t block_count = span.elements / kTile;
  for (std::size_t b = 0; b < block_count; ++b) {
    const std::byte* const block = blocks + b * kTile * Kind::kBytes;
    if (ahead > 0)
      for (std::size_t line = 0; line < kTile * Kind::kBytes; line += kPrefetchStep)
        hwy::Prefetch(block + ahead + line);
    for (std::size_t lane = 0; lane < kTile; lane += kLanes)
      to.template Put<Kind>(kind.direction(block, lane), b * kTile + lane);
  }
}

template <class To>
void ByKind(const BlockSpan& span, const CurveWeights& w, To to) {
  switch (span.kind) {
    case BlockKind::kUnit:
      return WholeBlocks<Unit>(span, w, to);
    case BlockKind::kUnitLength:
      return WholeBlocks<UnitLength>(span, w, to);
    case BlockKind::kLinear16:
      return WholeBlocks<Linear16>(span, w, to);
    case BlockKind::kQuadratic11:
      return WholeBlocks<Quadratic11>(span, w, to);
    case BlockKind::kQuadratic16:
      return WholeBlocks<Quadratic16>(span, w, to);
    case BlockKind::kScaled16:
      return WholeBlocks<Scaled16>(span, w, to);
    case BlockKind::kLinear32:
      return WholeBlocks<Linear32>(span, w, to);
    case BlockKind::kQuadratic32:
      return WholeBlocks<Quadratic32>(span, w, to);
    case BlockKind::kNone:
      return;
  }
}

template <template <bool> class To, class... Pointer>
void ByAccess(const BlockSpan& span, const CurveWeights& w, bool stream, std::size_t ahead, Pointer... to) {
  if (stream) return ByKind(span, w, To<true>{{ahead}, to...});
  return ByKind(span, w, To<false>{{ahead}, to...});
}

// The last block of a span, if only `part` of its elements exist.
struct Tail {
  BlockSpan block;  // the block, described as if all its elements existed
  std::size_t first, part;
};

Tail TailOf(const BlockSpan& span) {
  const std::size_t whole = span.elements / kTile;
  return {{span.blocks + whole * kTile * bytes_of(span.kind), span.kind, kTile}, whole * kTile, span.elements % kTile};
}

void EvaluatePacked(const BlockSpan& span, const CurveWeights& w, PackedResult result, std::size_t ahead) {
  const Tail tail = TailOf(span);
  ByAccess<ToPacked>(span, w, result.access.stream, ahead, result.xyz);
  if (tail.part == 0) return;
  alignas(64) float last[3 * kTile];
  ByKind(tail.block, w, ToPacked<false>{{0}, last});
  std::copy_n(last, 3 * tail.part, result.xyz + 3 * tail.first);
}

void EvaluatePlanes(const BlockSpan& span, const CurveWeights& w, PlanesResult result, std::size_t ahead) {
  const Tail tail = TailOf(span);
  ByAccess<ToPlanes>(span, w, result.access.stream, ahead, result.x, result.y, result.z);
  if (tail.part == 0) return;
  alignas(64) float last[3 * kTile];
  ByKind(tail.block, w, ToPlanes<false>{{0}, last, last + kTile, last + 2 * kTile});
  std::copy_n(last, tail.part, result.x + tail.first);
  std::copy_n(last + kTile, tail.part, result.y + tail.first);
  std::copy_n(last + 2 * kTile, tail.part, result.z + tail.first);
}

void EvaluateOctahedral(const BlockSpan& span, const CurveWeights& w, OctahedralResult result, std::size_t ahead) {
  const Tail tail = TailOf(span);
  ByAccess<ToOctahedral>(span, w, result.access.stream, ahead, result.bits);
  if (tail.part == 0) return;
  alignas(64) std::uint32_t last[kTile];
  ByKind(tail.block, w, ToOctahedral<false>{{0}, last});
  std::copy_n(last, tail.part, result.bits + tail.first);
}

void EvaluateRgb10A2(const BlockSpan& span, const CurveWeights& w, Rgb10A2Result result, std::size_t ahead) {
  const Tail tail = TailOf(span);
  ByAccess<ToRgb10A2>(span, w, result.access.stream, ahead, result.bits);
  if (tail.part == 0) return;
  alignas(64) std::uint32_t last[kTile];
  ByKind(tail.block, w, ToRgb10A2<false>{{0}, last});
  std::copy_n(last, tail.part, result.bits + tail.first);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(EvaluatePacked);
HWY_EXPORT(EvaluatePlanes);
HWY_EXPORT(EvaluateOctahedral);
HWY_EXPORT(EvaluateRgb10A2);

namespace {

// Calls evaluate() for parts of a span, one after the other. Each call gets the memory for the results of its part, and
// the number of bytes by which to prefetch in advance (prefetch.h).
template <class Result, class Evaluate>
void at_best_distance(const BlockSpan& span, const Result& result, const Evaluate& evaluate) {
  if (span.kind == BlockKind::kNone) return;
  const std::size_t bytes = bytes_of(span.kind);
  prefetch_of_curves(result.access.working_set)
      .over(span.elements, bytes, [&](std::size_t first, std::size_t count, std::size_t ahead) {
        evaluate(BlockSpan{span.blocks + first * bytes, span.kind, count}, behind(result, first), ahead);
      });
}

}  // namespace

void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, PackedResult result) noexcept {
  at_best_distance(span, result, [&weights](const BlockSpan& some, const PackedResult& to, std::size_t ahead) {
    HWY_DYNAMIC_DISPATCH(EvaluatePacked)(some, weights, to, ahead);
  });
}

void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, PlanesResult result) noexcept {
  at_best_distance(span, result, [&weights](const BlockSpan& some, const PlanesResult& to, std::size_t ahead) {
    HWY_DYNAMIC_DISPATCH(EvaluatePlanes)(some, weights, to, ahead);
  });
}

void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, OctahedralResult result) noexcept {
  at_best_distance(span, result, [&weights](const BlockSpan& some, const OctahedralResult& to, std::size_t ahead) {
    HWY_DYNAMIC_DISPATCH(EvaluateOctahedral)(some, weights, to, ahead);
  });
}

void evaluate_blocks(const BlockSpan& span, const CurveWeights& weights, Rgb10A2Result result) noexcept {
  at_best_distance(span, result, [&weights](const BlockSpan& some, const Rgb10A2Result& to, std::size_t ahead) {
    HWY_DYNAMIC_DISPATCH(EvaluateRgb10A2)(some, weights, to, ahead);
  });
}

void flush_stream() noexcept { hwy::FlushStream(); }

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
