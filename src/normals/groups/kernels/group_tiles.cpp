// Sums the control normals of faces over groups in lanes, sixteen elements at a time.
#include "normals/groups/kernels/group_tiles.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <limits>

#include "normals/control/kernels/exact_tile.h"
#include "normals/groups/group_sum.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/groups/kernels/group_tiles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "normals/control/kernels/tile_degrees-inl.h"
#include "normals/control/kernels/triangles-inl.h"
#include "simd/index_range-inl.h"
#include "simd/intrinsics-inl.h"
#include "simd/rows-inl.h"

#ifndef CHRONORMAL_NORMALS_KERNELS_GROUP_TILES_ONCE
#define CHRONORMAL_NORMALS_KERNELS_GROUP_TILES_ONCE
namespace chronormal::inline internal {

// Sums of sixteen elements: nine components, the magnitude, and two that are 0.
inline constexpr std::size_t kSumRow = 12;
struct alignas(64) SumRows {
  double rows[kTile][kSumRow];
};

// Above that the rounding error of a sum may be more than kSumErrorAbove of its magnitude.
inline constexpr std::size_t kMostFaces = 100;
inline constexpr float kSumErrorAbove = 0x1p-43f;

// The same sum as group_control_normals() makes it, with zero for what is nothing but rounding, into one lane of a
// tile.
void set_sum_without_rounding(const Segment& segment, const NormalGroups& groups, std::size_t element, std::size_t lane,
                              SumRows& sums, ControlTile& tile) noexcept;

}  // namespace chronormal::inline internal
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// ---- sums ----------------------------------------------------------------------------------------------------------

// One row: eight components in as few vectors as there are, and the ninth with the magnitude.
struct RowSum {
  using PairTag = hn::CappedTag<double, 2>;
  static constexpr std::size_t kPairLanes = kDoubleLanes < 2 ? kDoubleLanes : 2;
  static constexpr std::size_t kWhole = 8 / kDoubleLanes, kPairs = 2 / kPairLanes;

  Doubles whole[kWhole];
  hn::Vec<PairTag> pair[kPairs];

  HWY_INLINE void Clear() {
    for (auto& v : whole) v = hn::Zero(kDoubles);
    for (auto& v : pair) v = hn::Zero(PairTag());
  }
  HWY_INLINE void Add(const double* row) {
    for (std::size_t i = 0; i < kWhole; ++i) whole[i] = hn::Add(whole[i], hn::LoadU(kDoubles, row + i * kDoubleLanes));
    for (std::size_t i = 0; i < kPairs; ++i) pair[i] = hn::Add(pair[i], hn::LoadU(PairTag(), row + 8 + i * kPairLanes));
  }
  HWY_INLINE void Store(double* row) const {
    for (std::size_t i = 0; i < kWhole; ++i) hn::StoreU(whole[i], kDoubles, row + i * kDoubleLanes);
    for (std::size_t i = 0; i < kPairs; ++i) hn::StoreU(pair[i], PairTag(), row + 8 + i * kPairLanes);
  }
};

// Four columns of the sums, from column k on, of kLanes elements from `lane` on.
HWY_INLINE Lanes4 SumColumns(const SumRows& sums, std::size_t lane, std::size_t k) {
  return Columns([&](std::size_t i) HWY_ATTR { return RoundedRow(sums.rows[lane + i] + k); });
}

