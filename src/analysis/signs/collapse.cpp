// Finds collapses in three stages. Each stage settles the faces for which its answer is certain.
//
// 1. A half space: if all control normals have a positive dot product with one direction, so has n(t), which is their
//    convex combination. This test takes three dot products, and proves that almost every face has no collapse.
// 2. The determinant: n(t) = 0 is a linear relation between the control normals, so a face has no collapse if its
//    control normals span space.
// 3. Integers: n(t) has three components, each a quadratic. If all components are multiples of one quadratic, its roots
//    are the collapses. If two components differ, their combination without t^2 is linear, and its root is the only
//    candidate.
//
// The error of a control normal is at most 2^-26 of its length. The bounds of the first two stages, which use floating
// point, include this error.

#include "analysis/signs/length_1.h"
#include "chronormal/analysis/signs.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "analysis/signs/exact_roots.h"
#include "normals/control/exact_curve.h"

namespace chronormal {
namespace {

using Vectors = std::array<ExactCurve::CoefficientVector, 3>;  // the coefficients c0, c1, c2 of n(t)
constexpr std::size_t kDigits = ExactCurve::kDigits;
using Product = WideInteger<2 * kDigits + 1>;

// A bound of the error of a rounded dot product of an exact vector c and a rounded vector w, relative to |c| |w|. The
// error is at most 2^-25; the rest is a margin.
constexpr double kShare = 0x1p-24;

bool is_in_half_space(const ControlNormals& c) noexcept {
  const Vec3d w = c.n0 + c.n1;
  const double size = kShare * length_1(w);
  return dot(c.n0, w) > size * length_1(c.n0) && dot(c.m, w) > size * length_1(c.m) &&
         dot(c.n1, w) > size * length_1(c.n1);
}

bool spans_space(const ControlNormals& c) noexcept {
  const double size = length_1(c.n0) * length_1(c.m) * length_1(c.n1);
  const double determinant = std::fabs(dot(c.n0, cross(c.m, c.n1)));
  // Products that underflow prove nothing, so sizes must be in this range.
  return size > 0x1p-900 && size < 0x1p900 && determinant > 8 * kShare * size;
}

// Returns sign * v. Adding the zero vector turns negative zeros into zeros, which are easier to read.
Vec3d signed_by(int sign, const Vec3d& v) noexcept { return Vec3d{} + static_cast<double>(sign) * v; }

// Returns the unit vector along a vector of integers, or the opposite unit vector if sign is -1. The common unit of the
// integers does not matter.
template <std::size_t kMost>
Vec3d direction(const std::array<WideInteger<kMost>, 3>& v, int sign = 1) noexcept {
  std::size_t size = 0;
  for (const auto& component : v) size = std::max(size, component.size());
  const int exponent = -kDigitBits * static_cast<int>(size);
  const Vec3d rounded{v[0].to_double(exponent), v[1].to_double(exponent), v[2].to_double(exponent)};
  return signed_by(sign, unit(rounded));
}

IntegerPolynomial<2, kDigits> component(const Vectors& c, std::size_t k) noexcept {
  return {{c[0][k], c[1][k], c[2][k]}};
}

// Returns the determinant p.a[i] q.a[j] - p.a[j] q.a[i] of the coefficients i and j of two polynomials.
Product minor(const IntegerPolynomial<2, kDigits>& p, const IntegerPolynomial<2, kDigits>& q, std::size_t i,
              std::size_t j) noexcept {
  Product result;
  result.add_product(p.a[i], q.a[j]);
  result.add_product(p.a[j], q.a[i], -1);
  result.settle();
  return result;
}

// Finds the collapses if every n(t) is a multiple of one vector. f is one component of n, a quadratic that is not zero
// throughout.
Collapses on_a_line(const Vectors& c, const IntegerPolynomial<2, kDigits>& f) noexcept {
  std::size_t k = 0;
  while (f.a[k].sign() == 0) ++k;
  const Vec3d positive = direction(c[k], f.a[k].sign());
  Collapses found;
  const ExactRoots roots = exact_roots(f);
  for (const ExactRoot& root : roots.all())
    found.at[found.count++] = {root.lower, root.upper, root.before * root.after < 0, signed_by(root.before, positive),
                               signed_by(root.after, positive)};
  return found;
}

// Finds the collapse of a face that can only collapse at the root of a linear polynomial.
Collapses at_root_of(const IntegerPolynomial<1, 2 * kDigits + 1>& linear, const Vectors& c) noexcept {
  const auto& [l0, l1] = linear.a;
  if (l1.sign() == 0) return {};
  const ExactRoots roots = exact_roots(linear);
  if (roots.count == 0) return {};
  // `value` is l1^2 n(t) and `slope` is |l1| n'(t), at t = -l0 / l1.
  std::array<WideInteger<5 * kDigits + 4>, 3> value;
  std::array<WideInteger<3 * kDigits + 3>, 3> slope;
  const auto square = [](const Product& p, const Product& q) {
    WideInteger<4 * kDigits + 3> result;
    result.add_product(p, q);
    result.settle();
    return result;
  };
  const auto l00 = square(l0, l0), l01 = square(l0, l1), l11 = square(l1, l1);
  for (std::size_t k = 0; k < 3; ++k) {
    value[k].add_product(c[0][k], l11);
    value[k].add_product(c[1][k], l01, -1);
    value[k].add_product(c[2][k], l00);
    value[k].settle();
    if (value[k].sign() != 0) return {};
    slope[k].add_product(c[1][k], l1, l1.sign());
    slope[k].add_product(c[2][k], l0, std::int64_t{-2} * l1.sign());
    slope[k].settle();
  }
  const ExactRoot& root = roots.at[0];
  const bool is_simple = std::any_of(slope.begin(), slope.end(), [](const auto& s) { return s.sign() != 0; });
  const Vec3d after = is_simple ? direction(slope) : direction(c[2]);
  const Vec3d before = is_simple ? signed_by(-1, after) : after;
  Collapses found;
  found.count = 1;
  found.at[0] = {root.lower, root.upper, is_simple && root.before != 0 && root.after != 0,
                 root.before != 0 ? before : Vec3d{}, root.after != 0 ? after : Vec3d{}};
  return found;
}

Collapses in_integers(const Vectors& c) noexcept {
  std::size_t first = 0;
  while (first < 3 && component(c, first).terms() == 0) ++first;
  if (first == 3) return {{}, 0, true};
  const IntegerPolynomial<2, kDigits> f = component(c, first);
  for (std::size_t k = first + 1; k < 3; ++k) {
    const IntegerPolynomial<2, kDigits> g = component(c, k);
    const IntegerPolynomial<1, 2 * kDigits + 1> linear{{minor(f, g, 0, 2), minor(f, g, 1, 2)}};
    // Two linear polynomials that are not multiples of each other have no common root.
    if (linear.terms() == 0 && minor(f, g, 0, 1).sign() != 0) return {};
    if (linear.terms() != 0) return at_root_of(linear, c);
  }
  return on_a_line(c, f);
}

}  // namespace

Collapses find_collapses(const Segment& segment, std::size_t face, const ControlNormals& normals) noexcept {
  if (is_in_half_space(normals) || spans_space(normals)) return {};
  return in_integers(ExactCurve::of_polygon(segment, segment.topology->face(face)).in_powers());
}

std::vector<FaceCollapses> find_collapses(const Segment& segment, IndexRange faces,
                                          std::span<const ControlNormals> normals) {
  assert(normals.size() == faces.count);
  std::vector<FaceCollapses> result;
  for (std::size_t i = 0; i < faces.count; ++i) {
    if (is_in_half_space(normals[i])) continue;
    const Collapses found = find_collapses(segment, faces.first + i, normals[i]);
    if (found.always || found.count > 0) result.push_back({faces.first + i, found});
  }
  return result;
}

Collapses find_collapses(const Segment& segment, std::size_t face) noexcept {
  ControlNormals normals;
  face_control_normals(segment, {face, 1}, {&normals, 1});
  return find_collapses(segment, face, normals);
}

}  // namespace chronormal
