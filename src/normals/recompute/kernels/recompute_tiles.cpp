// Evaluates triangles in lanes of float32, and thin triangles in lanes of double. Triangles for which double is not
// precise enough are marked as doubtful.
#include "normals/recompute/kernels/recompute_tiles.h"

#include <algorithm>
#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/recompute/kernels/recompute_tiles.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "normals/recompute/kernels/results-inl.h"
#include "simd/index_range-inl.h"
#include "simd/intrinsics-inl.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

constexpr std::size_t kBlock = 16;

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Lanes4 LoadRows(const float* rows) { return LoadRow(rows); }

struct Sum {
  double values[4] = {};

  HWY_INLINE void Add(const FaceNormal& n) {
    const float* const terms = &n.x;
    for (int i = 0; i < 4; ++i) values[i] += static_cast<double>(terms[i]);
  }
  HWY_INLINE void Store(float* to) const {
    for (int i = 0; i < 4; ++i) to[i] = static_cast<float>(values[i]);
  }
};

#else

// Loads a vector as blocks of four floats. Each block is at `base` plus one of kLanes / 4 offsets.
HWY_INLINE Floats RowsAt(const float* base, const std::size_t* offsets) {
  return LoadBlocks([base, offsets](std::size_t block) HWY_ATTR { return base + offsets[block]; });
}

HWY_INLINE Lanes4 LoadRows(const float* rows) {
  constexpr std::size_t kOffsets[] = {0, 16, 32, 48};
  return Transposed(
      {RowsAt(rows, kOffsets), RowsAt(rows + 4, kOffsets), RowsAt(rows + 8, kOffsets), RowsAt(rows + 12, kOffsets)});
}

// The sum of some normals, and of their errors, in double.
template <std::size_t kRegisters>
struct SumOf {
  using Tag = hn::CappedTag<double, 4 / kRegisters>;
  hn::Vec<Tag> parts[kRegisters] = {};

  HWY_INLINE SumOf() {
    for (auto& part : parts) part = hn::Zero(Tag());
  }
  HWY_INLINE void Add(const FaceNormal& n) {
    const Row row = LoadRow(&n.x);
    if constexpr (kRegisters == 1) {
      parts[0] = hn::Add(parts[0], hn::PromoteTo(Tag(), row));
    } else {
      const hn::Rebind<float, Tag> half;
      parts[0] = hn::Add(parts[0], hn::PromoteTo(Tag(), hn::LowerHalf(half, row)));
      parts[1] = hn::Add(parts[1], hn::PromoteTo(Tag(), hn::UpperHalf(half, row)));
    }
  }
  HWY_INLINE void Store(float* to) const {
    const hn::Rebind<float, Tag> some;
    for (std::size_t i = 0; i < kRegisters; ++i) hn::Store(hn::DemoteTo(some, parts[i]), some, to + 4 / kRegisters * i);
  }
};
using Sum = SumOf<kLanes == 4 ? 2 : 1>;

#endif

// The edges from the first corner of each face of a block, at both ends of the segment, and the corners from which
// these edges were made.
struct alignas(64) EdgeBlock {
  float start_e[3][kBlock], start_f[3][kBlock], end_e[3][kBlock], end_f[3][kBlock];
  const std::uint32_t* corners;
  std::uint32_t padded[3 * kBlock];  // the corners of a block of fewer than 16 faces, with the last face repeated
  bool has_last;                     // true if one of the corners is the last vertex, after which nothing may be read
};

HWY_INLINE void StorePlanes(const Lanes4& v, float (*planes)[kBlock], std::size_t lane) {
  hn::Store(v.x, kFloats, planes[0] + lane);
  hn::Store(v.y, kFloats, planes[1] + lane);
  hn::Store(v.z, kFloats, planes[2] + lane);
}

HWY_INLINE Floats Square(const float (*planes)[kBlock], std::size_t lane) {
  const Lanes3 v = {hn::Load(kFloats, planes[0] + lane), hn::Load(kFloats, planes[1] + lane),
                    hn::Load(kFloats, planes[2] + lane)};
  return Dot(v, v);
}

