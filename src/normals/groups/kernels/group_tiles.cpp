// Adds up control normals along the paths around sixteen elements at a time:
//
//     indices --LoadRing--> both ends of each point, a column for each lane --SumRing--> control normals in double
//                                                                 --RoundTile--> float32, and the elements to examine
//
// Let c be the centre of a path and p its points, at two times. Every second point adds one product to n0, n1 and m:
// (p[i] - c) x (p[i + 1] - p[i - 1]). In n0 and n1 both factors are of the same time, and in m they are of different
// times.
#include "normals/groups/kernels/group_tiles.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>

#include "core/rounding.h"
#include "normals/control/kernels/exact_tile.h"
#include "normals/groups/group_sum.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/groups/kernels/group_tiles.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "normals/control/kernels/tile_degrees-inl.h"
#include "normals/control/kernels/triangles-inl.h"
#include "simd/intrinsics-inl.h"
#include "simd/rows-inl.h"

#ifndef CHRONORMAL_NORMALS_KERNELS_GROUP_TILES_ONCE
#define CHRONORMAL_NORMALS_KERNELS_GROUP_TILES_ONCE
namespace chronormal::inline internal {

// An upper bound of twice the rounding error of a sum over a path of up to kMostPathPoints points, relative to the
// magnitude of the sum.
inline constexpr float kSumErrorAbove = 0x1p-43f;

// The inputs of the kernels below.
struct RingInput {
  const Segment& segment;
  const NormalGroups& groups;
  const RingSlices& rings;
  bool fetch;
};

// The positions of one point of each lane at both ends of the segment, stored as from.x of sixteen lanes, then from.y,
// from.z, to.x, to.y, to.z.
struct alignas(64) PointColumns {
  float at[6][kTile];
};

// Writes the sum that group_control_normals() computes for an element into one lane of both tiles. Components that are
// only rounding errors are zero.
void set_sum_without_rounding(const Segment& segment, const NormalGroups& groups, std::size_t element, std::size_t lane,
                              ExactTile& exact, ControlTile& tile) noexcept;

}  // namespace chronormal::inline internal
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Points are prefetched this many rows of indices before they are used.
constexpr std::size_t kRowsAhead = 24;

HWY_INLINE void StoreColumns(const Lanes3& v, float (*to)[kTile], std::size_t lane) {
  hn::Store(v.x, kFloats, to[0] + lane);
  hn::Store(v.y, kFloats, to[1] + lane);
  hn::Store(v.z, kFloats, to[2] + lane);
}

template <PointAccess kAccess>
HWY_INLINE void LoadRing(const Segment& segment, const std::uint32_t* indices, std::size_t rows, PointColumns* points) {
  for (std::size_t r = 0; r < rows; ++r, indices += kTile) {
    for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
      Lanes3 from, to;
      LoadBothEnds<kAccess, 1>(segment, indices + lane, from, to);
      StoreColumns(from, points[r].at, lane);
      StoreColumns(to, points[r].at + 3, lane);
    }
  }
}

// Prefetches the points of the `rows` rows that come kRowsAhead rows after the first row of `indices`.
HWY_INLINE void FetchRows(const Segment& segment, PointAccess access, const std::uint32_t* indices, std::size_t rows) {
  for (std::size_t i = 0; i < kTile * rows; ++i) {
    const std::size_t vertex = indices[kTile * kRowsAhead + i];
    hwy::Prefetch(segment.from.x + vertex * segment.from.stride);
    if (access != PointAccess::kEnds) hwy::Prefetch(segment.to.x + vertex * segment.to.stride);
  }
}

// Returns true if a path contains the last vertex of the mesh. The 16 bytes that are loaded for this vertex would end
// beyond the array of positions.
HWY_INLINE bool HasLast(const std::uint32_t* indices, std::size_t rows, std::size_t vertex_count) {
  const hn::RebindToUnsigned<FloatTag> tag;
  const auto last = hn::Set(tag, static_cast<std::uint32_t>(vertex_count - 1));
  auto highest = hn::LoadU(tag, indices);
  for (std::size_t i = kLanes; i < kTile * rows; i += kLanes) highest = hn::Max(highest, hn::LoadU(tag, indices + i));
  return !hn::AllFalse(tag, hn::Eq(highest, last));
}

HWY_INLINE Doubles3 DoublesAt(const float (*at)[kTile], std::size_t lane) {
  const auto load = [lane](const float* plane)
                        HWY_ATTR { return hn::PromoteTo(kDoubles, hn::Load(HalfFloatTag(), plane + lane)); };
  return {load(at[0]), load(at[1]), load(at[2])};
}

