/// The operations of Google Highway that kernels use, in plain C++ for any compiler. The types are vectors of 16 bytes
/// and parts of vectors. With GCC and Clang, they are vector extensions, which the compiler maps to SSE2, NEON or
/// SIMD128; with any other compiler, they are loops over arrays. Names and meanings are Highway's, and are described at
/// https://google.github.io/highway/en/master/quick_reference.html
///
/// Bits       The bits of results are those of Highway on every instruction set. Each operation is one IEEE operation,
///            or a choice of lanes.
/// Target     HWY_PLAIN is the only target, so no target is chosen at run time.
#ifndef CHRONORMAL_SIMD_PLAIN_LANES_H_
#define CHRONORMAL_SIMD_PLAIN_LANES_H_

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#ifdef __FAST_MATH__
#error "chronormal promises the same bits everywhere, which -ffast-math breaks; compile without -ffast-math"
#endif

// The following headers declare intrinsics, the only instructions that this file names. Without special flags,
// compilers do not generate these instructions from plain code.
#if defined(__GNUC__) && defined(__SSE2__)
#include <emmintrin.h>
#define CHRONORMAL_PLAIN_SSE2 1
#elif defined(__GNUC__) && defined(__aarch64__)
#include <arm_neon.h>
#define CHRONORMAL_PLAIN_NEON 1
#endif

#define HWY_SCALAR 1
#define HWY_EMU128 2
#define HWY_AVX2 3
#define HWY_AVX3 4
#define HWY_PLAIN 5
#define HWY_TARGET HWY_PLAIN
#define HWY_NAMESPACE N_PLAIN
#define HWY_ONCE 1
#define HWY_ATTR
#define HWY_BEFORE_NAMESPACE() static_assert(true)
#define HWY_AFTER_NAMESPACE() static_assert(true)
#define HWY_EXPORT(function) static_assert(true)
#define HWY_DYNAMIC_DISPATCH(function) HWY_NAMESPACE::function
#ifdef __GNUC__
#define HWY_INLINE inline __attribute__((always_inline))
#define HWY_NOINLINE __attribute__((noinline))
#define HWY_LIKELY(condition) __builtin_expect(!!(condition), 1)
#define HWY_UNLIKELY(condition) __builtin_expect(!!(condition), 0)
#else
#define HWY_INLINE inline
#define HWY_NOINLINE
#define HWY_LIKELY(condition) (condition)
#define HWY_UNLIKELY(condition) (condition)
#endif

namespace chronormal::inline internal::hwy {

template <class T>
HWY_INLINE void Prefetch([[maybe_unused]] const T* place) {
#ifdef __GNUC__
  __builtin_prefetch(place);
#endif
}

// Completes the stores of Stream(), so that other threads see the stored values.
HWY_INLINE void FlushStream() {
#ifdef CHRONORMAL_PLAIN_SSE2
  _mm_sfence();
#endif
}

namespace N_PLAIN {

// The type of the tag that stands for vectors of kCount numbers of type T.
template <class T, std::size_t kCount>
struct Simd {
  using Lane = T;
  static constexpr std::size_t kLanes = kCount;
};

template <class T, std::size_t kCount>
using FixedTag = Simd<T, kCount>;
template <class T>
using ScalableTag = Simd<T, 16 / sizeof(T)>;
template <class T, std::size_t kMost>
using CappedTag = Simd<T, (kMost < 16 / sizeof(T) ? kMost : 16 / sizeof(T))>;
template <class T, class D>
using Rebind = Simd<T, D::kLanes>;
template <class T, class D>
using Repartition = Simd<T, D::kLanes * sizeof(typename D::Lane) / sizeof(T)>;
template <class D>
using Half = Simd<typename D::Lane, D::kLanes / 2>;

template <std::size_t kBytes>
struct IntegerOf;
template <>
struct IntegerOf<2> {
  using Type = std::int16_t;
};
template <>
struct IntegerOf<4> {
  using Type = std::int32_t;
};
template <>
struct IntegerOf<8> {
  using Type = std::int64_t;
};
// The signed integer type of the same size as T.
template <class T>
using Integer = typename IntegerOf<sizeof(T)>::Type;

template <class D>
using RebindToSigned = Simd<Integer<typename D::Lane>, D::kLanes>;
template <class D>
using RebindToUnsigned = Simd<std::make_unsigned_t<Integer<typename D::Lane>>, D::kLanes>;

#if defined(__GNUC__) && !defined(CHRONORMAL_PLAIN_ARRAYS)

template <class T, std::size_t kCount>
struct RawOf {
  typedef T Type __attribute__((vector_size(kCount * sizeof(T))));  // NOLINT(modernize-use-using): GCC takes no other
};
template <class T, std::size_t kCount>
using Raw = typename RawOf<T, kCount>::Type;

template <class To, class From>
HWY_INLINE To Converted(const From& a) {
  return __builtin_convertvector(a, To);
}
template <class R, int... kFrom>
HWY_INLINE auto Shuffled(const R& a, const R& b) {
  return __builtin_shufflevector(a, b, kFrom...);
}

#else

// An array with the same operators as the vectors of GCC, for other compilers.
template <class T, std::size_t kCount>
struct Raw {
  T lanes[kCount];

