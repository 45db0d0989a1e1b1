#include "analysis/containment/crossing_signs.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <optional>

#include "core/twofold.h"
#include "core/wide_integer.h"

namespace chronormal::inline internal {
namespace {

constexpr std::array<std::size_t, 3> kNext{1, 2, 0};

// Return the first and the second axis that follow a given axis in the cyclic order x, y, z.
constexpr std::size_t first_of(std::size_t axis) noexcept { return kNext[axis]; }
constexpr std::size_t second_of(std::size_t axis) noexcept { return kNext[kNext[axis]]; }

template <class Vector>
auto side_of(const Vector& a, const Vector& b, std::size_t axis) noexcept {
  const std::size_t i = first_of(axis), j = second_of(axis);
  return a[i] * b[j] - a[j] * b[i];
}

using Triple = std::array<double, 3>;
Triple cross_of(const Triple& b, const Triple& c) noexcept {
  return {side_of(b, c, 0), side_of(b, c, 1), side_of(b, c, 2)};
}
double dot_of(const Triple& a, const Triple& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Triple sum_of(const Triple& a, const Triple& b) noexcept { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

// Returns the Bernstein coefficients of the volume a . (b x c) over a cell of time, each multiplied by its binomial
// coefficient.
Bernstein<double, 3> volume_sums(const std::array<Triple, 3>& from, const std::array<Triple, 3>& to) noexcept {
  const Triple before = cross_of(from[1], from[2]), after = cross_of(to[1], to[2]);
  const Triple between = sum_of(cross_of(from[1], to[2]), cross_of(to[1], from[2]));
  return {dot_of(from[0], before), dot_of(to[0], before) + dot_of(from[0], between),
          dot_of(from[0], after) + dot_of(to[0], between), dot_of(to[0], after)};
}

// The numbers of digits, of 24 bits each, that wide integers need here. A coordinate has 24 + 253 bits, one more for a
// difference and 48 for the time. A volume is a sum of six products of three coordinates.
constexpr std::size_t kCoordinateDigits = 15, kProductDigits = 31, kVolumeDigits = 46;
using Coordinate = WideInteger<kCoordinateDigits>;
using Product = WideInteger<kProductDigits>;
using Volume = WideInteger<kVolumeDigits>;
using ExactVector = std::array<Coordinate, 3>;
using ProductVector = std::array<Product, 3>;

template <std::size_t kDigits>
int settled_sign(WideInteger<kDigits>& value) noexcept {
  value.settle();
  return value.sign();
}

ExactVector difference(const ExactVector& a, const ExactVector& b) noexcept {
  ExactVector result = a;
  for (std::size_t i = 0; i < 3; ++i) {
    result[i].add(b[i], -1);
    result[i].settle();
  }
  return result;
}

// Adds a x b to `sum`, component by component. The caller must settle the sums afterwards (core/wide_integer.h).
void add_cross(const ExactVector& a, const ExactVector& b, ProductVector& sum) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum[k].add_product(a[i], b[j]);
    sum[k].add_product(a[j], b[i], -1);
  }
}

// The corners of a triangle relative to the point at both ends of a cell, as integers with a common unit. Each
// coordinate is computed at its first use.
class ExactCell {
 public:
  ExactCell(const std::array<MovingPoint, 3>& corners, const MovingPoint& point, const Cell& cell) noexcept
      : corners_(corners), point_(point) {
    const auto lower = [this](const MovingPoint& p) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
          at_end(p, end, axis).for_parts([this](float x) {
            const FloatParts parts = FloatParts::of(x);
            if (parts.mantissa != 0) base_ = std::min(base_, parts.shift);
          });
        }
      }
    };
    for (const MovingPoint& corner : corners) lower(corner);
    lower(point);
    const int zeros = std::min(kTickBits, std::countr_zero(static_cast<std::uint64_t>(cell.from | cell.to | kTicks)));
    const auto weight = [zeros](Tick t) {
      const Tick ticks = t >> zeros;
      return UnitFraction{{ticks & (kDigitBase - 1), ticks >> kDigitBits, 0}, 0};
    };
    weights_ = {{{weight(kTicks - cell.from), weight(cell.from)}, {weight(kTicks - cell.to), weight(cell.to)}}};
  }

  // Returns the sign of Bernstein coefficient i of the volume over the cell. This coefficient is a sum over all ways to
  // take i corners at the end of the cell and the others at its beginning.
  [[nodiscard]] int volume(std::size_t i) noexcept {
    Volume value;
    for (const auto& at : choices(3, i)) {
      const ExactVector &a = seen(at[0], 0), &b = seen(at[1], 1), &c = seen(at[2], 2);
      ProductVector product;
      add_cross(b, c, product);
      for (std::size_t k = 0; k < 3; ++k) {
        product[k].settle();
        value.add_product(product[k], a[k]);
      }
    }
    if (const int sign = settled_sign(value); sign != 0) return sign;
    // If the volume is zero, the tie is decided by -n = (c - a) x (b - a). This product has two factors that depend on
    // t, and is expanded to degree 3: each choice leaves out the third factor, which is 1.
    ProductVector normal;
    for (const auto& at : choices(3, i)) {
      add_cross(difference(seen(at[0], 2), seen(at[0], 0)), difference(seen(at[1], 1), seen(at[1], 0)), normal);
    }
    for (Product& component : normal) {
      if (const int sign = settled_sign(component); sign != 0) return sign;
    }
    return 0;
  }

  // Returns the sign of Bernstein coefficient i of the side S of an edge (crossing_signs.h), taken along an axis.
  [[nodiscard]] int side(std::size_t edge, std::size_t axis, std::size_t i) noexcept {
    const std::size_t next = kNext[edge], x = first_of(axis), y = second_of(axis);
    Product value;
    for (const auto& at : choices(2, i)) {
      const std::size_t a = at[0], b = at[1];
      value.add_product(seen(a, edge, x), seen(b, next, y));
      value.add_product(seen(a, edge, y), seen(b, next, x), -1);
    }
    if (const int sign = settled_sign(value); sign != 0) return sign;
    // If the side is zero, the tie is decided by -e_x (b - a)_y + e_y (b - a)_x. This term has one factor that depends
    // on t, and is expanded to degree 2: each choice leaves out the second factor, which is 1.
    Coordinate along_x, along_y;
    for (const auto& at : choices(2, i)) {
      along_x.add(seen(at[0], edge, y), 1);
      along_x.add(seen(at[0], next, y), -1);
      along_y.add(seen(at[0], next, x), 1);
      along_y.add(seen(at[0], edge, x), -1);
    }
    const int by_x = settled_sign(along_x), by_y = settled_sign(along_y);
    return x < y ? (by_x != 0 ? by_x : by_y) : (by_y != 0 ? by_y : by_x);
  }

 private:
  using Choice = std::array<std::uint8_t, 3>;
  struct Choices {
    std::array<Choice, 3> list;
    std::size_t count;
    [[nodiscard]] const Choice* begin() const noexcept { return list.data(); }
    [[nodiscard]] const Choice* end() const noexcept { return list.data() + count; }
  };
  [[nodiscard]] static Choices choices(std::size_t degree, std::size_t i) noexcept {
    if (i == 0) return {{{{0, 0, 0}}}, 1};
    if (i == degree) return {{{{1, 1, 1}}}, 1};
    if (degree == 2) return {{{{0, 1, 0}, {1, 0, 0}}}, 2};
    if (i == 1) return {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 3};
    return {{{{0, 1, 1}, {1, 0, 1}, {1, 1, 0}}}, 3};
  }

  // Return a corner at one end of the cell as seen from the point, and one coordinate of such a corner.
  const ExactVector& seen(std::size_t end, std::size_t corner) noexcept {
    for (std::size_t k = 0; k < 3; ++k) (void)seen(end, corner, k);
    return seen_[end][corner];
  }
  const Coordinate& seen(std::size_t end, std::size_t corner, std::size_t axis) noexcept {
    Coordinate& result = seen_[end][corner][axis];
    bool& is_made = is_made_[end][corner][axis];
    if (is_made) return result;
    add_difference(at_end(corners_[corner], 0, axis), at_end(point_, 0, axis), weights_[end][0], result);
    add_difference(at_end(corners_[corner], 1, axis), at_end(point_, 1, axis), weights_[end][1], result);
    result.settle();
    is_made = true;
    return result;
  }

  // A coordinate at an end of the segment: a float, and the remainder that rounding to this float left.
  struct Unrounded {
    float value;
    double residual;

    // Calls body(part) for several floats whose sum is the coordinate.
    template <class Body>
    void for_parts(const Body& body) const {
      body(value);
      double left = residual;
      for (auto part = static_cast<float>(left); part != 0; part = static_cast<float>(left)) {
        body(part);
        left -= double{part};
      }
    }
  };
  static Unrounded at_end(const MovingPoint& p, std::size_t end, std::size_t axis) noexcept {
    const Vec3f& at = end == 0 ? p.from : p.to;
    const Vec3d& left = end == 0 ? p.from_residual : p.to_residual;
    return {axis == 0 ? at.x : axis == 1 ? at.y : at.z, axis == 0 ? left.x : axis == 1 ? left.y : left.z};
  }

  void add_difference(const Unrounded& p, const Unrounded& q, const UnitFraction& weight,
                      Coordinate& result) const noexcept {
    if (weight.digits[0] == 0 && weight.digits[1] == 0) return;
    WideInteger<kCoordinateDigits> difference;
    // Most differences are exact in double, and are integers of few bits, so these differences need no wide integers.
    constexpr double kMost = 0x1p62;
    const float a = p.value, b = q.value;
    const double rounded = double{a} - double{b}, back = double{a} - rounded;
    const bool is_exact = (double{a} - (rounded + back)) + (back - double{b}) == 0;
    const double units = std::ldexp(rounded, 149 - static_cast<int>(base_));
    if (is_exact && std::fabs(units) < kMost && p.residual == 0 && q.residual == 0) {
      const auto whole = static_cast<std::int64_t>(units);
      difference.set_digit(0, whole & (kDigitBase - 1));
      difference.set_digit(1, whole >> kDigitBits & (kDigitBase - 1));
      difference.set_digit(2, whole >> 2 * kDigitBits);
    } else {
      const auto parts = [this](float x) {
        FloatParts of_x = FloatParts::of(x);
        of_x.shift = of_x.mantissa == 0 ? 0 : of_x.shift - base_;
        return of_x;
      };
      p.for_parts([&](float x) { difference.add_product(parts(x), {1, 0}); });
      q.for_parts([&](float x) { difference.add_product(parts(x), {1, 0}, -1); });
      difference.settle();
    }
    result.add_product(difference, weight);
  }

  const std::array<MovingPoint, 3>& corners_;
  const MovingPoint& point_;
  unsigned base_ = 253;  // exponent of the common unit: all coordinates are multiples of 2^(base - 149)
  std::array<std::array<UnitFraction, 2>, 2> weights_;
  std::array<std::array<ExactVector, 3>, 2> seen_;
  std::array<std::array<std::array<bool, 3>, 3>, 2> is_made_{};
};

