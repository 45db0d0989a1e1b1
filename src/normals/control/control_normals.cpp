#include "chronormal/normals/control_normals.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "chronormal/core/polynomial.h"
#include "normals/control/kernels/face_tiles.h"
#include "normals/control/polygon_normals.h"

namespace chronormal {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Rounding of a cross product of rounded edges stays below 2 eps of the sum of its products; twice that for safety.
constexpr double kProductNoise = 4 * kEpsilon;

// The error of eq. 5 in double: see "n(t) counts as zero" in the header.
constexpr double kEvaluationNoise = 8 * kEpsilon;

// A cross product, and per component the sum of the absolute products that it was made of.
struct TrackedSum {
  Vec3d value, magnitude;

  void add_cross(const Vec3d& a, const Vec3d& b) {
    value = value + cross(a, b);
    const Vec3d p{std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)};
    const Vec3d q{std::fabs(b.x), std::fabs(b.y), std::fabs(b.z)};
    magnitude = magnitude + Vec3d{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
  }

  // The sum with components that are nothing but rounding set to zero; `terms` cross products were added.
  [[nodiscard]] Vec3d without_noise(std::size_t terms) const {
    const double noise = kProductNoise * static_cast<double>(terms);
    const auto keep = [noise](double v, double m) { return std::fabs(v) <= noise * m ? 0.0 : v; };
    return {keep(value.x, magnitude.x), keep(value.y, magnitude.y), keep(value.z, magnitude.z)};
  }
};

}  // namespace

PolygonNormals polygon_control_normals(const Segment& segment, std::span<const std::uint32_t> face) noexcept {
  TrackedSum n0, m, n1;
  const Vec3d a0 = to_double(segment.from[face[0]]), a1 = to_double(segment.to[face[0]]);
  Vec3d e0 = to_double(segment.from[face[1]]) - a0, e1 = to_double(segment.to[face[1]]) - a1;
  for (std::size_t c = 2; c < face.size(); ++c) {
    const Vec3d f0 = to_double(segment.from[face[c]]) - a0, f1 = to_double(segment.to[face[c]]) - a1;
    n0.add_cross(e0, f0);
    n1.add_cross(e1, f1);
    m.add_cross(e0, f1);
    m.add_cross(e1, f0);
    e0 = f0;
    e1 = f1;
  }
  const std::size_t triangles = face.size() - 2;
  return {{n0.without_noise(triangles), 0.5 * m.without_noise(2 * triangles), n1.without_noise(triangles)},
          std::fmax(max_abs(n0.magnitude), std::fmax(max_abs(m.magnitude), max_abs(n1.magnitude)))};
}

void face_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  // A kernel starts with a block of faces; for one alone it does not pay.
  constexpr std::size_t kFewest = 4;
  if (segment.topology->all_triangles() && faces.count >= kFewest) {
    triangle_control_normals(segment, faces, result);
    return;
  }
  for (std::size_t i = 0; i < faces.count; ++i)
    result[i] = polygon_control_normals(segment, segment.topology->face(faces.first + i)).normals;
}

int degree(const ControlNormals& normals) noexcept {
  const auto& [n0, m, n1] = normals;
  const double size = std::fmax(max_abs(n0), std::fmax(max_abs(m), max_abs(n1)));
  const double tolerance = kDegreeTolerance * size;
  if (max_abs((n0 - m) + (n1 - m)) > tolerance) return 2;
  if (max_abs(n1 - n0) > tolerance) return 1;
  return 0;
}

Vec3d normal_at(const ControlNormals& normals, double t) noexcept {
  const double s = 1 - t;
  return (s * s) * normals.n0 + (2 * t * s) * normals.m + (t * t) * normals.n1;
}

UnitNormal unit_normal_at(const ControlNormals& normals, double t) noexcept {
  const auto& [n0, m, n1] = normals;
  const double s = 1 - t;
  const Vec3d n = normal_at(normals, t);
  const double size = s * s * max_abs(n0) + 2 * t * s * max_abs(m) + t * t * max_abs(n1);
  if (max_abs(n) > kEvaluationNoise * size) return {unit(n), Direction::kRegular};

  // n(t) = 0: near t the curve is (x - t) n'(t) + (x - t)^2 c2.
  const double largest = std::fmax(max_abs(n0), std::fmax(max_abs(m), max_abs(n1)));
  const Vec3d half_derivative = s * (m - n0) + t * (n1 - m);
  if (max_abs(half_derivative) > kEvaluationNoise * largest) {
    if (t <= 0) return {unit(half_derivative), Direction::kLimit};
    return {unit(-half_derivative), t >= 1 ? Direction::kLimit : Direction::kDiscontinuous};
  }
  const Vec3d c2 = (n0 - m) + (n1 - m);
  if (max_abs(c2) > kEvaluationNoise * largest) return {unit(c2), Direction::kLimit};
  return {{}, Direction::kNone};
}

}  // namespace chronormal
