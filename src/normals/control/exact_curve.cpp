#include "normals/control/exact_curve.h"

#include <algorithm>

namespace chronormal::inline internal {
namespace {

constexpr int kUnit = -298;  // the exponent of a product of two floats

struct PointParts {
  std::array<FloatParts, 3> at;

  [[nodiscard]] static PointParts of(const Vec3f& p) noexcept {
    return {{FloatParts::of(p.x), FloatParts::of(p.y), FloatParts::of(p.z)}};
  }
};

template <std::size_t kDigits>
void add_cross(const PointParts& p, const PointParts& q, std::array<WideInteger<kDigits>, 3>& sum) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum[k].add_product(p.at[i], q.at[j]);
    sum[k].add_product(p.at[j], q.at[i], -1);
  }
}

// With every factor t as well: 2 (53 + 200) bits more.
constexpr std::size_t kValueDigits = 50;
using ValueVector = std::array<WideInteger<kValueDigits>, 3>;

template <std::size_t kDigits>
Vec3d to_doubles(const std::array<WideInteger<kDigits>, 3>& v, int exponent) noexcept {
  return {v[0].to_double(exponent), v[1].to_double(exponent), v[2].to_double(exponent)};
}

}  // namespace

void ExactCurve::add_polygon(const Segment& segment, std::span<const std::uint32_t> vertices) noexcept {
  PointParts from = PointParts::of(segment.from[vertices.back()]), to = PointParts::of(segment.to[vertices.back()]);
  for (const std::uint32_t vertex : vertices) {
    const PointParts next_from = PointParts::of(segment.from[vertex]), next_to = PointParts::of(segment.to[vertex]);
    add_cross(from, next_from, n0_);
    add_cross(from, next_to, twice_m_);
    add_cross(to, next_from, twice_m_);
    add_cross(to, next_to, n1_);
    from = next_from;
    to = next_to;
  }
}

void ExactCurve::settle() noexcept {
  for (CoefficientVector* const v : {&n0_, &twice_m_, &n1_}) {
    for (Coefficient& component : *v) component.settle();
  }
}

ExactCurve ExactCurve::of_polygon(const Segment& segment, std::span<const std::uint32_t> vertices) noexcept {
  ExactCurve curve;
  curve.add_polygon(segment, vertices);
  curve.settle();
  return curve;
}

ExactCurve ExactCurve::of_faces(const Segment& segment, std::span<const std::uint32_t> faces) noexcept {
  ExactCurve curve;
  for (const std::uint32_t f : faces) curve.add_polygon(segment, segment.topology->face(f));
  curve.settle();
  return curve;
}

ExactCurve ExactCurve::of_kept(const std::int32_t* kept) noexcept {
  ExactCurve curve;
  const auto first = static_cast<std::size_t>(*kept++), end = static_cast<std::size_t>(*kept++);
  for (CoefficientVector* const v : {&curve.n0_, &curve.twice_m_, &curve.n1_}) {
    for (Coefficient& component : *v) {
      for (std::size_t k = first; k < end; ++k) component.set_digit(k, *kept++);
    }
  }
  return curve;
}

void ExactCurve::append_to(std::vector<std::int32_t>& kept) const {
  std::size_t first = kDigits, end = 0;
  for (const CoefficientVector* const v : {&n0_, &twice_m_, &n1_}) {
    for (const Coefficient& component : *v) {
      for (std::size_t k = 0; k < kDigits; ++k) {
        if (component.digit(k) == 0) continue;
        first = std::min(first, k);
        end = std::max(end, k + 1);
      }
    }
  }
  kept.push_back(static_cast<std::int32_t>(first));
  kept.push_back(static_cast<std::int32_t>(end));
  for (const CoefficientVector* const v : {&n0_, &twice_m_, &n1_}) {
    for (const Coefficient& component : *v) {
      for (std::size_t k = first; k < end; ++k) kept.push_back(static_cast<std::int32_t>(component.digit(k)));
    }
  }
}

ControlNormals ExactCurve::rounded() const noexcept {
  return {to_doubles(n0_, kUnit), to_doubles(twice_m_, kUnit - 1), to_doubles(n1_, kUnit)};
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

Vec3d ExactCurve::normal_at(double t) const noexcept {
  const UnitFraction fraction = UnitFraction::of(t);
  const CoefficientVector c1 = linear(), c2 = bend();
  ValueVector value;
  for (std::size_t k = 0; k < 3; ++k) {
    WideInteger<kValueDigits> inner;
    inner.add_product(c2[k], fraction);
    inner.add_shifted(c1[k], fraction.scale);
    inner.settle();
    value[k].add_product(inner, fraction);
    value[k].add_shifted(n0_[k], 2 * fraction.scale);
    value[k].settle();
  }
  return to_doubles(value, kUnit - 2 * static_cast<int>(fraction.scale));
}

UnitNormal ExactCurve::unit_normal_at(double t) const noexcept {
  const Vec3d n = normal_at(t);
  if (n != Vec3d{}) return {unit(n), Direction::kRegular};

  // n(t) = 0: near t the curve is (x - t) n'(t) + (x - t)^2 bend.
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
  const Vec3d slope = to_doubles(derivative, kUnit - static_cast<int>(fraction.scale));
  if (slope != Vec3d{}) {
    if (t <= 0) return {unit(slope), Direction::kLimit};
    return {unit(-slope), t >= 1 ? Direction::kLimit : Direction::kDiscontinuous};
  }
  for (Coefficient& component : c2) component.settle();
  const Vec3d curvature = to_doubles(c2, kUnit);
  return {unit(curvature), curvature != Vec3d{} ? Direction::kLimit : Direction::kNone};
}

}  // namespace chronormal::inline internal