HWY_INLINE void StoreColumns(const Doubles3& v, double (*to)[kTile], std::size_t lane) {
  hn::Store(v.x, kDoubles, to[0] + lane);
  hn::Store(v.y, kDoubles, to[1] + lane);
  hn::Store(v.z, kDoubles, to[2] + lane);
}

// The sums over a path that become n0, twice m, and n1.
struct RingSum {
  Doubles3 n0, m, n1;

  HWY_INLINE void Add(const Doubles3& e0, const Doubles3& e1, const Doubles3& d0, const Doubles3& d1) {
    n0 = n0 + Cross(e0, d0);
    n1 = n1 + Cross(e1, d1);
    m = m + (Cross(e0, d1) + Cross(e1, d0));
  }
};

HWY_INLINE void SumRing(const PointColumns* points, std::size_t rows, ExactTile& exact) {
  for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) {
    const auto from = [=](std::size_t r) HWY_ATTR { return DoublesAt(points[r].at, lane); };
    const auto to = [=](std::size_t r) HWY_ATTR { return DoublesAt(points[r].at + 3, lane); };
    const Doubles zero = hn::Zero(kDoubles);
    RingSum sum{{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    const Doubles3 centre0 = from(0), centre1 = to(0);
    Doubles3 before0 = from(1), before1 = to(1);
    std::size_t r = 2;
    for (; r + 1 < rows; r += 2) {
      const Doubles3 after0 = from(r + 1), after1 = to(r + 1);
      sum.Add(from(r) - centre0, to(r) - centre1, after0 - before0, after1 - before1);
      before0 = after0;
      before1 = after1;
    }
    if (r < rows) sum.Add(before0 - centre0, before1 - centre1, from(r) - centre0, to(r) - centre1);
    StoreColumns(sum.n0, exact.normals, lane);
    StoreColumns(Scale(hn::Set(kDoubles, 0.5), sum.m), exact.normals + 3, lane);
    StoreColumns(sum.n1, exact.normals + 6, lane);
  }
}

// Returns an upper bound of the sum of the absolute products in any component of a sum over a path, where each factor
// may be from either end of the segment.
HWY_INLINE Floats MagnitudeAbove(const PointColumns* points, std::size_t rows, std::size_t lane) {
  const auto at = [=](std::size_t r, std::size_t end) HWY_ATTR {
    const auto& plane = points[r].at + 3 * end;
    return Lanes3{hn::Load(kFloats, plane[0] + lane), hn::Load(kFloats, plane[1] + lane),
                  hn::Load(kFloats, plane[2] + lane)};
  };
  const auto distance = [&](std::size_t a, std::size_t b)
                            HWY_ATTR { return MaxAbs(at(a, 0) - at(b, 0), at(a, 1) - at(b, 1)); };
  // A component has two products. The factor is a little more than 2, to cover the rounding of the products and of
  // their sum. A tiny number is added in case a product underflows.
  const Floats factor = hn::Set(kFloats, 2.0f + 0x1p-17f);
  const Floats tiny = hn::Set(kFloats, std::numeric_limits<float>::min());
  Floats sum = hn::Zero(kFloats);
  const auto add = [&](Floats e, Floats d) HWY_ATTR {
    sum = hn::Add(sum, hn::Add(hn::Mul(factor, hn::Mul(e, d)), hn::Min(hn::Min(e, d), tiny)));
  };
  std::size_t r = 2;
  for (; r + 1 < rows; r += 2) add(distance(r, 0), distance(r + 1, r - 1));
  if (r < rows) add(distance(r - 1, 0), distance(r, 0));
  return sum;
}

// Stores bounds of the errors of a sum over a path, for half of the lanes. With u = 2^-53, the errors are 4 u of every
// product, and u for each addition. For safety, the bound is twice the sum of these errors.
HWY_INLINE void StoreErrors(const PointColumns* points, std::size_t rows, std::size_t lane, double (*errors)[kTile]) {
  const auto at = [=](std::size_t r, std::size_t end) HWY_ATTR {
    const auto& plane = points[r].at + 3 * end;
    const HalfFloatTag half;
    using V = LanesOf3<hn::Vec<HalfFloatTag>>;
    return V{hn::Load(half, plane[0] + lane), hn::Load(half, plane[1] + lane), hn::Load(half, plane[2] + lane)};
  };
  const auto distance = [&](std::size_t a, std::size_t b, std::size_t end) HWY_ATTR {
    const auto d = at(a, end) - at(b, end);
    // The bound is increased slightly, to cover the rounding of the difference.
    return hn::Mul(hn::Set(kDoubles, 1 + 0x1p-20),
                   hn::PromoteTo(kDoubles, hn::Max(hn::Max(hn::Abs(d.x), hn::Abs(d.y)), hn::Abs(d.z))));
  };
  Doubles n0 = hn::Zero(kDoubles), m = n0, n1 = n0;
  const auto add = [&](Doubles e0, Doubles e1, Doubles d0, Doubles d1) HWY_ATTR {
    n0 = hn::Add(n0, hn::Mul(e0, d0));
    m = hn::Add(m, hn::Add(hn::Mul(e0, d1), hn::Mul(e1, d0)));
    n1 = hn::Add(n1, hn::Mul(e1, d1));
  };
  std::size_t r = 2;
  for (; r + 1 < rows; r += 2)
    add(distance(r, 0, 0), distance(r, 0, 1), distance(r + 1, r - 1, 0), distance(r + 1, r - 1, 1));
  if (r < rows) add(distance(r - 1, 0, 0), distance(r - 1, 0, 1), distance(r, 0, 0), distance(r, 0, 1));
  // Each component has two products e d for each pair of points. m is half of a sum of such products.
  const std::size_t most_products = rows / 2 + 1;
  const Doubles share = hn::Set(kDoubles, 4 * kUnitRoundoff * static_cast<double>(most_products + 4));
  hn::Store(hn::Mul(share, n0), kDoubles, errors[0] + lane);
  hn::Store(hn::Mul(hn::Mul(hn::Set(kDoubles, 0.5), share), m), kDoubles, errors[1] + lane);
  hn::Store(hn::Mul(share, n1), kDoubles, errors[2] + lane);
}

// Rounds the sums to float32 and writes them to the tile. Returns the bits of the elements with a component that may be
// only rounding error.
HWY_INLINE std::uint32_t RoundTile(const PointColumns* points, std::size_t rows, const ExactTile& exact,
                                   ControlTile& tile) {
  std::uint32_t doubtful = 0;
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const Floats magnitude = MagnitudeAbove(points, rows, lane);
    hn::Store(magnitude, kFloats, tile.magnitude + lane);
    const Floats error = hn::Mul(hn::Set(kFloats, kSumErrorAbove), magnitude);
    // An element whose magnitude is NaN counts as doubtful, too.
    auto some = hn::Ne(magnitude, magnitude);
    for (std::size_t k = 0; k < 9; ++k) {
      const Floats v = ToFloat(exact.normals[k] + lane);
      hn::Store(v, kFloats, tile.normals[k] + lane);
      // A zero is certain, unless it is -0, to which a small negative number may have been rounded.
      const auto has_bits =
          hn::MaskFromVec(hn::BitCast(kFloats, hn::VecFromMask(kInts, hn::Ne(hn::BitCast(kInts, v), hn::Zero(kInts)))));
      some = hn::Or(some, hn::And(has_bits, hn::Le(hn::Abs(v), error)));
    }
    if (!hn::AllFalse(kFloats, some)) doubtful |= BitsOf(kFloats, some) << lane;
  }
  return doubtful;
}

