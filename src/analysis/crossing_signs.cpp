#include "analysis/crossing_signs.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "core/wide_integer.h"

namespace chronormal::inline internal {
namespace {

constexpr std::array<std::size_t, 3> kNext{1, 2, 0};

// The axes that follow one.
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

// The volume over a cell, each coefficient times its binomial.
Bernstein<double, 3> volume_sums(const std::array<Triple, 3>& from, const std::array<Triple, 3>& to) noexcept {
  const Triple before = cross_of(from[1], from[2]), after = cross_of(to[1], to[2]);
  const Triple between = sum_of(cross_of(from[1], to[2]), cross_of(to[1], from[2]));
  return {dot_of(from[0], before), dot_of(to[0], before) + dot_of(from[0], between),
          dot_of(from[0], after) + dot_of(to[0], between), dot_of(to[0], after)};
}

// A coordinate has 24 + 253 bits, one more for a difference and 48 for the time; a volume is a sum of six products of
// three of these.
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

// Adds a x b, component by component; to be settled.
void add_cross(const ExactVector& a, const ExactVector& b, ProductVector& sum) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    sum[k].add_product(a[i], b[j]);
    sum[k].add_product(a[j], b[i], -1);
  }
}

// The corners seen from the point at both ends of a cell, as integers of one unit.
class ExactCell {
 public:
  ExactCell(const std::array<MovingPoint, 3>& corners, const MovingPoint& point, const Cell& cell) noexcept {
    unsigned base = 253;
    const auto lower = [&base](const MovingPoint& p) {
      for (const float x : {p.from.x, p.from.y, p.from.z, p.to.x, p.to.y, p.to.z}) {
        const FloatParts parts = FloatParts::of(x);
        if (parts.mantissa != 0) base = std::min(base, parts.shift);
      }
    };
    for (const MovingPoint& corner : corners) lower(corner);
    lower(point);
    const int zeros = std::min(kTickBits, std::countr_zero(static_cast<std::uint64_t>(cell.from | cell.to | kTicks)));
    const auto at = [&](const MovingPoint& corner, Tick t, ExactVector& result) {
      const Tick after = t >> zeros, before = (kTicks - t) >> zeros;
      add_difference(corner.from, point.from, base, before, result);
      add_difference(corner.to, point.to, base, after, result);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      at(corners[k], cell.from, ends_[0][k]);
      at(corners[k], cell.to, ends_[1][k]);
    }
  }

  // The sign of coefficient i of the volume: of the sum over all ways to take i corners at the end of the cell and the
  // others at its beginning.
  [[nodiscard]] int volume(std::size_t i) const noexcept {
    Volume value;
    ProductVector normal;
    for (const auto& at : choices(3, i)) {
      const ExactVector &a = ends_[at[0]][0], &b = ends_[at[1]][1], &c = ends_[at[2]][2];
      ProductVector product;
      add_cross(b, c, product);
      for (std::size_t k = 0; k < 3; ++k) {
        product[k].settle();
        value.add_product(product[k], a[k]);
      }
    }
    if (const int sign = settled_sign(value); sign != 0) return sign;
    // -n by degree 3: each choice of degree 3 leaves out a factor, which is 1.
    for (const auto& at : choices(3, i)) {
      const auto &first = ends_[at[0]], &second = ends_[at[1]];
      add_cross(difference(second[2], second[0]), difference(first[1], first[0]), normal);
    }
    for (Product& component : normal) {
      if (const int sign = settled_sign(component); sign != 0) return sign;
    }
    return 0;
  }

