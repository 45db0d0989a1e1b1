/// Three-component vectors over any scalar.
///
/// Vec3f holds data (positions, results), and Vec3d holds values that need precision (control normals while they are
/// computed, angles). The scalar is a template parameter, so that the same code can also be instantiated with a scalar
/// that counts operations (schemes/scheme.h reports the counts).
///
/// Everything is written as single additions and multiplications in a fixed order, so that every compiler gives the
/// same bits (with -ffp-contract=off, which the build sets).
#ifndef CHRONORMAL_CORE_VEC3_H_
#define CHRONORMAL_CORE_VEC3_H_

#include <cmath>

namespace chronormal {

template <class S>
struct Vec3 {
  S x{}, y{}, z{};

  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(const S& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend bool operator==(const Vec3& a, const Vec3& b) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class S>
[[nodiscard]] constexpr S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class S>
[[nodiscard]] constexpr Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Returns (1 - t) a + t b: a at t = 0, b at t = 1, and the points of the line between them.
template <class S>
[[nodiscard]] constexpr Vec3<S> lerp(const Vec3<S>& a, const Vec3<S>& b, const S& t) {
  return (S(1) - t) * a + t * b;
}

[[nodiscard]] constexpr Vec3d to_double(const Vec3f& a) { return {a.x, a.y, a.z}; }
[[nodiscard]] constexpr Vec3f to_float(const Vec3d& a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

/// Returns the larger of two numbers, or the other number if one of them is NaN. The result is that of std::fmax, but
/// takes two instructions instead of a call.
[[nodiscard]] inline double maximum_number(double a, double b) noexcept {
  const double larger = b > a ? b : a;  // a if either number is NaN
  if (larger == larger) [[likely]]
    return larger;
  return b;
}

/// Returns the largest absolute component, a measure of length that neither overflows nor underflows.
[[nodiscard]] inline double max_abs(const Vec3d& a) noexcept {
  const double x = std::fabs(a.x), y = std::fabs(a.y), z = std::fabs(a.z);
  const double of_two = y > x ? y : x;
  const double largest = z > of_two ? z : of_two;  // x if x is NaN
  if (largest == largest) [[likely]]
    return largest;
  return maximum_number(y, z);
}

/// Returns true if no component is infinite or NaN.
[[nodiscard]] inline bool is_finite(const Vec3d& a) noexcept {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Returns the length of a. Intermediate results neither overflow nor underflow.
[[nodiscard]] inline double length(const Vec3d& a) noexcept {
  const double scale = max_abs(a);
  if (scale == 0) return 0;
  const Vec3d b{a.x / scale, a.y / scale, a.z / scale};
  return scale * std::sqrt(dot(b, b));
}

/// Scales a to length 1, and returns (0, 0, 0) for the zero vector. Divides by the largest component first, so that
/// vectors of any finite length are scaled correctly.
[[nodiscard]] inline Vec3d unit(const Vec3d& a) noexcept {
  const double scale = max_abs(a);
  if (scale == 0) return {};
  const Vec3d b{a.x / scale, a.y / scale, a.z / scale};
  return (1 / std::sqrt(dot(b, b))) * b;
}

/// Returns a unit vector perpendicular to the unit vector u, always the same for the same u.
[[nodiscard]] inline Vec3d any_perpendicular(const Vec3d& u) noexcept {
  const double x = std::fabs(u.x), y = std::fabs(u.y), z = std::fabs(u.z);
  if (x <= y && x <= z) return unit(cross(u, Vec3d{1, 0, 0}));
  if (y <= z) return unit(cross(u, Vec3d{0, 1, 0}));
  return unit(cross(u, Vec3d{0, 0, 1}));
}

/// Degrees per radian. Angles are in radians; only output for people is in degrees.
inline constexpr double kDegreesPerRadian = 57.295779513082320877;

/// Returns the angle between two vectors in radians, in [0, pi], or 0 if one of the vectors is zero. Uses atan2, since
/// acos loses all angles below 1e-8 in double and below 3e-4 in float. The bits are the same on every machine.
[[nodiscard]] double angle_between(const Vec3d& a, const Vec3d& b) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_VEC3_H_