// Loads edges one coordinate at a time, so that nothing beyond the coordinates is read.
inline void LoadEdgesExactly(const float* from, const float* to, std::size_t stride, const std::uint32_t* corners,
                             EdgeBlock& block) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    const std::size_t a = stride * corners[3 * i], b = stride * corners[3 * i + 1], c = stride * corners[3 * i + 2];
    for (std::size_t k = 0; k < 3; ++k) {
      block.start_e[k][i] = from[b + k] - from[a + k];
      block.start_f[k][i] = from[c + k] - from[a + k];
      block.end_e[k][i] = to[b + k] - to[a + k];
      block.end_f[k][i] = to[c + k] - to[a + k];
    }
  }
}

#if HWY_TARGET == HWY_SCALAR

constexpr bool kReadsBehind = false;

template <std::size_t kStride>
HWY_INLINE void LoadEdges(const float* from, const float* to, const std::uint32_t* corners, EdgeBlock& block) {
  LoadEdgesExactly(from, to, kStride, corners, block);
}

#else

constexpr bool kReadsBehind = true;

// The edges of every fourth face of a block, from some face on, as rows of four floats.
struct EdgeRows {
  Floats e0, f0, e1, f1;
};

template <std::size_t kStride>
HWY_INLINE EdgeRows RowsOfEdges(const float* from, const float* to, const std::uint32_t* corners) {
  constexpr std::size_t kRows = kLanes / 4;
  std::size_t offsets[3 * kRows];
  for (std::size_t i = 0; i < kRows; ++i) {
    offsets[i] = kStride * corners[12 * i];
    offsets[kRows + i] = kStride * corners[12 * i + 1];
    offsets[2 * kRows + i] = kStride * corners[12 * i + 2];
  }
  const Floats a0 = RowsAt(from, offsets), a1 = RowsAt(to, offsets);
  const Floats b0 = RowsAt(from, offsets + kRows), b1 = RowsAt(to, offsets + kRows);
  const Floats c0 = RowsAt(from, offsets + 2 * kRows), c1 = RowsAt(to, offsets + 2 * kRows);
  return {hn::Sub(b0, a0), hn::Sub(c0, a0), hn::Sub(b1, a1), hn::Sub(c1, a1)};
}

// Loads edges with vector instructions, which read one float more than the three floats of a vertex.
template <std::size_t kStride>
HWY_INLINE void LoadEdges(const float* from, const float* to, const std::uint32_t* corners, EdgeBlock& block) {
  for (std::size_t k = 0; k < kBlock; k += kLanes, corners += 3 * kLanes) {
    const EdgeRows r0 = RowsOfEdges<kStride>(from, to, corners);
    const EdgeRows r1 = RowsOfEdges<kStride>(from, to, corners + 3);
    const EdgeRows r2 = RowsOfEdges<kStride>(from, to, corners + 6);
    const EdgeRows r3 = RowsOfEdges<kStride>(from, to, corners + 9);
    StorePlanes(Transposed({r0.e0, r1.e0, r2.e0, r3.e0}), block.start_e, k);
    StorePlanes(Transposed({r0.f0, r1.f0, r2.f0, r3.f0}), block.start_f, k);
    StorePlanes(Transposed({r0.e1, r1.e1, r2.e1, r3.e1}), block.end_e, k);
    StorePlanes(Transposed({r0.f1, r1.f1, r2.f1, r3.f1}), block.end_f, k);
  }
}

#endif

// Returns s a + t b in double, for as many lanes from `lane` on as fit into a vector of doubles. A vector of doubles
// has half as many lanes as a vector of floats, or one lane if a vector of floats has one.
HWY_INLINE Doubles3 Lerp(Doubles s, const float (*a)[kBlock], Doubles t, const float (*b)[kBlock], std::size_t lane) {
  const HalfFloatTag part;
  const auto load = [part, lane](const float* plane)
                        HWY_ATTR { return hn::PromoteTo(kDoubles, hn::Load(part, plane + lane)); };
  return {hn::Add(hn::Mul(s, load(a[0])), hn::Mul(t, load(b[0]))),
          hn::Add(hn::Mul(s, load(a[1])), hn::Mul(t, load(b[1]))),
          hn::Add(hn::Mul(s, load(a[2])), hn::Mul(t, load(b[2])))};
}

HWY_INLINE Doubles3 CrossOfLerps(const EdgeBlock& block, std::size_t lane, const LocalTime& t) {
  const Doubles s1 = hn::Set(kDoubles, t.rest), t1 = hn::Set(kDoubles, t.t);
  return Cross(Lerp(s1, block.start_e, t1, block.end_e, lane), Lerp(s1, block.start_f, t1, block.end_f, lane));
}