// An ExactCell, which is only made when double cannot decide a sign, and the arguments from which it is made.
struct Integers {
  const std::array<MovingPoint, 3>& corners;
  const MovingPoint& point;
  Cell cell;
  std::optional<ExactCell> made;

  ExactCell& get() noexcept { return made ? *made : made.emplace(corners, point, cell); }
};

// Returns the sign that all values have in common; 0 if signs differ or some sign is 0.
template <std::size_t kCount>
int common_sign(const std::array<int, kCount>& signs) noexcept {
  for (const int sign : signs) {
    if (sign != signs[0]) return 0;
  }
  return signs[0];
}

// Returns the sign of each value whose absolute value is above `bound`, the bound of its error, and 0 for the other
// values.
template <std::size_t kCount>
std::array<int, kCount> rounded_signs(const std::array<double, kCount>& values, double bound) noexcept {
  std::array<int, kCount> signs;
  for (std::size_t i = 0; i < kCount; ++i) signs[i] = (values[i] > bound) - (values[i] < -bound);
  return signs;
}

}  // namespace

CrossingSigns::CrossingSigns(const std::array<MovingPoint, 3>& corners, const MovingPoint& point) noexcept
    : corners_(corners), point_(point) {
  const auto seen = [](const Vec3f& corner, const Vec3d& residual, const Vec3f& origin, const Vec3d& of_origin) {
    return Seen{difference(corner.x, residual.x, origin.x, of_origin.x),
                difference(corner.y, residual.y, origin.y, of_origin.y),
                difference(corner.z, residual.z, origin.z, of_origin.z)};
  };
  Seen size{};
  for (std::size_t k = 0; k < 3; ++k) {
    from_[k] = seen(corners[k].from, corners[k].from_residual, point.from, point.from_residual);
    to_[k] = seen(corners[k].to, corners[k].to_residual, point.to, point.to_residual);
    for (std::size_t i = 0; i < 3; ++i)
      size[i] = std::max(size[i], std::max(std::fabs(from_[k][i]), std::fabs(to_[k][i])));
  }
  // Let u = 2^-53. A difference has one rounding, and a position at t has three more, so each has an error of at most 4
  // u of the largest coordinate along its axis. A coefficient of a side is a sum of 4 products of two factors, and a
  // coefficient of a volume is a sum of 18 products of three factors. Each product has the errors of its factors and
  // its own roundings, and every addition adds at most one rounding of the whole sum. In units of the product of the
  // sizes, the error is below 4 (8 + 1 + 2) u = 44 u for a side and 18 (12 + 2 + 5) u = 342 u for a volume.
  constexpr double kRounding = 0x1p-53;
  for (std::size_t axis = 0; axis < 3; ++axis)
    side_bound_[axis] = 64 * kRounding * size[first_of(axis)] * size[second_of(axis)];
  volume_bound_ = 512 * kRounding * size[0] * size[1] * size[2];
}