HWY_INLINE void LoadRing(const RingInput& input, PointAccess access, const std::uint32_t* indices, std::size_t rows,
                         PointColumns* points) {
  const Segment& segment = input.segment;
  if (access == PointAccess::kEnds) {
    LoadRing<PointAccess::kEnds>(segment, indices, rows, points);
  } else if (access == PointAccess::kPacked && !HasLast(indices, rows, segment.from.count)) {
    LoadRing<PointAccess::kPacked>(segment, indices, rows, points);
  } else {
    LoadRing<PointAccess::kAny>(segment, indices, rows, points);
  }
}

// Computes a tile entirely in float32. `magnitude` of the tile is a bound of the error.
template <PointAccess kAccess>
HWY_INLINE void FloatTile(const Segment& segment, const std::uint32_t* indices, std::size_t rows, ControlTile& tile) {
  // A component has two products. The factor is a little more than 2, to cover the rounding of the products and of
  // their sum. A tiny number is added in case a product underflows.
  const Floats factor = hn::Set(kFloats, 2.0f + 0x1p-17f);
  const Floats tiny = hn::Set(kFloats, std::numeric_limits<float>::min());
  const Floats roundings = RoundingsInFloat(rows / 2 + 1);
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    const auto load = [&](std::size_t r, Lanes3& from, Lanes3& to)
                          HWY_ATTR { LoadBothEnds<kAccess, 1>(segment, indices + kTile * r + lane, from, to); };
    Lanes3 centre0, centre1, before0, before1, point0, point1;
    load(0, centre0, centre1);
    load(1, before0, before1);
    const Floats zero = hn::Zero(kFloats);
    Lanes3 n0{zero, zero, zero}, m = n0, n1 = n0;
    Floats magnitude = zero;
    const auto add = [&](const Lanes3& e0, const Lanes3& e1, const Lanes3& d0, const Lanes3& d1) HWY_ATTR {
      n0 = n0 + Cross(e0, d0);
      n1 = n1 + Cross(e1, d1);
      m = m + (Cross(e0, d1) + Cross(e1, d0));
      const Floats e = MaxAbs(e0, e1), d = MaxAbs(d0, d1);
      magnitude = hn::Add(magnitude, hn::Add(hn::Mul(factor, hn::Mul(e, d)), hn::Min(hn::Min(e, d), tiny)));
    };
    std::size_t r = 2;
    for (; r + 1 < rows; r += 2) {
      Lanes3 after0, after1;
      load(r, point0, point1);
      load(r + 1, after0, after1);
      add(point0 - centre0, point1 - centre1, after0 - before0, after1 - before1);
      before0 = after0;
      before1 = after1;
    }
    if (r < rows) {
      load(r, point0, point1);
      add(before0 - centre0, before1 - centre1, point0 - centre0, point1 - centre1);
    }
    m = Scale(hn::Set(kFloats, 0.5f), m);
    StoreInFloat({n0, m, n1}, hn::Mul(roundings, magnitude), lane, tile);
  }
}