// Returns the lanes in which squares in float32 neither overflow nor lose digits.
HWY_INLINE hn::Mask<FloatTag> InRange(Floats smallest, Floats largest) {
  return hn::And(hn::Ge(smallest, hn::Set(kFloats, 0x1p-100f)), hn::Le(largest, hn::Set(kFloats, 0x1p100f)));
}

struct Normals {
  Lanes3 n;
  Floats product;  // the product A B, as in recompute_tiles.h
  Floats smaller;  // the smaller one of A and B
  hn::Mask<FloatTag> trusted;
};

HWY_INLINE Normals NormalsAt(const EdgeBlock& block, std::size_t lane, const LocalTime& t) {
#if HWY_TARGET == HWY_SCALAR
  const Doubles3 exact = CrossOfLerps(block, lane, t);
  const Lanes3 n = {hn::DemoteTo(kFloats, exact.x), hn::DemoteTo(kFloats, exact.y), hn::DemoteTo(kFloats, exact.z)};
#else
  const Doubles3 lower = CrossOfLerps(block, lane, t), upper = CrossOfLerps(block, lane + kLanes / 2, t);
  const Lanes3 n = {Joined(lower.x, upper.x), Joined(lower.y, upper.y), Joined(lower.z, upper.z)};
#endif
  const Floats s1 = hn::Set(kFloats, static_cast<float>(t.rest)), t1 = hn::Set(kFloats, static_cast<float>(t.t));
  const Floats a = hn::Add(hn::Mul(s1, Square(block.start_e, lane)), hn::Mul(t1, Square(block.end_e, lane)));
  const Floats b = hn::Add(hn::Mul(s1, Square(block.start_f, lane)), hn::Mul(t1, Square(block.end_f, lane)));
  const Floats product = hn::Mul(a, b), square = Dot(n, n);
  const auto precise = hn::Le(product, hn::Mul(hn::Set(kFloats, kMostProduct), square));
  const Floats smaller = hn::Min(a, b);
  return {n, product, smaller, hn::And(precise, InRange(hn::Min(square, smaller), square))};
}

// Returns the positions of corner c of kLanes faces of a block, at one end of the segment.
template <std::size_t kStride>
HWY_INLINE Lanes3 PointsOf(const float* points, const EdgeBlock& block, std::size_t lane, std::size_t c) {
  const std::uint32_t* const corners = block.corners + 3 * lane + c;
#if HWY_TARGET != HWY_SCALAR
  if (HWY_LIKELY(!block.has_last)) {
    Floats rows[4];
    for (std::size_t k = 0; k < 4; ++k) {
      rows[k] = LoadBlocks([&](std::size_t b) HWY_ATTR { return points + kStride * corners[3 * (4 * b + k)]; });
    }
    return Transposed(rows).xyz();
  }
#endif
  alignas(64) float planes[3][kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    for (std::size_t k = 0; k < 3; ++k) planes[k][i] = points[kStride * corners[3 * i] + k];
  }
  return {hn::Load(kFloats, planes[0]), hn::Load(kFloats, planes[1]), hn::Load(kFloats, planes[2])};
}

// The normals of kLanes faces of a block, computed from exact edges. recompute_tiles.h explains such normals under
// "thin".
struct FineNormals {
  Lanes3 n, unit;
  Floats square;  // n . n in float32
  hn::Mask<FloatTag> trusted;
};

struct CornersAtEnd {
  Lanes3 a, b, c;
};

// Return n(t) for half of the lanes, and the unit vector along n(t). `scale` is 1 / |n| in float32.
template <int kHalf>
HWY_INLINE Doubles3 ExactNormal(const CornersAtEnd& from, const CornersAtEnd& to, const LocalTime& t) {
  const Doubles s1 = hn::Set(kDoubles, t.rest), t1 = hn::Set(kDoubles, t.t);
  const Doubles3 a0 = ToDouble<kHalf>(from.a), a1 = ToDouble<kHalf>(to.a);
  const Doubles3 e = Scale(s1, ToDouble<kHalf>(from.b) - a0) + Scale(t1, ToDouble<kHalf>(to.b) - a1);
  const Doubles3 f = Scale(s1, ToDouble<kHalf>(from.c) - a0) + Scale(t1, ToDouble<kHalf>(to.c) - a1);
  return Cross(e, f);
}
template <int kHalf>
HWY_INLINE Doubles3 ExactUnit(const Doubles3& n, Floats scale) {
  // Two steps of Newton's method refine 1 / |n|. Each step doubles the number of correct digits.
  const Doubles half_square = hn::Mul(hn::Set(kDoubles, 0.5), Dot(n, n)), three_halves = hn::Set(kDoubles, 1.5);
  Doubles y = ToDouble<kHalf>(scale);
  for (int step = 0; step < 2; ++step) y = hn::Mul(y, hn::Sub(three_halves, hn::Mul(hn::Mul(half_square, y), y)));
  return Scale(y, n);
}