  HWY_INLINE T& operator[](std::size_t i) { return lanes[i]; }
  HWY_INLINE const T& operator[](std::size_t i) const { return lanes[i]; }

  template <class Operation>
  static HWY_INLINE auto Each(const Raw& a, const Raw& b, const Operation& operation) {
    Raw<decltype(operation(a[0], b[0])), kCount> result;
    for (std::size_t i = 0; i < kCount; ++i) result[i] = operation(a[i], b[i]);
    return result;
  }
#define CHRONORMAL_PLAIN_OPERATOR(symbol, Result)                                \
  friend HWY_INLINE auto operator symbol(const Raw& a, const Raw& b) {           \
    return Each(a, b, [](T x, T y) { return static_cast<Result>(x symbol y); }); \
  }
#define CHRONORMAL_PLAIN_COMPARISON(symbol)                                                   \
  friend HWY_INLINE auto operator symbol(const Raw& a, const Raw& b) {                        \
    return Each(a, b, [](T x, T y) { return static_cast<Integer<T>>(x symbol y ? -1 : 0); }); \
  }
  CHRONORMAL_PLAIN_OPERATOR(+, T)
  CHRONORMAL_PLAIN_OPERATOR(-, T)
  CHRONORMAL_PLAIN_OPERATOR(*, T)
  CHRONORMAL_PLAIN_OPERATOR(/, T)
  CHRONORMAL_PLAIN_OPERATOR(&, T)
  CHRONORMAL_PLAIN_OPERATOR(|, T)
  CHRONORMAL_PLAIN_OPERATOR(^, T)
  CHRONORMAL_PLAIN_COMPARISON(<)
  CHRONORMAL_PLAIN_COMPARISON(<=)
  CHRONORMAL_PLAIN_COMPARISON(==)
#undef CHRONORMAL_PLAIN_OPERATOR
#undef CHRONORMAL_PLAIN_COMPARISON
  friend HWY_INLINE Raw operator<<(const Raw& a, int bits) {
    return Each(a, a, [bits](T x, T) { return static_cast<T>(x << bits); });
  }
  friend HWY_INLINE Raw operator>>(const Raw& a, int bits) {
    return Each(a, a, [bits](T x, T) { return static_cast<T>(x >> bits); });
  }
  friend HWY_INLINE Raw operator~(const Raw& a) {
    return Each(a, a, [](T x, T) { return static_cast<T>(~x); });
  }
};

template <class To, class T, std::size_t kCount>
HWY_INLINE To Converted(const Raw<T, kCount>& a) {
  To to;
  for (std::size_t i = 0; i < kCount; ++i) to[i] = static_cast<std::remove_reference_t<decltype(to[0])>>(a[i]);
  return to;
}
template <class R, int... kFrom, class T = std::remove_cvref_t<decltype(R()[0])>>
HWY_INLINE Raw<T, sizeof...(kFrom)> Shuffled(const R& a, const R& b) {
  constexpr int kOf = sizeof(R) / sizeof(T);
  return {{(kFrom < kOf ? a[static_cast<std::size_t>(kFrom < kOf ? kFrom : 0)]
                        : b[static_cast<std::size_t>(kFrom < kOf ? 0 : kFrom - kOf)])...}};
}

#endif

template <class T, std::size_t kCount>
struct Vector {
  Raw<T, kCount> raw;
};
template <class D>
using Vec = Vector<typename D::Lane, D::kLanes>;

// A mask: for each lane, a number whose bits are all 1 if the condition holds, and all 0 if not.
template <class T, std::size_t kCount>
struct MaskOf {
  Raw<Integer<T>, kCount> raw;
};
template <class D>
using Mask = MaskOf<typename D::Lane, D::kLanes>;

template <class D>
constexpr std::size_t MaxLanes(D) {
  return D::kLanes;
}
template <class D>
constexpr std::size_t Lanes(D) {
  return D::kLanes;
}

template <class D>
HWY_INLINE Vec<D> LoadU(D, const typename D::Lane* from) {
  Vec<D> v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class D>
HWY_INLINE Vec<D> Load(D d, const typename D::Lane* from) {
  return LoadU(d, from);
}
template <class D>
HWY_INLINE void StoreU(const Vec<D>& v, D, typename D::Lane* to) {
  std::memcpy(to, &v, sizeof v);
}
template <class D>
HWY_INLINE void Store(const Vec<D>& v, D d, typename D::Lane* to) {
  StoreU(v, d, to);
}
// Stores a vector, bypassing the caches if the compiler supports this.
template <class D>
HWY_INLINE void Stream(const Vec<D>& v, D d, typename D::Lane* to) {
#ifdef CHRONORMAL_PLAIN_SSE2
  if constexpr (sizeof v == 16 && std::is_same_v<typename D::Lane, float>) {
    __m128 stored;
    std::memcpy(&stored, &v, sizeof v);
    _mm_stream_ps(to, stored);
    return;
  }
#endif
  StoreU(v, d, to);
}

template <class D>
HWY_INLINE Vec<D> Set(D, typename D::Lane value) {
  Vec<D> v;
  for (std::size_t i = 0; i < D::kLanes; ++i) v.raw[i] = value;
  return v;
}
template <class D>
HWY_INLINE Vec<D> Zero(D d) {
  return Set(d, 0);
}
template <class T, std::size_t kCount>
HWY_INLINE T GetLane(const Vector<T, kCount>& v) {
  return v.raw[0];
}

template <class To, class From>
HWY_INLINE To SameBits(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}
template <class D, class V>
HWY_INLINE Vec<D> BitCast(D, const V& v) {
  return SameBits<Vec<D>>(v);
}
template <class T, std::size_t kCount>
HWY_INLINE Raw<Integer<T>, kCount> BitsOfLanes(const Vector<T, kCount>& v) {
  return SameBits<Raw<Integer<T>, kCount>>(v);
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> OfBits(const Raw<Integer<T>, kCount>& bits) {
  return SameBits<Vector<T, kCount>>(bits);
}

#define CHRONORMAL_PLAIN_BITWISE(Name, expression)                                                  \
  template <class T, std::size_t kCount>                                                            \
  HWY_INLINE Vector<T, kCount> Name(const Vector<T, kCount>& of_a, const Vector<T, kCount>& of_b) { \
    const auto a = BitsOfLanes(of_a), b = BitsOfLanes(of_b);                                        \
    return OfBits<T, kCount>(expression);                                                           \
  }                                                                                                 \
  template <class T, std::size_t kCount>                                                            \
  HWY_INLINE MaskOf<T, kCount> Name(const MaskOf<T, kCount>& of_a, const MaskOf<T, kCount>& of_b) { \
    const auto &a = of_a.raw, &b = of_b.raw;                                                        \
    return {expression};                                                                            \
  }
CHRONORMAL_PLAIN_BITWISE(And, a& b)
CHRONORMAL_PLAIN_BITWISE(Or, a | b)
CHRONORMAL_PLAIN_BITWISE(Xor, a ^ b)
CHRONORMAL_PLAIN_BITWISE(AndNot, ~a& b)
#undef CHRONORMAL_PLAIN_BITWISE

template <class T, std::size_t kCount>
HWY_INLINE MaskOf<T, kCount> Not(const MaskOf<T, kCount>& a) {
  return {~a.raw};
}
template <int kBits, class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> ShiftLeft(const Vector<T, kCount>& a) {
  return {a.raw << kBits};
}
template <int kBits, class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> ShiftRight(const Vector<T, kCount>& a) {
  return {a.raw >> kBits};
}

#define CHRONORMAL_PLAIN_ARITHMETIC(Name, symbol)                                             \
  template <class T, std::size_t kCount>                                                      \
  HWY_INLINE Vector<T, kCount> Name(const Vector<T, kCount>& a, const Vector<T, kCount>& b) { \
    return {a.raw symbol b.raw};                                                              \
  }
CHRONORMAL_PLAIN_ARITHMETIC(Add, +)
CHRONORMAL_PLAIN_ARITHMETIC(Sub, -)
CHRONORMAL_PLAIN_ARITHMETIC(Mul, *)
CHRONORMAL_PLAIN_ARITHMETIC(Div, /)
#undef CHRONORMAL_PLAIN_ARITHMETIC

template <std::size_t kCount>
HWY_INLINE Vector<float, kCount> Sqrt(const Vector<float, kCount>& a) {
#ifdef CHRONORMAL_PLAIN_SSE2
  if constexpr (kCount == 4) return SameBits<Vector<float, kCount>>(_mm_sqrt_ps(SameBits<__m128>(a)));
#elif defined(CHRONORMAL_PLAIN_NEON)
  if constexpr (kCount == 4) return SameBits<Vector<float, kCount>>(vsqrtq_f32(SameBits<float32x4_t>(a)));
#endif
  Vector<float, kCount> result;
  for (std::size_t i = 0; i < kCount; ++i) result.raw[i] = std::sqrt(a.raw[i]);
  return result;
}
template <std::size_t kCount>
HWY_INLINE Vector<double, kCount> Sqrt(const Vector<double, kCount>& a) {
#ifdef CHRONORMAL_PLAIN_SSE2
  if constexpr (kCount == 2) return SameBits<Vector<double, kCount>>(_mm_sqrt_pd(SameBits<__m128d>(a)));
#elif defined(CHRONORMAL_PLAIN_NEON)
  if constexpr (kCount == 2) return SameBits<Vector<double, kCount>>(vsqrtq_f64(SameBits<float64x2_t>(a)));
#endif
  Vector<double, kCount> result;
  for (std::size_t i = 0; i < kCount; ++i) result.raw[i] = std::sqrt(a.raw[i]);
  return result;
}

// Returns a vector in which only the sign bits are set.
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> SignBit(Simd<T, kCount> d) {
  return Set(d, static_cast<T>(-0.0));
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> Abs(const Vector<T, kCount>& a) {
  return AndNot(SignBit(Simd<T, kCount>()), a);
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> Neg(const Vector<T, kCount>& a) {
  return Xor(SignBit(Simd<T, kCount>()), a);
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> CopySign(const Vector<T, kCount>& size, const Vector<T, kCount>& sign) {
  const auto bit = SignBit(Simd<T, kCount>());
  return Or(AndNot(bit, size), And(bit, sign));
}

#define CHRONORMAL_PLAIN_COMPARISON(Name, expression)                                         \
  template <class T, std::size_t kCount>                                                      \
  HWY_INLINE MaskOf<T, kCount> Name(const Vector<T, kCount>& a, const Vector<T, kCount>& b) { \
    return {expression};                                                                      \
  }
CHRONORMAL_PLAIN_COMPARISON(Lt, a.raw < b.raw)
CHRONORMAL_PLAIN_COMPARISON(Le, a.raw <= b.raw)
CHRONORMAL_PLAIN_COMPARISON(Gt, b.raw < a.raw)
CHRONORMAL_PLAIN_COMPARISON(Ge, b.raw <= a.raw)
CHRONORMAL_PLAIN_COMPARISON(Eq, a.raw == b.raw)
CHRONORMAL_PLAIN_COMPARISON(Ne, ~(a.raw == b.raw))
#undef CHRONORMAL_PLAIN_COMPARISON

template <class T, std::size_t kCount>
HWY_INLINE MaskOf<T, kCount> TestBit(const Vector<T, kCount>& a, const Vector<T, kCount>& bit) {
  return Ne(And(a, bit), Zero(Simd<T, kCount>()));
}

template <class D, class T, std::size_t kCount>
HWY_INLINE Vec<D> VecFromMask(D, const MaskOf<T, kCount>& mask) {
  return SameBits<Vec<D>>(mask);
}
template <class T, std::size_t kCount>
HWY_INLINE MaskOf<T, kCount> MaskFromVec(const Vector<T, kCount>& v) {
  return {BitsOfLanes(v)};
}
template <class D, class T, std::size_t kCount>
HWY_INLINE Mask<D> RebindMask(D, const MaskOf<T, kCount>& mask) {
  return SameBits<Mask<D>>(mask);
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> IfThenElse(const MaskOf<T, kCount>& mask, const Vector<T, kCount>& a,
                                        const Vector<T, kCount>& b) {
#if defined(__GNUC__) && !defined(CHRONORMAL_PLAIN_ARRAYS)
  return {mask.raw ? a.raw : b.raw};
#else
  return OfBits<T, kCount>((mask.raw & BitsOfLanes(a)) | (~mask.raw & BitsOfLanes(b)));
#endif
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> IfThenElseZero(const MaskOf<T, kCount>& mask, const Vector<T, kCount>& a) {
  return OfBits<T, kCount>(mask.raw & BitsOfLanes(a));
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> IfThenZeroElse(const MaskOf<T, kCount>& mask, const Vector<T, kCount>& a) {
  return OfBits<T, kCount>(~mask.raw & BitsOfLanes(a));
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> Max(const Vector<T, kCount>& a, const Vector<T, kCount>& b) {
  return IfThenElse(Gt(a, b), a, b);
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> Min(const Vector<T, kCount>& a, const Vector<T, kCount>& b) {
  return IfThenElse(Lt(a, b), a, b);
}

template <class D>
HWY_INLINE bool AllFalse(D, const Mask<D>& mask) {
  std::uint64_t words[sizeof mask / 8];
  std::memcpy(words, &mask, sizeof mask);
  std::uint64_t any = 0;
  for (const std::uint64_t word : words) any |= word;
  return any == 0;
}
template <class D>
HWY_INLINE bool AllTrue(D d, const Mask<D>& mask) {
  return AllFalse(d, Not(mask));
}
template <class D>
HWY_INLINE std::size_t StoreMaskBits(D, const Mask<D>& mask, std::uint8_t* to) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < D::kLanes; ++i) bits |= (mask.raw[i] != 0 ? 1U : 0U) << i;
  *to = static_cast<std::uint8_t>(bits);
  return 1;
}
template <class D>
HWY_INLINE std::size_t CountTrue(D, const Mask<D>& mask) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < D::kLanes; ++i) count += mask.raw[i] != 0 ? 1 : 0;
  return count;
}
template <class D>
HWY_INLINE Mask<D> FirstN(D, std::size_t count) {
  Mask<D> mask;
  for (std::size_t i = 0; i < D::kLanes; ++i) mask.raw[i] = i < count ? -1 : 0;
  return mask;
}

// Convert numbers to another type. Floats become integers by rounding towards zero.
template <class D, class T, std::size_t kCount>
HWY_INLINE Vec<D> ConvertTo(D, const Vector<T, kCount>& v) {
  return {Converted<Raw<typename D::Lane, kCount>>(v.raw)};
}
template <class D, class T, std::size_t kCount>
HWY_INLINE Vec<D> PromoteTo(D d, const Vector<T, kCount>& v) {
  return ConvertTo(d, v);
}
template <class D, class T, std::size_t kCount>
HWY_INLINE Vec<D> DemoteTo(D d, const Vector<T, kCount>& v) {
  return ConvertTo(d, v);
}

// Adds two products to lane i of `sum`: the product of the lanes 2 i of a and b, and the product of the lanes 2 i + 1.
HWY_INLINE Vector<std::int32_t, 4> ReorderWidenMulAccumulate(Simd<std::int32_t, 4>, const Vector<std::int16_t, 8>& a,
                                                             const Vector<std::int16_t, 8>& b,
                                                             const Vector<std::int32_t, 4>& sum,
                                                             Vector<std::int32_t, 4>&) {
#ifdef CHRONORMAL_PLAIN_SSE2
  return Add(sum, SameBits<Vector<std::int32_t, 4>>(_mm_madd_epi16(SameBits<__m128i>(a), SameBits<__m128i>(b))));
#else
  const auto wa = SameBits<Raw<std::int32_t, 4>>(a), wb = SameBits<Raw<std::int32_t, 4>>(b);
  return {sum.raw + ((wa << 16) >> 16) * ((wb << 16) >> 16) + (wa >> 16) * (wb >> 16)};
#endif
}
HWY_INLINE Vector<std::int32_t, 4> RearrangeToOddPlusEven(const Vector<std::int32_t, 4>& sum,
                                                          const Vector<std::int32_t, 4>&) {
  return sum;
}

// Returns the lanes with the numbers kFrom... The numbers count through the lanes of a and then through the lanes of b.
template <class D, std::size_t kCount, std::size_t... kFrom>
HWY_INLINE Vec<D> Picked(const Vector<typename D::Lane, kCount>& a, const Vector<typename D::Lane, kCount>& b,
                         std::index_sequence<kFrom...>) {
  return {Shuffled<Raw<typename D::Lane, kCount>, static_cast<int>(kFrom)...>(a.raw, b.raw)};
}
// Returns the lanes with the numbers kFirst, kFirst + 1, ..., counted through a first and then through b.
template <class D, std::size_t kFirst, std::size_t kCount, std::size_t... kI>
HWY_INLINE Vec<D> Run(const Vector<typename D::Lane, kCount>& a, const Vector<typename D::Lane, kCount>& b,
                      std::index_sequence<kI...>) {
  return Picked<D>(a, b, std::index_sequence<(kFirst + kI)...>());
}
template <class D, std::size_t kFirst, std::size_t... kI>
HWY_INLINE Vec<D> Interleaved(const Vec<D>& a, const Vec<D>& b, std::index_sequence<kI...>) {
  return Picked<D>(a, b, std::index_sequence<(kFirst + kI / 2 + kI % 2 * D::kLanes)...>());
}

template <class D>
HWY_INLINE Vec<D> InterleaveLower(D, const Vec<D>& a, const Vec<D>& b) {
  return Interleaved<D, 0>(a, b, std::make_index_sequence<D::kLanes>());
}
template <class D>
HWY_INLINE Vec<D> InterleaveUpper(D, const Vec<D>& a, const Vec<D>& b) {
  return Interleaved<D, D::kLanes / 2>(a, b, std::make_index_sequence<D::kLanes>());
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount / 2> LowerHalf(const Vector<T, kCount>& v) {
  return Run<Simd<T, kCount / 2>, 0>(v, v, std::make_index_sequence<kCount / 2>());
}
template <class D>
HWY_INLINE Vec<D> LowerHalf(D, const Vector<typename D::Lane, 2 * D::kLanes>& v) {
  return LowerHalf(v);
}
template <class D>
HWY_INLINE Vec<D> UpperHalf(D, const Vector<typename D::Lane, 2 * D::kLanes>& v) {
  return Run<D, D::kLanes>(v, v, std::make_index_sequence<D::kLanes>());
}
template <class D>
HWY_INLINE Vec<D> Combine(D, const Vec<Half<D>>& upper, const Vec<Half<D>>& lower) {
  return Run<D, 0>(lower, upper, std::make_index_sequence<D::kLanes>());
}
template <class D>
HWY_INLINE Vec<D> ConcatLowerLower(D d, const Vec<D>& upper, const Vec<D>& lower) {
  return Combine(d, LowerHalf(upper), LowerHalf(lower));
}
template <class D>
HWY_INLINE Vec<D> ConcatUpperUpper(D d, const Vec<D>& upper, const Vec<D>& lower) {
  return Combine(d, UpperHalf(Half<D>(), upper), UpperHalf(Half<D>(), lower));
}

template <class D>
HWY_INLINE void LoadInterleaved3(D, const typename D::Lane* from, Vec<D>& x, Vec<D>& y, Vec<D>& z) {
  for (std::size_t i = 0; i < D::kLanes; ++i) {
    x.raw[i] = from[3 * i];
    y.raw[i] = from[3 * i + 1];
    z.raw[i] = from[3 * i + 2];
  }
}
template <class D>
HWY_INLINE void StoreInterleaved3(const Vec<D>& x, const Vec<D>& y, const Vec<D>& z, D d, typename D::Lane* to) {
  if constexpr (D::kLanes == 4) {
    const Vec<D> xy = InterleaveLower(d, x, y);                                // x0 y0 x1 y1
    const Vec<D> yz = Picked<D>(y, z, std::index_sequence<1, 5, 2, 6>());      // y1 z1 y2 z2
    const Vec<D> last = Picked<D>(x, y, std::index_sequence<3, 7, 3, 7>());    // x3 y3
    StoreU(Picked<D>(xy, z, std::index_sequence<0, 1, 4, 2>()), d, to);        // x0 y0 z0 x1
    StoreU(Picked<D>(yz, x, std::index_sequence<0, 1, 6, 2>()), d, to + 4);    // y1 z1 x2 y2
    StoreU(Picked<D>(z, last, std::index_sequence<2, 4, 5, 3>()), d, to + 8);  // z2 x3 y3 z3
  } else {
    for (std::size_t i = 0; i < D::kLanes; ++i) {
      to[3 * i] = x.raw[i];
      to[3 * i + 1] = y.raw[i];
      to[3 * i + 2] = z.raw[i];
    }
  }
}
template <class D>
HWY_INLINE void StoreInterleaved4(const Vec<D>& x, const Vec<D>& y, const Vec<D>& z, const Vec<D>& w, D,
                                  typename D::Lane* to) {
  for (std::size_t i = 0; i < D::kLanes; ++i) {
    to[4 * i] = x.raw[i];
    to[4 * i + 1] = y.raw[i];
    to[4 * i + 2] = z.raw[i];
    to[4 * i + 3] = w.raw[i];
  }
}

template <class D>
HWY_INLINE Vec<RebindToSigned<D>> SetTableIndices(D, const std::int32_t* from) {
  return LoadU(RebindToSigned<D>(), from);
}
template <class T, std::size_t kCount>
HWY_INLINE Vector<T, kCount> TableLookupLanes(const Vector<T, kCount>& v, const Vector<Integer<T>, kCount>& places) {
  Vector<T, kCount> result;
  for (std::size_t i = 0; i < kCount; ++i) result.raw[i] = v.raw[static_cast<std::size_t>(places.raw[i])];
  return result;
}

// Return vectors in which every lane is the smallest, or the largest, of all lanes.
template <class D>
HWY_INLINE Vec<D> MinOfLanes(D d, const Vec<D>& v) {
  typename D::Lane least = v.raw[0];
  for (std::size_t i = 1; i < D::kLanes; ++i) least = v.raw[i] < least ? v.raw[i] : least;
  return Set(d, least);
}
template <class D>
HWY_INLINE Vec<D> MaxOfLanes(D d, const Vec<D>& v) {
  typename D::Lane most = v.raw[0];
  for (std::size_t i = 1; i < D::kLanes; ++i) most = most < v.raw[i] ? v.raw[i] : most;
  return Set(d, most);
}

}  // namespace N_PLAIN
}  // namespace chronormal::inline internal::hwy

#endif  // CHRONORMAL_SIMD_PLAIN_LANES_H_