  // The same of the side of an edge.
  [[nodiscard]] int side(std::size_t edge, std::size_t axis, std::size_t i) const noexcept {
    const std::size_t next = kNext[edge], x = first_of(axis), y = second_of(axis);
    Product value;
    for (const auto& at : choices(2, i)) {
      const ExactVector &a = ends_[at[0]][edge], &b = ends_[at[1]][next];
      value.add_product(a[x], b[y]);
      value.add_product(a[y], b[x], -1);
    }
    if (const int sign = settled_sign(value); sign != 0) return sign;
    // - e_x (b - a)_y + e_y (b - a)_x, by degree 2: each choice leaves out a factor, which is 1.
    Coordinate along_x, along_y;
    for (const auto& at : choices(2, i)) {
      const ExactVector &a = ends_[at[0]][edge], &b = ends_[at[0]][next];
      along_x.add(a[y], 1);
      along_x.add(b[y], -1);
      along_y.add(b[x], 1);
      along_y.add(a[x], -1);
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

  static void add_difference(const Vec3f& corner, const Vec3f& point, unsigned base, Tick factor,
                             ExactVector& result) noexcept {
    if (factor == 0) return;
    const std::array<float, 3> c{corner.x, corner.y, corner.z}, p{point.x, point.y, point.z};
    const UnitFraction weight{{factor & (kDigitBase - 1), factor >> kDigitBits, 0}, 0};
    const auto parts = [base](float x) {
      FloatParts of_x = FloatParts::of(x);
      of_x.shift = of_x.mantissa == 0 ? 0 : of_x.shift - base;
      return of_x;
    };
    for (std::size_t k = 0; k < 3; ++k) {
      WideInteger<kCoordinateDigits> seen;
      seen.add_product(parts(c[k]), {1, 0});
      seen.add_product(parts(p[k]), {1, 0}, -1);
      seen.settle();
      result[k].add_product(seen, weight);
      result[k].settle();
    }
  }

  std::array<std::array<ExactVector, 3>, 2> ends_;
};

}  // namespace

CrossingSigns::CrossingSigns(const std::array<MovingPoint, 3>& corners, const MovingPoint& point) noexcept
    : corners_(corners), point_(point) {
  const auto seen = [](const Vec3f& corner, const Vec3f& origin) {
    return Seen{double{corner.x} - origin.x, double{corner.y} - origin.y, double{corner.z} - origin.z};
  };
  Seen size{};
  for (std::size_t k = 0; k < 3; ++k) {
    from_[k] = seen(corners[k].from, point.from);
    to_[k] = seen(corners[k].to, point.to);
    for (std::size_t i = 0; i < 3; ++i)
      size[i] = std::max(size[i], std::max(std::fabs(from_[k][i]), std::fabs(to_[k][i])));
  }
  // A difference has one rounding and a position at t three more, so each is within 4 u of the largest coordinate along
  // its axis. A coefficient of a side is a sum of 4 products, that of a volume one of 18, each with the errors of its
  // factors and its own roundings, and every sum adds at most one rounding of the whole: below 4 (8 + 1 + 2) u = 44 u of
  // the product of the sizes, and 18 (12 + 2 + 5) u = 342 u.
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

// Those that double is sure of, and the others by integers.
template <std::size_t kCount, class Exact>
std::array<int, kCount> CrossingSigns::certain_signs(const std::array<double, kCount>& values, double bound,
                                                     const Cell& cell, const Exact& sign_of_exact) const noexcept {
  std::array<int, kCount> signs{};
  bool is_certain = true;
  for (std::size_t i = 0; i < kCount; ++i) {
    signs[i] = values[i] > bound ? 1 : values[i] < -bound ? -1 : 0;
    is_certain = is_certain && signs[i] != 0;
  }
  if (is_certain) return signs;
  const ExactCell exact(corners_, point_, cell);
  for (std::size_t i = 0; i < kCount; ++i) {
    if (signs[i] == 0) signs[i] = sign_of_exact(exact, i);
  }
  return signs;
}

std::array<int, 3> CrossingSigns::side(std::size_t k, std::size_t axis, const Cell& cell) const noexcept {
  const Corners from = corners_at(cell.from), to = corners_at(cell.to);
  const Seen &a0 = from[k], &a1 = to[k], &b0 = from[kNext[k]], &b1 = to[kNext[k]];
  const std::array<double, 3> s{side_of(a0, b0, axis), side_of(a0, b1, axis) + side_of(a1, b0, axis),
                                side_of(a1, b1, axis)};
  return certain_signs(s, side_bound_[axis], cell,
                       [&](const ExactCell& exact, std::size_t i) { return exact.side(k, axis, i); });
}

std::array<int, 4> CrossingSigns::volume(const Cell& cell) const noexcept {
  return certain_signs(volume_sums(corners_at(cell.from), corners_at(cell.to)), volume_bound_, cell,
                       [](const ExactCell& exact, std::size_t i) { return exact.volume(i); });
}

int CrossingSigns::side_at(std::size_t k, std::size_t axis, Tick t) const noexcept {
  const Corners at = corners_at(t);
  const std::array<double, 1> s{side_of(at[k], at[kNext[k]], axis)};
  return certain_signs(s, side_bound_[axis], {t, t},
                       [&](const ExactCell& exact, std::size_t i) { return exact.side(k, axis, i); })[0];
}

int CrossingSigns::volume_at(Tick t) const noexcept {
  const Corners at = corners_at(t);
  const std::array<double, 1> v{dot_of(at[0], cross_of(at[1], at[2]))};
  return certain_signs(v, volume_bound_, {t, t},
                       [](const ExactCell& exact, std::size_t i) { return exact.volume(i); })[0];
}

Bernstein<double, 3> CrossingSigns::rounded_volume(const Cell& cell) const noexcept {
  Bernstein<double, 3> v = volume_sums(corners_at(cell.from), corners_at(cell.to));
  v[1] /= 3;
  v[2] /= 3;
  return v;
}

}  // namespace chronormal::inline internal