// Rounds the sums into the tile. Returns the elements with a component that may be nothing but rounding, as bits.
HWY_INLINE std::uint32_t RoundSums(const SumRows& sums, ControlTile& tile) {
  std::uint32_t doubtful = 0;
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    for (std::size_t k = 0; k < 8; k += 4) {
      const Lanes4 columns = SumColumns(sums, lane, k);
      hn::Store(columns.x, kFloats, &tile.normals[k][lane]);
      hn::Store(columns.y, kFloats, &tile.normals[k + 1][lane]);
      hn::Store(columns.z, kFloats, &tile.normals[k + 2][lane]);
      hn::Store(columns.w, kFloats, &tile.normals[k + 3][lane]);
    }
    const Lanes4 last = SumColumns(sums, lane, 8);
    hn::Store(last.x, kFloats, &tile.normals[8][lane]);
    // A little more, for the rounding of the sum.
    const Floats magnitude = hn::Mul(hn::Set(kFloats, 1 + 0x1p-20f), last.y);
    hn::Store(magnitude, kFloats, tile.magnitude + lane);

    const Floats error = hn::Mul(hn::Set(kFloats, kSumErrorAbove), magnitude);
    auto some = hn::Ne(magnitude, magnitude);
    for (const auto& plane : tile.normals) {
      const Floats v = hn::Load(kFloats, plane + lane);
      const auto not_zero =
          hn::MaskFromVec(hn::BitCast(kFloats, hn::VecFromMask(kInts, hn::Ne(hn::BitCast(kInts, v), hn::Zero(kInts)))));
      some = hn::Or(some, hn::And(not_zero, hn::Le(hn::Abs(v), error)));
    }
    if (hn::AllFalse(kFloats, some)) continue;
    doubtful |= BitsOf(kFloats, some) << lane;
  }
  return doubtful;
}

HWY_NOINLINE inline void SetDegreesOfSums(const SumRows& sums, ControlTile& tile) {
  ExactTile exact;
  for (std::size_t lane = 0; lane < kTile; ++lane) {
    for (std::size_t k = 0; k < 9; ++k) exact.normals[k][lane] = sums.rows[lane][k];
  }
  SetDegrees(exact, tile);
}

// ---- faces ---------------------------------------------------------------------------------------------------------

struct FaceList {
  const std::uint32_t* faces;
  std::size_t count;
};

struct FaceSource {
  const Segment& segment;
  bool rows;
  std::size_t face_count;
};

// The rows of a range of faces that begins at a multiple of 16, and those up to the next one.
void WriteRows(const FaceSource& source, IndexRange faces, double* rows) {
  ExactTile exact;
  for (std::size_t f = faces.first; f < faces.end(); f += kTile, rows += kTile * RowWindow::kRow) {
    FaceTile(source.segment, source.rows, f, source.face_count, exact);
    StoreRows<RowWindow::kRow>(exact, rows);
  }
}

FaceSource SourceOf(const Segment& segment) {
  return {segment, IsRows(segment.from) && IsRows(segment.to), segment.topology->face_count()};
}

void FaceRows(const Segment& segment, IndexRange faces, double* rows) { WriteRows(SourceOf(segment), faces, rows); }

// Computes faces up to `end`, sixteen by sixteen.
void FillWindow(const FaceSource& source, std::size_t end, RowWindow& window) {
  window.extend((end + kTile - 1) / kTile * kTile, [&source, &window](IndexRange faces, std::size_t) {
    WriteRows(source, faces, window.row(faces.first));
  });
}

// Twice as many rows. Every face stays where it is or moves into the new half.
void GrowWindow(RowWindow& window) {
  for (std::size_t f = window.begin; f < window.end; ++f) {
    if ((f & window.capacity) == 0) continue;
    std::copy_n(window.row(f), RowWindow::kRow, window.row(f) + window.capacity * RowWindow::kRow);
  }
  window.capacity *= 2;
}

// Where the faces of a list are: before the window, in it, up to `step` after it, and further on. Roughly: some may be
// counted twice.
struct Reach {
  std::size_t late = 0, hits = 0, early = 0;
  std::size_t near_end = 0, far_end = 0;  // behind the last of those after the window
};