bool CrossingSigns::is_beside() const noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    double least = from_[0][i], most = least;
    for (const Corners* const end : {&from_, &to_}) {
      for (const Seen& corner : *end) {
        least = std::min(least, corner[i]);
        most = std::max(most, corner[i]);
      }
    }
    if (least > 0 || most < 0) return true;
  }
  return false;
}

CrossingSigns::Corners CrossingSigns::corners_at(Tick t) const noexcept {
  if (t == 0) return from_;
  if (t == kTicks) return to_;
  const double share = static_cast<double>(t) * (1.0 / static_cast<double>(kTicks));
  Corners at;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) at[k][i] = (1 - share) * from_[k][i] + share * to_[k][i];
  }
  return at;
}

Verdict CrossingSigns::judge(std::size_t axis, const Cell& cell) const noexcept {
  const Corners from = corners_at(cell.from), to = corners_at(cell.to);
  std::array<std::array<int, 3>, 3> sides;
  bool is_left = false, is_right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Seen &a0 = from[k], &a1 = to[k], &b0 = from[kNext[k]], &b1 = to[kNext[k]];
    sides[k] =
        rounded_signs<3>({side_of(a0, b0, axis), side_of(a0, b1, axis) + side_of(a1, b0, axis), side_of(a1, b1, axis)},
                         side_bound_[axis]);
    const int sign = common_sign(sides[k]);
    is_left = is_left || sign > 0;
    is_right = is_right || sign < 0;
  }
  if (is_left && is_right) return {};
  std::array<int, 4> volume = rounded_signs(volume_sums(from, to), volume_bound_);
  if (common_sign(volume) != 0) return {};

  Integers integers{corners_, point_, cell, {}};
  std::size_t never_right = 0, never_left = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (sides[k][i] == 0) sides[k][i] = integers.get().side(k, axis, i);
    }
    const auto [least, most] = std::minmax({sides[k][0], sides[k][1], sides[k][2]});
    if (least == 0 && most == 0) return {};
    never_right += least >= 0;
    never_left += most <= 0;
    if (never_right > 0 && never_left > 0) return {};
  }
  int changes = 0, last = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const int sign = volume[i] != 0 ? volume[i] : integers.get().volume(i);
    changes += sign * last < 0;
    if (sign != 0) last = sign;
  }
  if (changes == 0) return {};
  if (changes == 1 && (never_right == 3 || never_left == 3)) return {Verdict::kCrossing, last};
  return {Verdict::kOpen};
}

