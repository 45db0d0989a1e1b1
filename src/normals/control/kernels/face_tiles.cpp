#include "normals/control/kernels/face_tiles.h"

#include <algorithm>
#include <cassert>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/control/kernels/face_tiles.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "normals/control/kernels/tile_degrees-inl.h"
#include "normals/control/kernels/triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE void RoundTile(const ExactTile& exact, ControlTile& tile) {
  for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
    hn::Store(hn::Load(kFloats, exact.magnitude + lane), kFloats, tile.magnitude + lane);
    for (std::size_t k = 0; k < 9; ++k) hn::Store(ToFloat(exact.normals[k] + lane), kFloats, tile.normals[k] + lane);
  }
  if (!SetDegreesByFloats(tile)) SetDegrees(exact, tile);
}

void FaceTiles(const Segment& segment, IndexRange faces, ControlTile* tiles) {
  const PointAccess access = AccessOf(segment);
  ExactTile exact;
  for (std::size_t f = faces.first; f < faces.end(); f += kTile) {
    FaceTile(segment, access, f, faces.end(), exact);
    RoundTile(exact, *tiles++);
  }
}

void EdgedFaceTiles(const Segment& segment, IndexRange faces, ControlTile* tiles, EdgedTile* exact) {
  const PointAccess access = AccessOf(segment);
  const bool has_edges = fits_lanes(segment);
  for (std::size_t f = faces.first; f < faces.end(); f += kTile, ++exact) {
    if (!has_edges) std::fill_n(exact->longest, kTile, std::numeric_limits<float>::infinity());
    FaceTile(segment, access, f, faces.end(), *exact, {.longest = exact->longest});
    RoundTile(*exact, *tiles++);
  }
}

void BoundedFaceTiles(const Segment& segment, IndexRange faces, ControlTile* tiles, BoundedTile* exact) {
  const PointAccess access = AccessOf(segment);
  for (std::size_t f = faces.first; f < faces.end(); f += kTile, ++exact) {
    FaceTile(segment, access, f, faces.end(), *exact, {.errors = exact->errors});
    RoundTile(*exact, *tiles++);
  }
}

void FloatFaceTiles(const Segment& segment, IndexRange faces, ControlTile* tiles) {
  const PointAccess access = AccessOf(segment);
  const Floats roundings = RoundingsInFloat(1);
  for (std::size_t f = faces.first; f < faces.end(); f += kTile) {
    ControlTile& tile = *tiles++;
    WithTriangles(segment, access, f, faces.end(), [&](auto known, const std::uint32_t* corners) HWY_ATTR {
      for (std::size_t lane = 0; lane < kTile; lane += kLanes) {
        const TriangleLanes p = LoadTriangles<known()>(segment, corners + 3 * lane);
        const Lanes3 e0 = p.b0 - p.a0, e1 = p.b1 - p.a1, f0 = p.c0 - p.a0, f1 = p.c1 - p.a1;
        const Lanes3 m = Scale(hn::Set(kFloats, 0.5f), Cross(e0, f1) + Cross(e1, f0));
        StoreInFloat({Cross(e0, f0), m, Cross(e1, f1)}, hn::Mul(roundings, MagnitudeAbove(p)), lane, tile);
      }
    });
  }
}

void TriangleControlNormals(const Segment& segment, IndexRange faces, double* result) {
  constexpr std::size_t kRow = 9;
  const PointAccess access = AccessOf(segment);
  ExactTile exact;
  for (std::size_t f = faces.first; f < faces.end(); f += kTile) {
    FaceTile(segment, access, f, faces.end(), exact);
    const std::size_t count = std::min(kTile, faces.end() - f);
    if (count == kTile) {
      StoreRows(exact, result);
    } else {
      alignas(64) double part[kTile * kRow];
      StoreRows(exact, part);
      std::copy_n(part, count * kRow, result);
    }
    result += count * kRow;
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(FaceTiles);
HWY_EXPORT(EdgedFaceTiles);
HWY_EXPORT(BoundedFaceTiles);
HWY_EXPORT(FloatFaceTiles);
HWY_EXPORT(TriangleControlNormals);

void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept {
  assert(faces.count > 0 && faces.end() <= segment.topology->face_count());
  assert(tiles.size() == (faces.count + kTile - 1) / kTile);
  HWY_DYNAMIC_DISPATCH(FaceTiles)(segment, faces, tiles.data());
}

void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<EdgedTile> exact) noexcept {
  assert(faces.count > 0 && faces.end() <= segment.topology->face_count());
  assert(tiles.size() == (faces.count + kTile - 1) / kTile && exact.size() == tiles.size());
  HWY_DYNAMIC_DISPATCH(EdgedFaceTiles)(segment, faces, tiles.data(), exact.data());
}

void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<BoundedTile> exact) noexcept {
  assert(segment.topology->all_triangles() && faces.count > 0 && faces.end() <= segment.topology->face_count());
  assert(tiles.size() == (faces.count + kTile - 1) / kTile && exact.size() == tiles.size());
  HWY_DYNAMIC_DISPATCH(BoundedFaceTiles)(segment, faces, tiles.data(), exact.data());
}

void float_triangle_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept {
  assert(segment.topology->all_triangles() && faces.count > 0 && faces.end() <= segment.topology->face_count());
  assert(tiles.size() == (faces.count + kTile - 1) / kTile);
  HWY_DYNAMIC_DISPATCH(FloatFaceTiles)(segment, faces, tiles.data());
}

void triangle_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept {
  static_assert(sizeof(ControlNormals) == 9 * sizeof(double));
  assert(segment.topology->all_triangles() && result.size() == faces.count);
  HWY_DYNAMIC_DISPATCH(TriangleControlNormals)(segment, faces, reinterpret_cast<double*>(result.data()));
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
