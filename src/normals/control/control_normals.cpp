// Computes the control normals of faces, and evaluates them in double or, if that is not enough, in integers.
#include "chronormal/normals/control_normals.h"

#include <cassert>
#include <cmath>

#include "chronormal/core/polynomial.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "motion/segment_end.h"
#include "normals/control/exact_curve.h"
#include "normals/control/kernels/face_tiles.h"
#include "normals/control/local_time.h"
#include "normals/control/polygon_normals.h"

namespace chronormal {
namespace {

// The rounding error of n(t) by eq. 5 in double, relative to the sizes of the control normals: 8 rounding errors of
// 2^-52. n(t) counts as zero if no component is larger than this error (unit_normal_at() in the header).
constexpr double kEvaluationError = 16 * kUnitRoundoff;

// An edge from the first corner of a face, at both ends of the segment.
struct Edge {
  Vec3d from, to;
};

// Returns the direction at an end of the segment: the direction of the first nonzero control normal, counted from this
// end. No tolerance is needed, because n(t) is a control normal at both ends.
UnitNormal first_direction(const Vec3d& at_end, const Vec3d& middle, const Vec3d& other) noexcept {
  if (at_end != Vec3d{}) return {unit(at_end), Direction::kRegular};
  if (middle != Vec3d{}) return {unit(middle), Direction::kLimit};
  return {unit(other), other != Vec3d{} ? Direction::kLimit : Direction::kNone};
}

}  // namespace

inline namespace internal {
PolygonNormals polygon_control_normals(const Segment& segment, std::span<const std::uint32_t> face) noexcept {
  CrossSum n0, m, n1;
  const SegmentEnd from = SegmentEnd::from(segment), to = SegmentEnd::to(segment);
  const auto edge_to = [&](std::size_t c) { return Edge{from.edge(face[0], face[c]), to.edge(face[0], face[c])}; };
  for_fan(face.size(), edge_to, [&](const Edge& e, const Edge& f) {
    n0.add(e.from, f.from);
    n1.add(e.to, f.to);
    m.add(e.from, f.to);
    m.add(e.to, f.from);
  });
  PolygonNormals result;
  result.normals = {n0.without_rounding(), 0.5 * m.without_rounding(), n1.without_rounding()};
  result.errors = {n0.error(), 0.5 * m.error(), n1.error()};
  result.magnitude =
      maximum_number(max_abs(n0.magnitude()), maximum_number(max_abs(m.magnitude()), max_abs(n1.magnitude())));
  if (!(result.largest_share() <= kLargestRounding)) result.settle(ExactCurve::of_polygon(segment, face).rounded());
  return result;
}

}  // namespace internal

void face_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  // The smallest number of faces for which a kernel is faster than the scalar code, since a kernel always computes a
  // whole block of faces.
  constexpr std::size_t kFewest = 4;
  if (fits_lanes(segment) && faces.count >= kFewest) {
    triangle_control_normals(segment, faces, result);
    return;
  }
  for (std::size_t i = 0; i < faces.count; ++i)
    result[i] = polygon_control_normals(segment, segment.topology->face(faces.first + i)).normals;
}

int degree(const ControlNormals& normals) noexcept {
  const auto& [n0, m, n1] = normals;
  const double size = maximum_number(max_abs(n0), maximum_number(max_abs(m), max_abs(n1)));
  const double tolerance = kDegreeTolerance * size;
  if (max_abs((n0 - m) + (n1 - m)) > tolerance) return 2;
  if (max_abs(n1 - n0) > tolerance) return 1;
  return 0;
}

Vec3d normal_at(const ControlNormals& normals, double t) noexcept {
  const double s = 1 - t;
  return (s * s) * normals.n0 + (2 * t * s) * normals.m + (t * t) * normals.n1;
}

UnitNormal unit_normal_at(const ControlNormals& normals, double time) noexcept {
  const double t = local_time(time);
  if (std::isnan(t)) return {{}, Direction::kNone};
  const auto& [n0, m, n1] = normals;
  if (t == 0) return first_direction(n0, m, n1);
  if (t == 1) return first_direction(n1, m, n0);
  const double s = 1 - t;
  const Vec3d n = normal_at(normals, t);
  const double size = s * s * max_abs(n0) + 2 * t * s * max_abs(m) + t * t * max_abs(n1);
  if (max_abs(n) > kEvaluationError * size) return {unit(n), Direction::kRegular};

  // If n(t) = 0, the curve at a time x near t is (x - t) n'(t) + (x - t)^2 c2, where c2 = n0 - 2m + n1.
  const double largest = maximum_number(max_abs(n0), maximum_number(max_abs(m), max_abs(n1)));
  const Vec3d half_derivative = s * (m - n0) + t * (n1 - m);
  if (max_abs(half_derivative) > kEvaluationError * largest) {
    return {unit(-half_derivative), Direction::kDiscontinuous};
  }
  const Vec3d c2 = (n0 - m) + (n1 - m);
  if (max_abs(c2) > kEvaluationError * largest) return {unit(c2), Direction::kLimit};
  return {{}, Direction::kNone};
}

}  // namespace chronormal
