#include "normals/control/exact_curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/segment_end.h"

namespace chronormal::inline internal {
namespace {

struct PointParts {
  std::array<FloatParts, 3> at;

  [[nodiscard]] static PointParts of(const Vec3f& p, unsigned base) noexcept {
    PointParts parts{{FloatParts::of(p.x), FloatParts::of(p.y), FloatParts::of(p.z)}};
    for (FloatParts& part : parts.at) part.shift = part.mantissa == 0 ? 0 : part.shift - base;
    return parts;
  }
};

// The exact position of a vertex, as a sum of vectors of integers.
struct PlaceParts {
  std::array<PointParts, SegmentEnd::kMostParts> parts;
  std::size_t count = 0;

  [[nodiscard]] static PlaceParts of(const SegmentEnd& end, std::uint32_t vertex, unsigned base) noexcept {
    PlaceParts place;
    end.for_parts(vertex, [&](const Vec3f& part) { place.parts[place.count++] = PointParts::of(part, base); });
    return place;
  }
};

// Returns the smaller one of `lowest` and the smallest shift (FloatParts) of a nonzero coordinate of p.
unsigned lowest_shift(const Vec3f& p, unsigned lowest) noexcept {
  for (const float x : {p.x, p.y, p.z}) {
    const FloatParts parts = FloatParts::of(x);
    if (parts.mantissa != 0) lowest = std::min(lowest, parts.shift);
  }
  return lowest;
}

template <std::size_t kDigits>
void add_cross(const PointParts& p, const PointParts& q, std::array<WideInteger<kDigits>, 3>& sum) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum[k].add_product(p.at[i], q.at[j]);
    sum[k].add_product(p.at[j], q.at[i], -1);
  }
}

template <std::size_t kDigits>
void add_cross(const PlaceParts& p, const PlaceParts& q, std::array<WideInteger<kDigits>, 3>& sum) noexcept {
  for (std::size_t i = 0; i < p.count; ++i)
    for (std::size_t k = 0; k < q.count; ++k) add_cross(p.parts[i], q.parts[k], sum);
}

using ValueVector = ExactCurve::Value;

template <std::size_t kDigits>
Vec3d to_doubles(const std::array<WideInteger<kDigits>, 3>& v, int exponent) noexcept {
  return {v[0].to_double(exponent), v[1].to_double(exponent), v[2].to_double(exponent)};
}

constexpr std::size_t kTimeDigits = TimeFraction::kDigits;

template <std::size_t kMost, std::size_t kA, std::size_t kB>
WideInteger<kMost> product(const WideInteger<kA>& a, const WideInteger<kB>& b) noexcept {
  WideInteger<kMost> result;
  result.add_product(a, b);
  result.settle();
  return result;
}

// A vector of integers, given as doubles times 2^exponent. With this exponent the largest component is neither infinite
// nor subnormal.
struct ScaledVector {
  Vec3d vector;
  int exponent = 0;

  template <std::size_t kDigits>
  [[nodiscard]] static ScaledVector of(std::array<WideInteger<kDigits>, 3>& v) noexcept {
    std::size_t size = 0;
    for (auto& component : v) {
      component.settle();
      size = std::max(size, component.size());
    }
    const int exponent = kDigitBits * static_cast<int>(size);
    return {to_doubles(v, -exponent), exponent};
  }
};

// Returns n(t) multiplied by the square of t.whole.
ScaledVector value_at(const std::array<ExactCurve::CoefficientVector, 3>& c, const TimeFraction& t) noexcept {
  constexpr std::size_t kInner = ExactCurve::kDigits + kTimeDigits + 1, kOuter = kInner + kTimeDigits + 1;
  const auto square = product<2 * kTimeDigits>(t.whole, t.whole);
  std::array<WideInteger<kOuter>, 3> value;
  for (std::size_t k = 0; k < 3; ++k) {
    WideInteger<kInner> inner;
    inner.add_product(c[2][k], t.part);
    inner.add_product(c[1][k], t.whole);
    inner.settle();
    value[k].add_product(inner, t.part);
    value[k].add_product(c[0][k], square);
  }
  return ScaledVector::of(value);
}

// Returns n'(t) multiplied by t.whole.
ScaledVector slope_at(const std::array<ExactCurve::CoefficientVector, 3>& c, const TimeFraction& t) noexcept {
  std::array<WideInteger<ExactCurve::kDigits + kTimeDigits + 1>, 3> slope;
  for (std::size_t k = 0; k < 3; ++k) {
    slope[k].add_product(c[2][k], t.part);
    slope[k].add_product(c[2][k], t.part);
    slope[k].add_product(c[1][k], t.whole);
  }
  return ScaledVector::of(slope);
}

}  // namespace