Reach CountFaces(FaceList list, const RowWindow& window, std::size_t step) {
  Reach reach;
  const IndexTag tag;
  const auto number = [&tag](std::size_t n) HWY_ATTR { return hn::Set(tag, static_cast<std::uint32_t>(n)); };
  const auto begin = number(window.begin), end = number(window.end), near_end = number(window.end + step);
  const auto far_end = number(window.end + RowWindow::kLargest / 2);
  auto last_near = hn::Zero(tag), last_far = hn::Zero(tag);
  for (std::size_t i = 0; i + kLanes <= list.count; i += kLanes) {
    // The last vector overlaps the one before.
    const auto f = hn::LoadU(tag, list.faces + (i + 2 * kLanes > list.count ? list.count - kLanes : i));
    const auto is_late = hn::Lt(f, begin), is_far = hn::AndNot(hn::Lt(f, near_end), hn::Lt(f, far_end));
    reach.late += hn::CountTrue(tag, is_late);
    reach.hits += hn::CountTrue(tag, hn::AndNot(is_late, hn::Lt(f, end)));
    reach.early += hn::CountTrue(tag, is_far);
    last_near = hn::Max(last_near, hn::IfThenElseZero(hn::Lt(f, near_end), f));
    last_far = hn::Max(last_far, hn::IfThenElseZero(is_far, f));
  }
  reach.near_end = std::max(window.end, std::size_t{hn::GetLane(hn::MaxOfLanes(tag, last_near))} + 1);
  reach.far_end = std::max(window.end, std::size_t{hn::GetLane(hn::MaxOfLanes(tag, last_far))} + 1);
  return reach;
}

// Brings the window to where the faces of a tile are, as far as that pays. Whether all of them are in it.
HWY_INLINE bool MoveWindow(const FaceSource& source, FaceList list, RowWindow& window) {
  const IndexRange needed = RangeOf(list.faces, list.count);
  const std::size_t start = needed.first / kTile * kTile;
  if (window.is_empty()) window.start_at(start);
  const std::size_t step = 2 * list.count + 4 * kTile;  // pays for itself at once
  if (needed.first >= window.begin && needed.end() <= window.end + step) {
    FillWindow(source, needed.end(), window);
    return needed.first >= window.begin;
  }

  // Faces out of reach: count them, and go there once they have cost as much as the way.
  constexpr std::size_t kCostOfOne = 4;  // against that of the next in line
  const Reach reach = CountFaces(list, window, step);
  window.late += reach.late;
  window.early += reach.early;
  window.strange = reach.hits > 0 ? 0 : window.strange + list.count;
  std::size_t fill_end = reach.near_end;
  if (reach.early > 0 && kCostOfOne * window.early >= reach.far_end - window.end) {
    while (window.capacity < std::min(2 * (reach.far_end - window.end), window.largest)) GrowWindow(window);
    fill_end = reach.far_end;
    window.early = 0;
  }
  if (kCostOfOne * window.late >= window.capacity) {
    if (window.capacity < window.largest) GrowWindow(window);
    window.late = 0;
  }
  if (fill_end > window.end) {
    FillWindow(source, fill_end, window);
  } else if (window.strange >= RowWindow::kSmallest) {
    window.start_at(start);
    window.strange = 0;
  }
  return false;
}

// The faces of a list that are not in the window, in order.
class MissedFaces {
 public:
  // end: of the lists of all elements, which lie one after the other.
  MissedFaces(const FaceSource& source, const RowWindow& window, FaceList list, const std::uint32_t* end)
      : source_(source), window_(window), list_(list), end_(end) {}

  // The row of the next one.
  HWY_INLINE const double* Next() {
    if (next_ == count_) Compute();
    return rows_ + RowWindow::kRow * next_++;
  }

 private:
  static constexpr std::size_t kMost = 8 * kTile;

  HWY_NOINLINE void Compute() {
    std::uint32_t missed[kMost];
    count_ = next_ = 0;
    for (; at_ < list_.count && count_ < kMost; ++at_) {
      missed[count_] = list_.faces[at_];
      count_ += static_cast<std::size_t>(list_.faces[at_] - window_.begin >= window_.end - window_.begin);
    }
    ExactTile exact;
    for (std::size_t first = 0; first < count_; first += kTile) {
      if (source_.segment.topology->all_triangles()) {
        PrefetchAfter(list_.faces + first);
        SomeTriangles(missed + first, std::min(kTile, count_ - first), exact);
      } else {
        for (std::size_t i = 0; i < kTile; ++i)
          set_polygon(source_.segment, missed[std::min(first + i, count_ - 1)], i, exact);
      }
      StoreRows<RowWindow::kRow>(exact, rows_ + first * RowWindow::kRow);
    }
  }

