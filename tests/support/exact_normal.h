/// Computes normals of moving triangles in rational numbers, without any rounding.
///
/// Floats and doubles are rational numbers, and normals are polynomials in the coordinates, so n(t) and the control
/// normals are rational, too. Only the conversion of an angle to double rounds.
#ifndef CHRONORMAL_TESTS_SUPPORT_EXACT_NORMAL_H_
#define CHRONORMAL_TESTS_SUPPORT_EXACT_NORMAL_H_

#include <gmpxx.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace chronormal::exact {

using Rational = mpq_class;
using Vector = std::array<Rational, 3>;

/// A triangle with its corners a, b, c at t = 0 and at t = 1.
struct Triangle {
  std::array<Vector, 3> from;
  std::array<Vector, 3> to;
};

struct ControlNormals {
  Vector n0, m, n1;
};

/// Converts three finite floats or doubles exactly. Infinity and NaN have no rational value, so GMP would divide by
/// zero.
template <class S>
[[nodiscard]] Vector vector(S x, S y, S z) {
  return {Rational(static_cast<double>(x)), Rational(static_cast<double>(y)), Rational(static_cast<double>(z))};
}

[[nodiscard]] inline Vector subtract(const Vector& a, const Vector& b) {
  return {Rational(a[0] - b[0]), Rational(a[1] - b[1]), Rational(a[2] - b[2])};
}

[[nodiscard]] inline Vector cross(const Vector& a, const Vector& b) {
  return {Rational(a[1] * b[2] - a[2] * b[1]), Rational(a[2] * b[0] - a[0] * b[2]),
          Rational(a[0] * b[1] - a[1] * b[0])};
}

[[nodiscard]] inline Rational dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Returns the largest absolute value of a component.
[[nodiscard]] inline Rational max_abs(const Vector& a) {
  Rational largest = 0;
  for (const Rational& component : a) {
    if (abs(component) > largest) largest = abs(component);
  }
  return largest;
}

[[nodiscard]] inline bool is_zero(const Vector& a) { return max_abs(a) == 0; }

/// Returns n(t) by eq. 1 of docs/theory.md, from the corners at t. The time may be any rational number.
[[nodiscard]] inline Vector normal_at(const Triangle& triangle, const Rational& time) {
  std::array<Vector, 3> corner;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      corner[i][k] = triangle.from[i][k] + time * (triangle.to[i][k] - triangle.from[i][k]);
    }
  }
  return cross(subtract(corner[1], corner[0]), subtract(corner[2], corner[0]));
}

/// Returns the sum of n(t) over some triangles of a chronormal::Segment.
template <class SegmentOfMesh, class Faces>
[[nodiscard]] Vector sum_of_faces_at(const SegmentOfMesh& segment, const Faces& faces, const Rational& time) {
  Vector sum;
  for (const auto f : faces) {
    Triangle triangle;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto a = segment.from[segment.topology->face(f)[c]], b = segment.to[segment.topology->face(f)[c]];
      triangle.from[c] = vector(a.x, a.y, a.z);
      triangle.to[c] = vector(b.x, b.y, b.z);
    }
    const Vector n = normal_at(triangle, time);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += n[k];
  }
  return sum;
}

[[nodiscard]] inline Vector normal_at(const Triangle& triangle, double t) { return normal_at(triangle, Rational(t)); }

/// Returns n(t) from control normals, by eq. 5 of docs/theory.md.
[[nodiscard]] inline Vector normal_at(const ControlNormals& normals, double t) {
  const Rational time(t), rest = 1 - time;
  const Rational w0 = rest * rest, wm = 2 * time * rest, w1 = time * time;
  Vector sum;
  for (std::size_t k = 0; k < 3; ++k) sum[k] = w0 * normals.n0[k] + wm * normals.m[k] + w1 * normals.n1[k];
  return sum;
}

/// Returns n0, m and n1 without using the formula for m: n0 and n1 are the normals at the ends, and m is such that the
/// quadratic passes through the normal at t = 1/2.
[[nodiscard]] inline ControlNormals control_normals(const Triangle& triangle) {
  ControlNormals result{normal_at(triangle, 0.0), {}, normal_at(triangle, 1.0)};
  const Vector half = normal_at(triangle, 0.5);
  for (std::size_t k = 0; k < 3; ++k) result.m[k] = 2 * half[k] - (result.n0[k] + result.n1[k]) / 2;
  return result;
}

/// Returns the largest absolute value of a component of the three control normals.
[[nodiscard]] inline Rational max_abs(const ControlNormals& normals) {
  Rational largest = max_abs(normals.n0);
  for (const Vector* v : {&normals.m, &normals.n1}) {
    const Rational other = max_abs(*v);
    if (other > largest) largest = other;
  }
  return largest;
}

/// Returns a / b as a double. Only this conversion rounds. b must not be zero.
[[nodiscard]] inline double ratio(const Rational& a, const Rational& b) { return Rational(a / b).get_d(); }

/// Returns the angle in radians between the direction (x, y, z) and an exact vector. Even tiny angles have a relative
/// error of only 1e-15, because the cross product and the dot product are exact, and are divided by exact scales before
/// they are rounded to double. Returns NaN if one of the vectors is zero or the direction is not finite.
template <class S>
[[nodiscard]] double angle(S x, S y, S z, const Vector& exact) {
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) return std::nan("");
  const Vector candidate = vector(x, y, z);
  const Rational scale = max_abs(candidate) * max_abs(exact);
  if (scale == 0) return std::nan("");
  const Vector sine = cross(candidate, exact);
  const double sx = ratio(sine[0], scale), sy = ratio(sine[1], scale), sz = ratio(sine[2], scale);
  return std::atan2(std::sqrt(sx * sx + sy * sy + sz * sz), ratio(dot(candidate, exact), scale));
}

}  // namespace chronormal::exact

#endif  // CHRONORMAL_TESTS_SUPPORT_EXACT_NORMAL_H_
