#include "chronormal/normals/control_normals.h"

#include <cassert>
#include <cmath>

#include "core/portable_math.h"

namespace chronormal {
namespace {

// The angle in radians below which slerp and lerp agree to the last bit of double.
constexpr double kSmallAngle = 1e-8;

using Quaternion = std::array<double, 4>;

double dot4(const Quaternion& a, const Quaternion& b) {
  return a[0] * b[0] + a[1] * b[1] + (a[2] * b[2] + a[3] * b[3]);
}

Quaternion weighted_sum(double s, const Quaternion& a, double t, const Quaternion& b) {
  Quaternion result;
  for (std::size_t i = 0; i < 4; ++i) result[i] = s * a[i] + t * b[i];
  return result;
}

Quaternion normalised(const Quaternion& q) { return weighted_sum(1 / std::sqrt(dot4(q, q)), q, 0, q); }

Quaternion slerp(const Quaternion& from, Quaternion to, double t) {
  if (dot4(from, to) < 0) to = weighted_sum(-1, to, 0, to);
  // Computing the angle from chord and diagonal, and not from a dot product, keeps the digits of small angles.
  const Quaternion chord = weighted_sum(1, to, -1, from), diagonal = weighted_sum(1, to, 1, from);
  const double angle = 2 * portable::atan2(std::sqrt(dot4(chord, chord)), std::sqrt(dot4(diagonal, diagonal)));
  if (angle < kSmallAngle) return normalised(weighted_sum(1 - t, from, t, to));
  return normalised(weighted_sum(portable::sin((1 - t) * angle), from, portable::sin(t * angle), to));
}

}  // namespace

AffineTransform composed(const AffineTransform& second, const AffineTransform& first) noexcept {
  AffineTransform result;
  for (std::size_t i = 0; i < 3; ++i) result.columns[i] = second(first.columns[i]) - second.offset;
  result.offset = second(first.offset);
  return result;
}

AffineTransform affine_transform(const NodeTransform& node) noexcept {
  const auto [x, y, z, w] = node.rotation;
  AffineTransform result;
  result.columns[0] = node.scale.x * Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  result.columns[1] = node.scale.y * Vec3d{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  result.columns[2] = node.scale.z * Vec3d{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  result.offset = node.translation;
  return result;
}

NodeTransform interpolated(const NodeTransform& from, const NodeTransform& to, double t) noexcept {
  return {lerp(from.translation, to.translation, t), slerp(from.rotation, to.rotation, t),
          lerp(from.scale, to.scale, t)};
}

NormalMatrix normal_matrix(const AffineTransform& transform) noexcept {
  const auto& [a, b, c] = transform.columns;
  NormalMatrix matrix{{cross(b, c), cross(c, a), cross(a, b)}, false};
  matrix.mirrored = dot(a, matrix.columns[0]) < 0;
  if (matrix.mirrored) {
    for (Vec3d& column : matrix.columns) column = -column;
  }
  return matrix;
}

ControlNormals transformed(const NormalMatrix& matrix, const ControlNormals& normals) noexcept {
  return {matrix(normals.n0), matrix(normals.m), matrix(normals.n1)};
}

std::size_t transform_unit_normals(const NormalMatrix& matrix, VectorView<const float> normals,
                                   VectorView<float> result) noexcept {
  assert(result.count == normals.count);
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < normals.count; ++i) {
    const Vec3d n = unit(matrix(to_double(normals[i])));
    if (n == Vec3d{}) ++zeros;
    result.set(i, to_float(n));
  }
  return zeros;
}

Vec3d turned(const Vec3d& from, const Vec3d& to, const Vec3d& v) noexcept {
  const Vec3d sine = cross(from, to);
  const double cosine = dot(from, to);
  const Vec3d axis = unit(sine);
  // If the two vectors are opposite up to rounding, the rotation is half a turn about any axis perpendicular to them.
  constexpr double kOpposite = 1e-12;
  if (cosine < 0 && max_abs(sine) < kOpposite) {
    const Vec3d across = any_perpendicular(from);
    return (2 * dot(across, v)) * across - v;
  }
  return cosine * v + cross(sine, v) + ((1 - cosine) * dot(axis, v)) * axis;
}

}  // namespace chronormal