  HWY_INLINE const std::uint32_t* CornersOf(std::uint32_t face) const {
    return source_.segment.topology->corners().data() + 3 * std::size_t{face};
  }

  // Nothing is where the face before was: asks for the corners of faces that come later, and for the positions of
  // those that come sooner.
  HWY_INLINE void PrefetchAfter(const std::uint32_t* faces) const {
    constexpr std::size_t kPoints = 6 * kTile, kCorners = 14 * kTile;
    if (!source_.rows || end_ - faces < static_cast<std::ptrdiff_t>(kCorners + kTile)) return;
    for (std::size_t i = 0; i < kTile; ++i) {
      hwy::Prefetch(CornersOf(faces[kCorners + i]));
      PrefetchPoints(source_.segment, CornersOf(faces[kPoints + i]), 3);
    }
  }

  HWY_INLINE void SomeTriangles(const std::uint32_t* faces, std::size_t count, ExactTile& exact) const {
    std::uint32_t corners[3 * kTile];
    for (std::size_t i = 0; i < kTile; ++i) std::copy_n(CornersOf(faces[std::min(i, count - 1)]), 3, corners + 3 * i);
    TriangleTile(source_.segment, source_.rows, corners, exact);
  }

  const FaceSource& source_;
  const RowWindow& window_;
  FaceList list_;
  const std::uint32_t* end_;
  std::size_t at_ = 0, next_ = 0, count_ = 0;
  alignas(64) double rows_[kMost * RowWindow::kRow];
};

FaceList FacesOf(const NormalGroups& groups, std::size_t first, std::size_t count) {
  const auto last = groups.faces(first + count - 1);
  const std::uint32_t* const faces = groups.faces(first).data();
  return {faces, static_cast<std::size_t>(last.data() + last.size() - faces)};
}

// Prefetches the rows of the faces that the tile after next may need.
HWY_INLINE void PrefetchRows(FaceList list, const std::uint32_t* end, const RowWindow& window) {
  if (end - list.faces < static_cast<std::ptrdiff_t>(3 * list.count)) return;
  const std::uint32_t* const ahead = list.faces + 2 * list.count;
  for (std::size_t i = 0; i < list.count; ++i) {
    const double* const row = window.row(ahead[i]);
    hwy::Prefetch(row);
    hwy::Prefetch(row + 8);
  }
}

// ---- tiles ---------------------------------------------------------------------------------------------------------

// Sums of the elements first ... first + count - 1; row(f) gives the row of face f, called in the order of the corners.
template <class RowOf>
HWY_INLINE void SumElements(const NormalGroups& groups, std::size_t first, std::size_t count, SumRows& sums,
                            const RowOf& row) {
  for (std::size_t i = 0; i < count; ++i) {
    RowSum sum;
    sum.Clear();
    for (const std::uint32_t f : groups.faces(first + i)) sum.Add(row(f));
    sum.Store(sums.rows[i]);
  }
}