void FloatGroupTilesOf(const RingInput& input, IndexRange elements, ControlTile* tiles) {
  const Segment& segment = input.segment;
  const RingSlices& rings = input.rings;
  const PointAccess access = AccessOf(segment);
  const std::size_t all_rows = rings.first_row[rings.count];
  for (std::size_t first = elements.first; first < elements.end(); first += kTile) {
    const std::size_t first_row = rings.first_row[first / kTile], rows = rings.first_row[first / kTile + 1] - first_row;
    const std::uint32_t* const indices = rings.indices + kTile * first_row;
    if (input.fetch && first_row + rows + kRowsAhead <= all_rows) FetchRows(segment, access, indices, rows);
    if (access == PointAccess::kEnds) {
      FloatTile<PointAccess::kEnds>(segment, indices, rows, *tiles++);
    } else if (access == PointAccess::kPacked && !HasLast(indices, rows, segment.from.count)) {
      FloatTile<PointAccess::kPacked>(segment, indices, rows, *tiles++);
    } else {
      FloatTile<PointAccess::kAny>(segment, indices, rows, *tiles++);
    }
  }
}

void GroupTilesOf(const RingInput& input, IndexRange elements, ControlTile* tiles, BoundedTile* bounded) {
  const Segment& segment = input.segment;
  const RingSlices& rings = input.rings;
  const PointAccess access = AccessOf(segment);
  const std::size_t all_rows = rings.first_row[rings.count];
  PointColumns points[1 + kMostPathPoints];
  ExactTile exact;
  for (std::size_t first = elements.first; first < elements.end(); first += kTile) {
    ControlTile& tile = *tiles++;
    const std::size_t first_row = rings.first_row[first / kTile], rows = rings.first_row[first / kTile + 1] - first_row;
    const std::uint32_t* const indices = rings.indices + kTile * first_row;
    if (input.fetch && first_row + rows + kRowsAhead <= all_rows) FetchRows(segment, access, indices, rows);
    LoadRing(input, access, indices, rows, points);
    SumRing(points, rows, exact);
    if (bounded != nullptr) {
      static_cast<ExactTile&>(*bounded) = exact;
      for (std::size_t lane = 0; lane < kTile; lane += kDoubleLanes) StoreErrors(points, rows, lane, bounded->errors);
      ++bounded;
    }
    const std::uint32_t doubtful = RoundTile(points, rows, exact, tile);
    if (HWY_UNLIKELY(doubtful != 0)) {
      for (std::size_t i = 0; i < kTile; ++i) {
        if ((doubtful >> i & 1) != 0)
          set_sum_without_rounding(segment, input.groups, std::min(first + i, elements.end() - 1), i, exact, tile);
      }
    }
    if (!SetDegreesByFloats(tile)) SetDegrees(exact, tile);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(GroupTilesOf);
HWY_EXPORT(FloatGroupTilesOf);

void set_sum_without_rounding(const Segment& segment, const NormalGroups& groups, std::size_t element, std::size_t lane,
                              ExactTile& exact, ControlTile& tile) noexcept {
  const auto [n0, m, n1] = control_normals_of_group(SharedFaces(segment), groups, element).normals;
  std::size_t k = 0;
  for (const Vec3d& v : {n0, m, n1}) {
    for (const double component : {v.x, v.y, v.z}) {
      exact.normals[k][lane] = component;
      tile.normals[k++][lane] = static_cast<float>(component);
    }
  }
}

GroupTiles::GroupTiles(const Segment& segment, const NormalGroups& groups, bool fetch)
    : segment_(segment),
      faces_(segment),
      groups_(&groups),
      rings_(&rings_around(*segment.topology, groups)),
      fetch_(fetch) {}

void GroupTiles::write(IndexRange elements, std::span<ControlTile> tiles) const noexcept {
  assert(elements.count > 0 && elements.end() <= groups_->size());
  assert(elements.first % kTile == 0 && (elements.count % kTile == 0 || elements.end() == groups_->size()));
  assert(tiles.size() == (elements.count + kTile - 1) / kTile);
  const RingInput input{segment_, *groups_, rings_->view(), fetch_};
  if (has_residuals(segment_)) {
    for (std::size_t element = elements.first; element < elements.end(); ++element) set_alone(element, elements, tiles);
    return;
  }
  HWY_DYNAMIC_DISPATCH(GroupTilesOf)(input, elements, tiles.data(), nullptr);
  for (const std::size_t element : left_out(elements)) set_alone(element, elements, tiles);
}

void GroupTiles::write(IndexRange elements, std::span<ControlTile> tiles,
                       std::span<BoundedTile> bounded) const noexcept {
  assert(elements.count > 0 && elements.end() <= groups_->size());
  assert(elements.first % kTile == 0 && (elements.count % kTile == 0 || elements.end() == groups_->size()));
  assert(tiles.size() == (elements.count + kTile - 1) / kTile && bounded.size() == tiles.size());
  const RingInput input{segment_, *groups_, rings_->view(), fetch_};
  HWY_DYNAMIC_DISPATCH(GroupTilesOf)(input, elements, tiles.data(), bounded.data());
  for (BoundedTile& tile : bounded) tile.left_out = 0;
  for (const std::size_t element : left_out(elements)) {
    set_alone(element, elements, tiles);
    const std::size_t i = element - elements.first;
    bounded[i / kTile].left_out |= 1u << i % kTile;
  }
}

void GroupTiles::write_in_float(IndexRange elements, std::span<ControlTile> tiles) const noexcept {
  assert(elements.count > 0 && elements.first % kTile == 0 && elements.end() <= groups_->size());
  assert(tiles.size() == (elements.count + kTile - 1) / kTile);
  HWY_DYNAMIC_DISPATCH(FloatGroupTilesOf)({segment_, *groups_, rings_->view(), fetch_}, elements, tiles.data());
  for (const std::size_t element : left_out(elements)) {
    const std::size_t i = element - elements.first;
    tiles[i / kTile].magnitude[i % kTile] = std::numeric_limits<float>::infinity();
  }
}

std::span<const std::uint32_t> GroupTiles::left_out(IndexRange elements) const noexcept {
  const auto all = rings_->left_out();
  const auto first = std::lower_bound(all.begin(), all.end(), elements.first);
  return {first, std::lower_bound(first, all.end(), elements.end())};
}

void GroupTiles::set_alone(std::size_t element, IndexRange elements, std::span<ControlTile> tiles) const noexcept {
  const ControlNormals normals = control_normals_of_group(faces_, *groups_, element).normals;
  // Lanes after the last element repeat the last element.
  const std::size_t first = element - elements.first;
  const std::size_t end = element + 1 == elements.end() ? kTile * tiles.size() : first + 1;
  for (std::size_t i = first; i < end; ++i) {
    ControlTile& tile = tiles[i / kTile];
    put(tile, i % kTile, normals);
    tile.degree[i % kTile] = degree(normals);
    // The magnitude infinity tells the code that reads the tile not to trust this element, but to ask for it in double.
    tile.magnitude[i % kTile] = std::numeric_limits<float>::infinity();
  }
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