template <std::size_t kStride>
HWY_NOINLINE FineNormals FineNormalsAt(const MovingTriangles& triangles, const EdgeBlock& block, std::size_t lane,
                                       const LocalTime& t, Floats product, Floats smaller) {
  const auto corners = [&](const float* points) HWY_ATTR {
    return CornersAtEnd{PointsOf<kStride>(points, block, lane, 0), PointsOf<kStride>(points, block, lane, 1),
                        PointsOf<kStride>(points, block, lane, 2)};
  };
  const CornersAtEnd from = corners(triangles.from), to = corners(triangles.to);
  constexpr int kUpper = HWY_TARGET == HWY_SCALAR ? 0 : 1;
  const Doubles3 lower = ExactNormal<0>(from, to, t), upper = ExactNormal<kUpper>(from, to, t);
  FineNormals fine;
  fine.n = Joined(lower, upper);
  fine.square = Dot(fine.n, fine.n);
  // The product A B (see recompute_tiles.h) is divided by its largest allowed ratio to |n|^2. If |n|^2 were multiplied
  // by this ratio instead, the result could be infinite, and even an infinite A B would count as small enough.
  const auto precise = hn::Le(hn::Mul(product, hn::Set(kFloats, 1 / kMaxThinProduct)), fine.square);
  fine.trusted = hn::And(precise, InRange(hn::Min(fine.square, smaller), fine.square));
  const Floats one = hn::Set(kFloats, 1.0f);
  const Floats scale = hn::Div(one, hn::Sqrt(hn::IfThenElse(fine.trusted, fine.square, one)));
  fine.unit = Joined(ExactUnit<0>(lower, scale), ExactUnit<kUpper>(upper, scale));
  return fine;
}

HWY_INLINE Lanes3 Select(hn::Mask<FloatTag> mask, const Lanes3& yes, const Lanes3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

// Returns true if one of the 48 corners of a block is a given vertex.
HWY_INLINE bool Contains(const std::uint32_t* corners, std::uint32_t vertex) {
  const auto wanted = hn::Set(kIndices, vertex);
  auto found = hn::Eq(hn::LoadU(kIndices, corners), wanted);
  for (std::size_t i = kLanes; i < 3 * kBlock; i += kLanes)
    found = hn::Or(found, hn::Eq(hn::LoadU(kIndices, corners + i), wanted));
  return !hn::AllFalse(kIndices, found);
}

// The number of faces, and of terms of sums, by which memory is prefetched in advance. These distances are enough for
// about 50 cache misses at the same time.
constexpr std::size_t kFacesAhead = 48, kTermsAhead = 64;

template <std::size_t kStride>
HWY_INLINE void Fetch(const MovingTriangles& triangles, const std::uint32_t* corners) {
  for (std::size_t k = 0; k < 3 * kBlock; ++k) {
    hwy::Prefetch(triangles.from + kStride * corners[k]);
    if constexpr (kStride == 3) hwy::Prefetch(triangles.to + kStride * corners[k]);
  }
}

// Loads the edges of a block of faces. If there are fewer than 16 faces, the last face is repeated.
template <std::size_t kStride>
HWY_INLINE void LoadBlock(const MovingTriangles& triangles, std::size_t first, std::size_t count, EdgeBlock& block) {
  const auto last = static_cast<std::uint32_t>(triangles.vertex_count - 1);
  const std::uint32_t* corners = triangles.corners + 3 * first;
  if (HWY_UNLIKELY(count < kBlock)) {
    for (std::size_t k = 0; k < 3 * kBlock; ++k) block.padded[k] = corners[3 * std::min(k / 3, count - 1) + k % 3];
    corners = block.padded;
  } else if (!triangles.is_coherent && first + kFacesAhead + kBlock <= triangles.face_count) {
    Fetch<kStride>(triangles, corners + 3 * kFacesAhead);
  }
  block.corners = corners;
  block.has_last = kReadsBehind && kStride == 3 && Contains(corners, last);
  if (HWY_UNLIKELY(block.has_last)) {
    LoadEdgesExactly(triangles.from, triangles.to, kStride, corners, block);
  } else {
    LoadEdges<kStride>(triangles.from, triangles.to, corners, block);
  }
}

// Calls body(place, normals, fine) for every kLanes faces of a range. fine() computes the normals of these faces from
// exact edges. The next block is loaded before the current block is processed, so that the processor can do both at the
// same time.
template <std::size_t kStride, class Body>
HWY_INLINE void ForNormalsOfStride(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                   const Body& body) {
  EdgeBlock blocks[2];
  LoadBlock<kStride>(triangles, faces.first, faces.count, blocks[0]);
  for (std::size_t i = 0; i < faces.count; i += kBlock) {
    const EdgeBlock& block = blocks[i / kBlock % 2];
    if (i + kBlock < faces.count) {
      LoadBlock<kStride>(triangles, faces.first + i + kBlock, faces.count - i - kBlock, blocks[(i / kBlock + 1) % 2]);
    }
    for (std::size_t k = 0; k < kBlock; k += kLanes) {
      const Normals normals = NormalsAt(block, k, t);
      body(i + k, normals,
           [&]() HWY_ATTR { return FineNormalsAt<kStride>(triangles, block, k, t, normals.product, normals.smaller); });
    }
  }
}

template <class Body>
HWY_INLINE void ForNormals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t, const Body& body) {
  if (triangles.is_paired)
    ForNormalsOfStride<8>(triangles, faces, t, body);
  else
    ForNormalsOfStride<3>(triangles, faces, t, body);
}