void GroupTilesOf(const Segment& segment, const NormalGroups& groups, RowWindow& window, IndexRange elements,
                  ControlTile* tiles) {
  const FaceSource source = SourceOf(segment);
  const auto last_faces = groups.faces(groups.size() - 1);
  const std::uint32_t* const all_faces_end = last_faces.data() + last_faces.size();
  SumRows sums = {};
  for (std::size_t first = elements.first; first < elements.end(); first += kTile) {
    ControlTile& tile = *tiles++;
    const std::size_t count = std::min(kTile, elements.end() - first);
    const FaceList list = FacesOf(groups, first, count);
    const double* const rows = window.rows;
    if (window.capacity > RowWindow::kLargest) PrefetchRows(list, all_faces_end, window);
    if (list.count == 0 || MoveWindow(source, list, window)) {
      const std::size_t mask = window.capacity - 1;
      SumElements(groups, first, count, sums,
                  [=](std::uint32_t f) HWY_ATTR { return rows + (f & mask) * RowWindow::kRow; });
    } else {
      MissedFaces missed(source, window, list, all_faces_end);
      const std::size_t begin = window.begin, size = window.end - begin, mask = window.capacity - 1;
      SumElements(groups, first, count, sums, [&](std::uint32_t f) HWY_ATTR {
        return f - begin < size ? rows + (f & mask) * RowWindow::kRow : missed.Next();
      });
    }
    for (std::size_t i = count; i < kTile; ++i) std::copy_n(sums.rows[count - 1], kSumRow, sums.rows[i]);

    std::uint32_t doubtful = RoundSums(sums, tile);
    if (HWY_UNLIKELY(list.count > kMostFaces)) {
      for (std::size_t i = 0; i < kTile; ++i) {
        if (groups.faces(first + std::min(i, count - 1)).size() <= kMostFaces) continue;
        doubtful |= 1u << i;
        // Whoever reads the tile shall not trust it either.
        tile.magnitude[i] = std::numeric_limits<float>::infinity();
      }
    }
    if (HWY_UNLIKELY(doubtful != 0)) {
      for (std::size_t i = 0; i < kTile; ++i) {
        if ((doubtful >> i & 1) != 0)
          set_sum_without_rounding(segment, groups, first + std::min(i, count - 1), i, sums, tile);
      }
    }
    if (!SetDegreesByFloats(tile)) SetDegreesOfSums(sums, tile);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(GroupTilesOf);
HWY_EXPORT(FaceRows);

void set_sum_without_rounding(const Segment& segment, const NormalGroups& groups, std::size_t element, std::size_t lane,
                              SumRows& sums, ControlTile& tile) noexcept {
  const auto [n0, m, n1] = control_normals_of_group(segment, groups, element).normals;
  std::size_t k = 0;
  for (const Vec3d& v : {n0, m, n1}) {
    for (const double component : {v.x, v.y, v.z}) {
      sums.rows[lane][k] = component;
      tile.normals[k++][lane] = static_cast<float>(component);
    }
  }
}

AllFaceRows::AllFaceRows(std::size_t face_count) : rows_((face_count + kTile - 1) / kTile * kTile * RowWindow::kRow) {}

void AllFaceRows::write(const Segment& segment, IndexRange faces) noexcept {
  assert(faces.first % kTile == 0 && faces.end() <= segment.topology->face_count());
  HWY_DYNAMIC_DISPATCH(FaceRows)(segment, faces, rows_.data() + faces.first * RowWindow::kRow);
}

GroupTiles::GroupTiles(const Segment& segment, const NormalGroups& groups, const AllFaceRows* all_rows)
    : segment_(segment), groups_(&groups) {
  if (all_rows == nullptr) {
    // No more than there are faces: a small mesh should not have to ask the system for pages.
    const std::size_t all = std::bit_ceil(segment.topology->face_count());
    window_.largest = std::clamp(all, RowWindow::kSmallest, RowWindow::kLargest);
    rows_ = AlignedArray<double>(window_.largest * RowWindow::kRow);
    window_.rows = rows_.data();
  } else {
    window_.rows = all_rows->data();
    window_.end = (segment.topology->face_count() + kTile - 1) / kTile * kTile;
    window_.capacity = std::bit_ceil(window_.end);
  }
}

void GroupTiles::write(IndexRange elements, std::span<ControlTile> tiles) noexcept {
  assert(elements.count > 0 && elements.end() <= groups_->size());
  assert(tiles.size() == (elements.count + kTile - 1) / kTile);
  HWY_DYNAMIC_DISPATCH(GroupTilesOf)(segment_, *groups_, window_, elements, tiles.data());
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