int CrossingSigns::crossing_of_ray(std::size_t axis, Tick t) const noexcept {
  const Corners at = corners_at(t);
  std::array<int, 3> sides;
  for (std::size_t k = 0; k < 3; ++k)
    sides[k] = rounded_signs<1>({side_of(at[k], at[kNext[k]], axis)}, side_bound_[axis])[0];
  const auto [least, most] = std::minmax({sides[0], sides[1], sides[2]});
  if (least < 0 && most > 0) return 0;
  const int volume = rounded_signs<1>({dot_of(at[0], cross_of(at[1], at[2]))}, volume_bound_)[0];
  Integers integers{corners_, point_, {t, t}, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    if (sides[k] == 0) sides[k] = integers.get().side(k, axis, 0);
    if (sides[k] == 0 || sides[k] != sides[0]) return 0;
  }
  return (volume != 0 ? volume : integers.get().volume(0)) == sides[0] ? sides[0] : 0;
}

int CrossingSigns::volume_at(Tick t) const noexcept {
  const Corners at = corners_at(t);
  const int sign = rounded_signs<1>({dot_of(at[0], cross_of(at[1], at[2]))}, volume_bound_)[0];
  return sign != 0 ? sign : ExactCell(corners_, point_, {t, t}).volume(0);
}

Bernstein<double, 3> CrossingSigns::rounded_volume(const Cell& cell) const noexcept {
  Bernstein<double, 3> v = volume_sums(corners_at(cell.from), corners_at(cell.to));
  v[1] /= 3;
  v[2] /= 3;
  return v;
}

}  // namespace chronormal::inline internal