std::size_t RecomputeUnitNormals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                 VectorView<float> result, bool stream, std::uint32_t* doubtful) {
  return WithLayout(result, stream, [&](auto layout) HWY_ATTR {
    std::size_t count = 0;
    const auto body = [&](std::size_t place, const Normals& normals, const auto& fine_normals) HWY_ATTR {
      Lanes3 unit = Normalized(normals.n);
      if (HWY_UNLIKELY(!hn::AllTrue(kFloats, normals.trusted))) {
        const FineNormals fine = fine_normals();
        unit = Select(normals.trusted, unit, fine.unit);
        count = Append(hn::Or(normals.trusted, fine.trusted), place, faces.count, count, doubtful);
      }
      Write<layout()>(unit, place, result);
    };
    ForNormals(triangles, faces, t, body);
    return count;
  });
}

std::size_t RecomputeFaceNormals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                 FaceNormal* result, std::uint32_t* doubtful) {
  std::size_t count = 0;
  const auto body = [&](std::size_t place, const Normals& normals, const auto& fine_normals) HWY_ATTR {
    // In the factor 3.32, 2.31 is for the edges, 1 for rounding n, and the rest for the rounding of the bound itself.
    Floats error = hn::Mul(hn::Set(kFloats, 3.32f), hn::Sqrt(normals.product));
    Lanes3 n = normals.n;
    if (HWY_UNLIKELY(!hn::AllTrue(kFloats, normals.trusted))) {
      const FineNormals fine = fine_normals();
      n = Select(normals.trusted, n, fine.n);
      const Floats of_product = hn::Mul(hn::Set(kFloats, kThinError), hn::Sqrt(normals.product));
      const Floats fine_error = hn::Mul(hn::Set(kFloats, 1.01f), hn::Add(hn::Sqrt(fine.square), of_product));
      error = hn::IfThenElse(normals.trusted, error, fine_error);
      count = Append(hn::Or(normals.trusted, fine.trusted), place, faces.count, count, doubtful);
    }
    if (HWY_LIKELY(place + kLanes <= faces.count)) {
      hn::StoreInterleaved4(n.x, n.y, n.z, error, kFloats, &result[place].x);
    } else {
      alignas(64) float rows[4 * kLanes];
      hn::StoreInterleaved4(n.x, n.y, n.z, error, kFloats, rows);
      for (std::size_t i = 0; place + i < faces.count; ++i)
        result[place + i] = {rows[4 * i], rows[4 * i + 1], rows[4 * i + 2], rows[4 * i + 3]};
    }
  };
  ForNormals(triangles, faces, t, body);
  return count;
}

