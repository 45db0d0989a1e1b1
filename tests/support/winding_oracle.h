/// Computes winding numbers and crossings of moving points in integers and rational numbers, to check containment.
///
/// Unlike the library, this file counts a winding number along a slanted half-line, from the signs of integer
/// determinants. A determinant is zero if the half-line meets an edge or a vertex. In that case, the point is moved by
/// a small step along x, a far smaller step along y and an even smaller step along z, and the winding number is counted
/// again. Roots are isolated by Sturm's theorem in rational numbers.
#ifndef CHRONORMAL_TESTS_SUPPORT_WINDING_ORACLE_H_
#define CHRONORMAL_TESTS_SUPPORT_WINDING_ORACLE_H_

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal::exact {

using Integers = std::array<mpz_class, 3>;
using Corners = std::array<std::uint32_t, 3>;

/// Returns a float multiplied by 2^149, which is an integer.
[[nodiscard]] inline mpz_class whole(float x) {
  int exponent = 0;
  const auto mantissa = static_cast<long>(std::ldexp(std::frexp(x, &exponent), 24));
  const int shift = exponent - 24 + 149;
  if (shift < 0) return mantissa / (1L << -shift);
  return mpz_class(mantissa) << static_cast<unsigned>(shift);
}

/// A time t from 0 to 1, as an integer number of units of 2^-53.
struct Fraction {
  std::int64_t numerator;  // the denominator is 2^53

  explicit Fraction(double t) : numerator(static_cast<std::int64_t>(std::ldexp(t, 53))) {
    if (std::ldexp(static_cast<double>(numerator), -53) != t) throw std::logic_error("t has too many places");
  }
};

/// Returns a vertex at t relative to a moving point. The unit is 2^-(149 + 53), so the coordinates are integers.
[[nodiscard]] inline Integers seen_at(const Vec3f& from, const Vec3f& to, const Vec3f& point_from,
                                      const Vec3f& point_to, const Fraction& t) {
  const mpz_class after = t.numerator, before = (std::int64_t{1} << 53) - t.numerator;
  const auto at = [&](float a, float b, float p, float q) {
    return mpz_class(before * (whole(a) - whole(p)) + after * (whole(b) - whole(q)));
  };
  return {at(from.x, to.x, point_from.x, point_to.x), at(from.y, to.y, point_from.y, point_to.y),
          at(from.z, to.z, point_from.z, point_to.z)};
}

/// A position. `Integer` is mpz_class, or std::int64_t if 64 bits are enough.
template <class Integer>
using Place = std::array<Integer, 3>;

inline int sign_of(const mpz_class& x) { return sgn(x); }
inline int sign_of(std::int64_t x) { return (x > 0) - (x < 0); }

template <class Integer>
[[nodiscard]] int sign_of_determinant(const Place<Integer>& a, const Place<Integer>& b, const Place<Integer>& c) {
  const Integer x = b[1] * c[2] - b[2] * c[1], y = b[2] * c[0] - b[0] * c[2], z = b[0] * c[1] - b[1] * c[0];
  return sign_of(Integer(a[0] * x + a[1] * y + a[2] * z));
}

/// Returns the winding number of the origin, counted along a half-line in the given direction. Returns nothing if the
/// half-line meets an edge or a vertex, so that a determinant is zero.
template <class Integer>
[[nodiscard]] std::optional<int> winding_along(const std::vector<Place<Integer>>& vertices,
                                               std::span<const Corners> faces, const Place<Integer>& direction) {
  int number = 0;
  for (const Corners& face : faces) {
    const Place<Integer>&a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
    if (a == b || b == c || c == a) continue;  // skips triangles without area
    const int ab = sign_of_determinant(direction, a, b);
    if (ab == 0) return std::nullopt;
    const int bc = sign_of_determinant(direction, b, c);
    if (bc == 0) return std::nullopt;
    if (ab != bc) continue;
    const int ca = sign_of_determinant(direction, c, a);
    if (ca == 0) return std::nullopt;
    if (ab != ca) continue;
    const int volume = sign_of_determinant(a, b, c);
    if (volume == 0) return std::nullopt;
    if (volume == ab) number += ab;
  }
  return number;
}

/// Returns the winding number of a moving point at t relative to the mesh. The faces must be triangles.
[[nodiscard]] inline int winding_number(const Segment& segment, std::span<const Corners> faces, const Vec3f& from,
                                        const Vec3f& to, double t) {
  std::vector<Integers> vertices;
  mp_bitcnt_t zeros = 202;
  mpz_class largest = 0;
  for (std::size_t v = 0; v < segment.from.count; ++v) {
    vertices.push_back(seen_at(segment.from[v], segment.to[v], from, to, Fraction(t)));
    for (const mpz_class& x : vertices.back()) {
      if (x != 0) zeros = std::min(zeros, mpz_scan1(x.get_mpz_t(), 0));
      if (abs(x) > largest) largest = abs(x);
    }
  }
  // Removes common factors of two, so that the numbers may fit into 64 bits.
  for (Integers& v : vertices) {
    for (mpz_class& x : v) x >>= zeros;
  }
  largest >>= zeros;
  if (largest < (1 << 18)) {
    std::vector<Place<std::int64_t>> small;
    for (const Integers& v : vertices) small.push_back({v[0].get_si(), v[1].get_si(), v[2].get_si()});
    if (const auto number = winding_along<std::int64_t>(small, faces, {3, 7, 11})) return *number;
  }
  const std::array<Integers, 4> directions{{{3, 7, 11}, {-13, 5, 8}, {17, -19, 6}, {-5, -23, 29}}};
  if (const auto number = winding_along(vertices, faces, directions[0])) return *number;
  // Moves the point by steps that are small compared with every volume and area that is not zero. Coordinates are
  // integers, so such volumes and areas are at least 1, up to a constant factor. Areas are below 2^(2 size).
  const mp_bitcnt_t size = mpz_sizeinbase(largest.get_mpz_t(), 2) + 8, finest = 7 * size;
  for (Integers& v : vertices) {
    for (std::size_t k = 0; k < 3; ++k) v[k] = (v[k] << finest) - (mpz_class(1) << (finest - (2 * k + 3) * size));
  }
  for (const Integers& direction : directions) {
    if (const auto number = winding_along(vertices, faces, direction)) return *number;
  }
  throw std::logic_error("no direction meets no edge");
}

/// A polynomial, as the coefficients of 1, t, t^2, ...
using Polynomial = std::vector<mpq_class>;

[[nodiscard]] inline Polynomial times(const Polynomial& p, const Polynomial& q) {
  Polynomial result(p.size() + q.size() - 1);
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = 0; j < q.size(); ++j) result[i + j] += p[i] * q[j];
  }
  return result;
}
[[nodiscard]] inline Polynomial plus(Polynomial p, const Polynomial& q, int factor = 1) {
  if (p.size() < q.size()) p.resize(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) p[i] += factor * q[i];
  return p;
}
[[nodiscard]] inline int sign_at(const Polynomial& p, const mpq_class& t) {
  mpq_class value = 0;
  for (std::size_t i = p.size(); i-- > 0;) value = value * t + p[i];
  return sgn(value);
}

