// Computes the control normals of sixteen triangles in lanes of double.
#include "normals/control/kernels/exact_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rounding.h"
#include "normals/control/polygon_normals.h"

namespace chronormal::inline internal {
namespace {

void set_normals(const ControlNormals& c, std::size_t lane, ExactTile& tile) noexcept {
  std::size_t k = 0;
  for (const Vec3d& v : {c.n0, c.m, c.n1}) {
    tile.normals[k++][lane] = v.x;
    tile.normals[k++][lane] = v.y;
    tile.normals[k++][lane] = v.z;
  }
}

}  // namespace

float magnitude_above(double magnitude) noexcept {
  if (magnitude == 0) return 0;
  return std::max(static_cast<float>(magnitude * (1 + 0x1p-20)), std::numeric_limits<float>::min());
}

void put(BoundedTile& tile, std::size_t lane, const BoundedNormals& c) noexcept {
  set_normals(c.normals, lane, tile);
  for (std::size_t k = 0; k < c.errors.size(); ++k) tile.errors[k][lane] = c.errors[k];
}

void set_polygon(const Segment& segment, std::size_t face, std::size_t lane, ExactTile& tile) noexcept {
  const PolygonNormals polygon = polygon_control_normals(segment, segment.topology->face(face));
  set_normals(polygon.normals, lane, tile);
  // The fan of a polygon has more roundings than a triangle, so the magnitude of the polygon is raised until it covers
  // the errors of the fan.
  tile.magnitude[lane] = magnitude_above(maximum_number(
      polygon.magnitude, *std::max_element(polygon.errors.begin(), polygon.errors.end()) / (12 * kUnitRoundoff)));
}

void set_without_rounding(const Segment& segment, const std::uint32_t* corners, std::size_t lane,
                          ExactTile& tile) noexcept {
  const PolygonNormals triangle = polygon_control_normals(segment, {corners, 3});
  set_normals(triangle.normals, lane, tile);
  if (!std::isfinite(tile.magnitude[lane])) tile.magnitude[lane] = magnitude_above(triangle.magnitude);
}

}  // namespace chronormal::inline internal