void ExactCurve::add_polygon(const Segment& segment, std::span<const std::uint32_t> vertices) noexcept {
  const SegmentEnd at_start = SegmentEnd::from(segment), at_end = SegmentEnd::to(segment);
  PlaceParts from = PlaceParts::of(at_start, vertices.back(), base_),
             to = PlaceParts::of(at_end, vertices.back(), base_);
  for (const std::uint32_t vertex : vertices) {
    const PlaceParts next_from = PlaceParts::of(at_start, vertex, base_),
                     next_to = PlaceParts::of(at_end, vertex, base_);
    add_cross(from, next_from, n0_);
    add_cross(from, next_to, twice_m_);
    add_cross(to, next_from, twice_m_);
    add_cross(to, next_to, n1_);
    from = next_from;
    to = next_to;
  }
}

template <class Body>
void ExactCurve::for_components(const Body& body) {
  for (CoefficientVector* const v : {&n0_, &twice_m_, &n1_}) {
    for (Coefficient& component : *v) body(component);
  }
}

template <class Body>
void ExactCurve::for_components(const Body& body) const {
  for (const CoefficientVector* const v : {&n0_, &twice_m_, &n1_}) {
    for (const Coefficient& component : *v) body(component);
  }
}

template <class Body>
ExactCurve ExactCurve::of(const Segment& segment, const Body& for_polygons) noexcept {
  constexpr unsigned kHighest = 253;
  ExactCurve curve;
  unsigned lowest = kHighest;
  for_polygons([&](std::span<const std::uint32_t> vertices) {
    for (const std::uint32_t vertex : vertices)
      for (const SegmentEnd& end : {SegmentEnd::from(segment), SegmentEnd::to(segment)})
        end.for_parts(vertex, [&lowest](const Vec3f& part) { lowest = lowest_shift(part, lowest); });
  });
  curve.base_ = lowest;
  for_polygons([&](std::span<const std::uint32_t> vertices) { curve.add_polygon(segment, vertices); });
  curve.for_components([](Coefficient& component) { component.settle(); });
  return curve;
}

ExactCurve ExactCurve::of_polygon(const Segment& segment, std::span<const std::uint32_t> vertices) noexcept {
  return of(segment, [vertices](const auto& body) { body(vertices); });
}

void ExactCurve::add(const ExactCurve& other) noexcept {
  if (other.base_ < base_) {
    ExactCurve finer = other;
    finer.add(*this);
    *this = finer;
    return;
  }
  const unsigned shift = 2 * (other.base_ - base_);
  for (const auto& [to, from] :
       {std::pair{&n0_, &other.n0_}, std::pair{&twice_m_, &other.twice_m_}, std::pair{&n1_, &other.n1_}}) {
    for (std::size_t k = 0; k < 3; ++k) {
      (*to)[k].add_shifted((*from)[k], shift);
      (*to)[k].settle();
    }
  }
}

ExactCurve ExactCurve::of_faces(const Segment& segment, std::span<const std::uint32_t> faces) noexcept {
  return of(segment, [&](const auto& body) {
    for (const std::uint32_t f : faces) body(segment.topology->face(f));
  });
}

void ExactCurve::append_to(std::vector<std::int32_t>& kept) const {
  std::size_t size = 0;
  for_components([&size](const Coefficient& component) { size = std::max(size, component.size()); });
  kept.push_back(static_cast<std::int32_t>(base_));
  kept.push_back(static_cast<std::int32_t>(size));
  for_components([&](const Coefficient& component) {
    for (std::size_t k = 0; k < size; ++k) kept.push_back(static_cast<std::int32_t>(component.digit(k)));
  });
}

ExactCurve ExactCurve::of_kept(const std::int32_t* kept) noexcept {
  ExactCurve curve;
  curve.base_ = static_cast<unsigned>(*kept++);
  const auto size = static_cast<std::size_t>(*kept++);
  curve.for_components([&](Coefficient& component) {
    for (std::size_t k = 0; k < size; ++k) component.set_digit(k, *kept++);
    component.settle();
  });
  return curve;
}

ControlNormals ExactCurve::rounded() const noexcept {
  return {to_doubles(n0_, unit()), to_doubles(twice_m_, unit() - 1), to_doubles(n1_, unit())};
}

ExactCurve::CoefficientVector ExactCurve::linear() const noexcept {
  CoefficientVector result = twice_m_;
  for (std::size_t k = 0; k < 3; ++k) result[k].add(n0_[k], -2);
  return result;
}

ExactCurve::CoefficientVector ExactCurve::bend() const noexcept {
  CoefficientVector result = n0_;
  for (std::size_t k = 0; k < 3; ++k) {
    result[k].add(twice_m_[k], -1);
    result[k].add(n1_[k], 1);
  }
  return result;
}