/// Counts the distinct roots of a polynomial between two times by Sturm's sequence. The two times must not be roots.
class SturmSequence {
 public:
  explicit SturmSequence(Polynomial p) {
    trim(p);
    Polynomial derivative;
    for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(static_cast<long>(i) * p[i]);
    sequence_.push_back(std::move(p));
    while (!derivative.empty()) {
      sequence_.push_back(derivative);
      const Polynomial& divisor = sequence_.back();
      Polynomial rest = sequence_[sequence_.size() - 2];
      while (rest.size() >= divisor.size()) {
        const mpq_class factor = rest.back() / divisor.back();
        for (std::size_t i = 0; i < divisor.size(); ++i) rest[rest.size() - divisor.size() + i] -= factor * divisor[i];
        rest.pop_back();
        trim(rest);
      }
      for (mpq_class& c : rest) c = -c;
      derivative = std::move(rest);
    }
  }

  [[nodiscard]] bool is_zero() const { return sequence_[0].empty(); }
  [[nodiscard]] int sign_at(const mpq_class& t) const { return exact::sign_at(sequence_[0], t); }
  [[nodiscard]] int roots_between(const mpq_class& low, const mpq_class& high) const {
    return variations(low) - variations(high);
  }

 private:
  static void trim(Polynomial& p) {
    while (!p.empty() && p.back() == 0) p.pop_back();
  }
  [[nodiscard]] int variations(const mpq_class& t) const {
    int count = 0, last = 0;
    for (const Polynomial& p : sequence_) {
      const int sign = exact::sign_at(p, t);
      count += sign * last < 0;
      if (sign != 0) last = sign;
    }
    return count;
  }

