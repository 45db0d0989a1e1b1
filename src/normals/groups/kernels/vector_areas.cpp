// Computes the vector areas of triangles, a few at a time, one per lane. Adds up the areas around elements, one element
// after the other. A row of four doubles is kept in as few registers as possible.
#include "normals/groups/kernels/vector_areas.h"

#include <algorithm>
#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/groups/kernels/vector_areas.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "core/rounding.h"
#include "simd/double_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Returns `value`, or 0 in lanes in which its absolute value is not above the error.
template <class V>
HWY_INLINE V WithoutRounding(V value, V error) {
  return hn::IfThenElseZero(hn::Gt(hn::Abs(value), error), value);
}

// Returns one component of e x f from its two products. Returns 0 if the component may be only rounding error.
HWY_INLINE Doubles ComponentOfArea(Doubles product, Doubles other) {
  const Doubles magnitude = hn::Add(hn::Abs(product), hn::Abs(other));
  return WithoutRounding(hn::Sub(product, other), hn::Mul(hn::Set(kDoubles, 8 * kUnitRoundoff), magnitude));
}

void TriangleAreas(const double* points, std::span<const std::uint32_t> corners, double* areas) {
  const std::size_t count = corners.size() / 3;
  for (std::size_t f = 0; f < count; f += kDoubleLanes) {
    // Lanes after the last triangle repeat the last triangle.
    const auto corner = [&](std::size_t c) HWY_ATTR {
      return ColumnsOfDoubles([&](std::size_t i)
                                  HWY_ATTR { return points + kAreaRow * corners[3 * std::min(f + i, count - 1) + c]; })
          .xyz;
    };
    const Doubles3 a = corner(0), e = corner(1) - a, g = corner(2) - a;
    const Doubles x = ComponentOfArea(hn::Mul(e.y, g.z), hn::Mul(e.z, g.y)),
                  y = ComponentOfArea(hn::Mul(e.z, g.x), hn::Mul(e.x, g.z)),
                  z = ComponentOfArea(hn::Mul(e.x, g.y), hn::Mul(e.y, g.x));
    alignas(64) double planes[3][kDoubleLanes];
    hn::Store(x, kDoubles, planes[0]);
    hn::Store(y, kDoubles, planes[1]);
    hn::Store(z, kDoubles, planes[2]);
    for (std::size_t i = 0; i < std::min(kDoubleLanes, count - f); ++i, areas += kAreaRow) {
      areas[0] = planes[0][i];
      areas[1] = planes[1][i];
      areas[2] = planes[2][i];
      areas[3] = 0;
    }
  }
}

void SumsOfAreas(const double* areas, std::size_t first_face, const NormalGroups& groups, IndexRange elements,
                 Vec3d* sums) {
  const DoubleRowTag row_tag;
  const DoubleRow nothing = MakeRow([=](std::size_t) HWY_ATTR { return hn::Zero(row_tag); });
  for (std::size_t e = elements.first; e < elements.end(); ++e) {
    const std::span<const std::uint32_t> faces = groups.faces(e);
    DoubleRow value = nothing, magnitude = nothing;
    for (const std::uint32_t f : faces) {
      const DoubleRow area = LoadDoubleRow(areas + kAreaRow * (f - first_face));
      value = value + area;
      magnitude = magnitude + MakeRow([&area](std::size_t i) HWY_ATTR { return hn::Abs(area.parts[i]); });
    }
    const auto share = hn::Set(row_tag, 4 * kUnitRoundoff * static_cast<double>(faces.size()));
    const DoubleRow sum = MakeRow(
        [&](std::size_t i) HWY_ATTR { return WithoutRounding(value.parts[i], hn::Mul(share, magnitude.parts[i])); });
    alignas(64) double row[kAreaRow];
    StoreDoubleRow(sum, row);
    *sums++ = {row[0], row[1], row[2]};
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(TriangleAreas);
HWY_EXPORT(SumsOfAreas);

void triangle_areas(const double* points, std::span<const std::uint32_t> corners, double* areas) noexcept {
  assert(corners.size() % 3 == 0);
  HWY_DYNAMIC_DISPATCH(TriangleAreas)(points, corners, areas);
}

void sums_of_areas(const double* areas, std::size_t first_face, const NormalGroups& groups, IndexRange elements,
                   Vec3d* sums) noexcept {
  assert(elements.end() <= groups.size());
  HWY_DYNAMIC_DISPATCH(SumsOfAreas)(areas, first_face, groups, elements, sums);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