template <ResultLayout kLayout>
HWY_INLINE std::size_t GroupNormals(const NormalGroups& groups, IndexRange elements, const NormalWindow& window,
                                    const VectorView<float>& result, std::uint32_t* doubtful) {
  const auto last = groups.faces(elements.end() - 1);
  const std::uint32_t* const end = last.data() + last.size();
  const std::uint32_t* f = groups.faces(elements.first).data();
  std::size_t count = 0;
  alignas(64) float rows[4 * kBlock] = {};
  for (std::size_t i = 0; i < elements.count; i += kBlock) {
    const std::size_t in_block = std::min(kBlock, elements.count - i);
    for (std::size_t k = 0; k < in_block; ++k) {
      Sum sum;
      const std::uint32_t* const faces_end = f + groups.faces(elements.first + i + k).size();
      if (!window.fetch && faces_end - f == 6) {
        // Six faces are added without a loop over them, since vertices have six faces far more often than any other
        // number.
        for (int term = 0; term < 6; ++term) sum.Add(window.normals[f[term] & window.mask]);
        f = faces_end;
      }
      for (; f != faces_end; ++f) {
        if (window.fetch && end - f > static_cast<std::ptrdiff_t>(kTermsAhead))
          hwy::Prefetch(window.normals + (f[kTermsAhead] & window.mask));
        sum.Add(window.normals[*f & window.mask]);
      }
      sum.Store(rows + 4 * k);
    }
    for (std::size_t k = 0; k < in_block; k += kLanes) {
      const Lanes4 v = LoadRows(rows + 4 * k);
      const Lanes3 n = {v.x, v.y, v.z};
      const Floats square = Dot(n, n);
      // An error of n of at most 14.56 u |n|, where u = 2^-24, leaves 2 u |n| for the rounding to float32.
      const auto precise = hn::Le(hn::Mul(v.w, v.w), hn::Mul(hn::Set(kFloats, 212.0f), square));
      Write<kLayout>(Normalized(n), i + k, result);
      count = Append(hn::And(precise, InRange(square, square)), i + k, elements.count, count, doubtful);
    }
  }
  return count;
}

std::size_t RecomputeGroupNormals(const NormalGroups& groups, IndexRange elements, const NormalWindow& window,
                                  VectorView<float> result, bool stream, std::uint32_t* doubtful) {
  return WithLayout(result, stream, [&](auto layout) HWY_ATTR {
    return GroupNormals<layout()>(groups, elements, window, result, doubtful);
  });
}

IndexRange RangeOfIndices(const std::uint32_t* indices, std::size_t count) { return RangeOf(indices, count); }

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(RecomputeUnitNormals);
HWY_EXPORT(RecomputeFaceNormals);
HWY_EXPORT(RecomputeGroupNormals);
HWY_EXPORT(RangeOfIndices);

std::size_t recompute_unit_normals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                   VectorView<float> result, bool stream, std::uint32_t* doubtful) noexcept {
  assert(0 < faces.count && faces.end() <= triangles.face_count && result.count == faces.count);
  return HWY_DYNAMIC_DISPATCH(RecomputeUnitNormals)(triangles, faces, t, result, stream, doubtful);
}

std::size_t recompute_face_normals(const MovingTriangles& triangles, IndexRange faces, const LocalTime& t,
                                   FaceNormal* result, std::uint32_t* doubtful) noexcept {
  assert(0 < faces.count && faces.end() <= triangles.face_count);
  return HWY_DYNAMIC_DISPATCH(RecomputeFaceNormals)(triangles, faces, t, result, doubtful);
}

std::size_t recompute_group_normals(const NormalGroups& groups, IndexRange elements, const NormalWindow& window,
                                    VectorView<float> result, bool stream, std::uint32_t* doubtful) noexcept {
  assert(0 < elements.count && elements.end() <= groups.size() && result.count == elements.count);
  return HWY_DYNAMIC_DISPATCH(RecomputeGroupNormals)(groups, elements, window, result, stream, doubtful);
}

IndexRange range_of(std::span<const std::uint32_t> values) noexcept {
  assert(!values.empty());
  return HWY_DYNAMIC_DISPATCH(RangeOfIndices)(values.data(), values.size());
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