std::array<ExactCurve::CoefficientVector, 3> ExactCurve::in_powers() const noexcept {
  std::array<CoefficientVector, 3> result = {n0_, linear(), bend()};
  for (CoefficientVector& coefficient : result) {
    for (Coefficient& component : coefficient) component.settle();
  }
  return result;
}

Vec3d ExactCurve::normal_at(const LocalTime& t) const noexcept {
  if (t.is_double()) return normal_at_double(t.t);
  const TimeFraction fraction = TimeFraction::of(t);
  const ScaledVector value = value_at(in_powers(), fraction);
  const int exponent = kDigitBits * static_cast<int>(fraction.whole.size());
  const double whole = fraction.whole.to_double(-exponent);
  const auto scaled = [&](double component) {
    return std::ldexp(component / (whole * whole), value.exponent - 2 * exponent + unit());
  };
  return {scaled(value.vector.x), scaled(value.vector.y), scaled(value.vector.z)};
}

UnitNormal ExactCurve::unit_normal_at(const LocalTime& t) const noexcept {
  if (t.is_double()) return unit_normal_at_double(t.t);
  // The following code is for t inside the segment. The cases are those of unit_normal_at_double().
  const TimeFraction fraction = TimeFraction::of(t);
  auto c = in_powers();
  if (const Vec3d n = value_at(c, fraction).vector; n != Vec3d{}) return {chronormal::unit(n), Direction::kRegular};
  if (const Vec3d slope = slope_at(c, fraction).vector; slope != Vec3d{})
    return {chronormal::unit(-slope), Direction::kDiscontinuous};
  const Vec3d curvature = ScaledVector::of(c[2]).vector;
  return {chronormal::unit(curvature), curvature != Vec3d{} ? Direction::kLimit : Direction::kNone};
}

ExactCurve::Value ExactCurve::integers_at(const UnitFraction& t) const noexcept {
  const CoefficientVector c1 = linear(), c2 = bend();
  Value value;
  for (std::size_t k = 0; k < 3; ++k) {
    WideInteger<ExactCurve::kValueDigits> inner;
    inner.add_product(c2[k], t);
    inner.add_shifted(c1[k], t.scale);
    inner.settle();
    value[k].add_product(inner, t);
    value[k].add_shifted(n0_[k], 2 * t.scale);
    value[k].settle();
  }
  return value;
}

Vec3d ExactCurve::normal_at_double(double t) const noexcept {
  const UnitFraction fraction = UnitFraction::of(t);
  return to_doubles(integers_at(fraction), unit() - 2 * static_cast<int>(fraction.scale));
}

// Returns the blossom n0 + (s + t) / 2 linear + s t bend. Twice the blossom is the sum of two terms that Horner's rule
// computes. The first term begins with s, the second with t.
Vec3d ExactCurve::blossom_at(double s, double t) const noexcept {
  const UnitFraction a = UnitFraction::of(s), b = UnitFraction::of(t);
  const CoefficientVector c1 = linear(), c2 = bend();
  ValueVector value;
  for (std::size_t k = 0; k < 3; ++k) {
    for (const auto& [outer, inner] : {std::pair{a, b}, std::pair{b, a}}) {
      WideInteger<ExactCurve::kValueDigits> factor;
      factor.add_product(c2[k], inner);
      factor.add_shifted(c1[k], inner.scale);
      factor.settle();
      value[k].add_product(factor, outer);
      value[k].add_shifted(n0_[k], a.scale + b.scale);
    }
    value[k].settle();
  }
  return to_doubles(value, unit() - 1 - static_cast<int>(a.scale + b.scale));
}

UnitNormal ExactCurve::unit_normal_at_double(double t) const noexcept {
  const Vec3d n = normal_at_double(t);
  if (n != Vec3d{}) return {chronormal::unit(n), Direction::kRegular};

  // If n(t) = 0, the curve at a time x near t is (x - t) n'(t) + (x - t)^2 bend.
  const UnitFraction fraction = UnitFraction::of(t);
  const CoefficientVector c1 = linear();
  CoefficientVector c2 = bend();
  ValueVector derivative;
  for (std::size_t k = 0; k < 3; ++k) {
    derivative[k].add_product(c2[k], fraction);
    derivative[k].add_product(c2[k], fraction);
    derivative[k].add_shifted(c1[k], fraction.scale);
    derivative[k].settle();
  }
  const Vec3d slope = to_doubles(derivative, unit() - static_cast<int>(fraction.scale));
  if (slope != Vec3d{}) {
    if (t <= 0) return {chronormal::unit(slope), Direction::kLimit};
    return {chronormal::unit(-slope), t >= 1 ? Direction::kLimit : Direction::kDiscontinuous};
  }
  for (Coefficient& component : c2) component.settle();
  const Vec3d curvature = to_doubles(c2, unit());
  return {chronormal::unit(curvature), curvature != Vec3d{} ? Direction::kLimit : Direction::kNone};
}

}  // namespace chronormal::inline internal