  std::vector<Polynomial> sequence_;
};

struct ExactCrossing {
  std::size_t face;
  mpq_class low, high;  // bounds of the root in t
  bool inward;
};

/// All crossings of faces by a moving point. If the point meets an edge or only touches a face, is_general is false and
/// the list is empty.
struct ExactCrossings {
  bool is_general = true;
  std::vector<ExactCrossing> list;
};
[[nodiscard]] inline ExactCrossings find_crossings(const Segment& segment, std::span<const Corners> faces,
                                                   const Vec3f& from, const Vec3f& to) {
  const mpq_class kWidth(1, mpz_class(1) << 50);
  using Line = std::array<Polynomial, 3>;
  const auto line = [&](std::uint32_t v) {
    const Vec3f a = segment.from[v], b = segment.to[v];
    const auto seen = [](float a0, float b0, float p, float q) {
      const mpq_class start = mpq_class(a0) - mpq_class(p), end = mpq_class(b0) - mpq_class(q);
      return Polynomial{start, end - start};
    };
    return Line{seen(a.x, b.x, from.x, to.x), seen(a.y, b.y, from.y, to.y), seen(a.z, b.z, from.z, to.z)};
  };
  // The moving point and each edge of a face form a triangle. The point crosses the inside of the face if the vector
  // areas of all three triangles have the direction of the normal n of the face.
  const auto cross = [](const Line& a, const Line& b) {
    Line result;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      result[k] = plus(times(a[i], b[j]), times(a[j], b[i]), -1);
    }
    return result;
  };
  const auto dot = [](const Line& a, const Line& b) {
    return plus(plus(times(a[0], b[0]), times(a[1], b[1])), times(a[2], b[2]));
  };
  ExactCrossings result;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Line a = line(faces[f][0]), b = line(faces[f][1]), c = line(faces[f][2]);
    const Line areas[3] = {cross(a, b), cross(b, c), cross(c, a)};
    Line normal = areas[0];
    for (std::size_t k = 0; k < 3; ++k) normal[k] = plus(plus(normal[k], areas[1][k]), areas[2][k]);
    const SturmSequence volume(dot(a, areas[1]));
    if (volume.is_zero()) return {false, {}};
    std::vector<SturmSequence> sides;
    for (const Line& area : areas) sides.emplace_back(dot(area, normal));
    if (volume.sign_at(0) == 0 || volume.sign_at(1) == 0) return {false, {}};
    const auto middle_of = [&volume](const mpq_class& from_t, const mpq_class& to_t) {
      const mpq_class middle = (from_t + to_t) / 2;
      return volume.sign_at(middle) != 0 ? middle : mpq_class((3 * from_t + 5 * to_t) / 8);
    };
    std::vector<std::pair<mpq_class, mpq_class>> open{{0, 1}};
    while (!open.empty()) {
      auto [low, high] = open.back();
      open.pop_back();
      const int roots = volume.roots_between(low, high);
      if (roots == 0) continue;
      if (roots > 1) {
        if (high - low < kWidth) return {false, {}};
        const mpq_class middle = middle_of(low, high);
        open.emplace_back(low, middle);
        open.emplace_back(middle, high);
        continue;
      }
      while (high - low > kWidth) {
        const mpq_class middle = middle_of(low, high);
        (volume.sign_at(middle) == volume.sign_at(high) ? high : low) = middle;
      }
      bool is_inside = true;
      for (const SturmSequence& side : sides) {
        const int sign = side.sign_at(low);
        if (sign == 0 || side.sign_at(high) != sign || side.roots_between(low, high) != 0) return {false, {}};
        is_inside = is_inside && sign > 0;
      }
      const int before = volume.sign_at(low), after = volume.sign_at(high);
      if (before == after) return {false, {}};  // the point touches the face: a double root
      if (is_inside) result.list.push_back({f, low, high, after > 0});
    }
  }
  return result;
}

}  // namespace chronormal::exact

#endif  // CHRONORMAL_TESTS_SUPPORT_WINDING_ORACLE_H_
