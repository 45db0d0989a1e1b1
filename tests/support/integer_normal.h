/// Computes normals of moving polygons at a time t by integer arithmetic of any size, fast enough for millions of
/// normals.
///
/// A float is an integer times 2^-149, and a double t is T 2^-e for an integer T. In units of 2^(-149 - e), a corner
/// that moves from p to q is at (2^e - T) p + T q, where p and q are integers. Cross products are therefore integers as
/// well. GMP computes with these integers, and only the direction of the result is rounded to double. exact_normal.h
/// computes the same normals in rational numbers, which takes a hundred times as long.
///
/// If n(t) = 0, the result is the direction of n slightly earlier or, at t = 0, slightly later. The time is changed by
/// at most 2^-1500 of the segment, so the first term of n that is not zero is far larger than all later terms.
#ifndef CHRONORMAL_TESTS_SUPPORT_INTEGER_NORMAL_H_
#define CHRONORMAL_TESTS_SUPPORT_INTEGER_NORMAL_H_

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"

namespace chronormal::test {

using IntegerVector = std::array<mpz_class, 3>;

/// An instant t = T 2^-e, where T is an integer of any size.
struct IntegerTime {
  mpz_class t;
  unsigned e = 0;

  [[nodiscard]] static IntegerTime of(double t) {
    int exponent = 0;
    const double mantissa = std::ldexp(std::frexp(t, &exponent), 53);
    const int e = 53 - exponent;  // t is at most 1, so e is positive
    return {mpz_class(mantissa), t == 0 ? 0 : static_cast<unsigned>(e)};
  }
  /// Returns an instant that is slightly earlier (if sign is -1) or later (if sign is 1).
  [[nodiscard]] IntegerTime moved(int sign) const { return {(t << 1500) + sign, e + 1500}; }
};

/// Returns a float in units of 2^-149, which is an integer.
[[nodiscard]] inline mpz_class integer_of(float value) {
  int exponent = 0;
  const auto mantissa = static_cast<long>(std::ldexp(std::frexp(value, &exponent), 24));
  const int shift = exponent - 24 + 149;
  mpz_class result(mantissa);
  return shift >= 0 ? mpz_class(result << static_cast<unsigned>(shift))
                    : mpz_class(result >> static_cast<unsigned>(-shift));
}

/// Returns the direction of v in doubles. The result does not have length 1.
[[nodiscard]] inline std::array<double, 3> direction_of(const IntegerVector& v) {
  std::array<double, 3> mantissa{};
  std::array<long, 3> exponent{};
  long largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    mantissa[k] = mpz_get_d_2exp(&exponent[k], v[k].get_mpz_t());
    if (mantissa[k] != 0) largest = std::max(largest, exponent[k]);
  }
  for (std::size_t k = 0; k < 3; ++k)
    mantissa[k] = std::ldexp(mantissa[k], static_cast<int>(std::max<long>(exponent[k] - largest, -2000)));
  return mantissa;
}

/// Returns the angle between u and n, in radians, with an error of 1e-15. Returns NaN if a component of u is NaN, or if
/// |u|^2 is at most 1/2, since u must be a unit vector.
[[nodiscard]] inline double angle_between(const Vec3f& u, const std::array<double, 3>& n) {
  const double x = u.y * n[2] - u.z * n[1], y = u.z * n[0] - u.x * n[2], z = u.x * n[1] - u.y * n[0];
  if (!(double{u.x} * u.x + double{u.y} * u.y + double{u.z} * u.z > 0.5)) return std::nan("");
  return std::atan2(std::sqrt(x * x + y * y + z * z), u.x * n[0] + u.y * n[1] + u.z * n[2]);
}

/// Computes the normals of all faces in one segment of a motion.
class IntegerNormals {
 public:
  explicit IntegerNormals(const Segment& segment) : segment_(segment) {
    for (std::size_t v = 0; v < segment.from.count; ++v) {
      from_.push_back(point(segment.from[v]));
      to_.push_back(point(segment.to[v]));
    }
  }

  /// Returns the normal n(t) of every face at this time.
  [[nodiscard]] std::vector<IntegerVector> at(const IntegerTime& time) const {
    std::vector<IntegerVector> corners(from_.size()), normals(segment_.topology->face_count());
    const mpz_class s = (mpz_class(1) << time.e) - time.t;
    for (std::size_t v = 0; v < corners.size(); ++v) {
      for (std::size_t k = 0; k < 3; ++k) corners[v][k] = s * from_[v][k] + time.t * to_[v][k];
    }
    for (std::size_t f = 0; f < normals.size(); ++f) {
      const auto face = segment_.topology->face(f);
      for (std::size_t c = 2; c < face.size(); ++c) {
        const IntegerVector e = difference(corners[face[c - 1]], corners[face[0]]),
                            g = difference(corners[face[c]], corners[face[0]]);
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
          normals[f][k] += e[i] * g[j] - e[j] * g[i];
        }
      }
    }
    return normals;
  }

 private:
  static IntegerVector point(const Vec3f& p) { return {integer_of(p.x), integer_of(p.y), integer_of(p.z)}; }
  static IntegerVector difference(const IntegerVector& a, const IntegerVector& b) {
    return {mpz_class(a[0] - b[0]), mpz_class(a[1] - b[1]), mpz_class(a[2] - b[2])};
  }

  Segment segment_;
  std::vector<IntegerVector> from_, to_;
};

[[nodiscard]] inline bool is_zero(const IntegerVector& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

/// Returns the sum of the normals of some faces. `faces` has the indices of these faces in `normals`.
[[nodiscard]] inline IntegerVector sum_of(const std::vector<IntegerVector>& normals,
                                          std::span<const std::uint32_t> faces) {
  IntegerVector sum;
  for (const std::uint32_t f : faces) {
    for (std::size_t k = 0; k < 3; ++k) sum[k] += normals[f][k];
  }
  return sum;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_INTEGER_NORMAL_H_
