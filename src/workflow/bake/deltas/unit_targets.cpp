// Finds unit vectors. turning_unit() needs a vector u = q + x right with |u| = 1, where q = base - shown / weight, and
// the sum weight x right must not be zero. The part of u across `right` is that of q. The part of u along `right`
// follows from |u| = 1, and may have either sign.
#include "workflow/bake/deltas/unit_targets.h"

#include <cmath>
#include <numbers>

#include "core/portable_math.h"

namespace chronormal::inline internal {
namespace {

constexpr int kDirections = 16;
constexpr int kSteps = 24;                 // the steps of a bisection, which finds a point to 1e-7 of an arc
constexpr double kShortestSum = 1.0 / 16;  // the shortest sum; rounding turns shorter ones too far

// The largest component that a delta may have. It is slightly below 1, since deltas are rounded to float32.
constexpr double kMost = 1 - 1e-6;

// Returns the unit vector on the arc between two unit vectors, at `part` of the arc's length. If the ends of the arc
// are opposite, uses any arc between them.
Vec3d on_arc(const Vec3d& from, const Vec3d& to, double part) {
  const Vec3d aside = to - dot(from, to) * from;
  const Vec3d across = length(aside) > 1e-9 ? unit(aside) : any_perpendicular(from);
  const double angle = part * angle_between(from, to);
  return portable::cos(angle) * from + portable::sin(angle) * across;
}

}  // namespace

bool fits(const Vec3d& base, const Vec3d& u) noexcept { return max_abs(u - base) <= kMost || max_abs(base) == 0; }

Vec3d farthest_that_fits(const Vec3d& base, const Vec3d& u) noexcept {
  if (fits(base, u)) return u;
  double low = 0, high = 1;
  for (int step = 0; step < kSteps; ++step) {
    const double middle = (low + high) / 2;
    (fits(base, on_arc(base, u, middle)) ? low : high) = middle;
  }
  return on_arc(base, u, low);
}

std::optional<Vec3d> turning_unit(const Vec3d& base, const Vec3d& shown, const Vec3d& right, double weight) noexcept {
  const Vec3d q = base - (1 / weight) * shown;
  const double along = dot(q, right);
  const Vec3d across = q - along * right;
  const double room = 1 - dot(across, across);
  if (!(room >= 0)) return farthest_that_fits(base, unit(across));
  const double part = std::copysign(std::sqrt(room), weight);
  std::optional<Vec3d> reachable;
  for (const double of_u : {part, -part}) {
    if (weight * (of_u - along) < kShortestSum) continue;
    const Vec3d u = unit(across + of_u * right);
    if (fits(base, u)) return u;
    if (!reachable) reachable = farthest_that_fits(base, u);
  }
  return reachable;
}

std::optional<std::array<Vec3d, 2>> two_units(const Vec3d& base, const Vec3d& vector) noexcept {
  const Vec3d middle = base + 0.5 * vector;
  const double room = 1 - dot(middle, middle);
  if (!(room >= 0)) return std::nullopt;
  // The two unit vectors lie on opposite sides of `middle`, at equal distances in any direction perpendicular to
  // `middle`. The chosen direction makes the largest component of the two deltas smallest.
  const Vec3d x = any_perpendicular(max_abs(middle) > 0 ? unit(middle) : Vec3d{1, 0, 0});
  const Vec3d y = max_abs(middle) > 0 ? cross(unit(middle), x) : Vec3d{1, 0, 0};
  std::optional<std::array<Vec3d, 2>> best;
  double least = kMost;
  for (int n = 0; n < kDirections; ++n) {
    const double angle = std::numbers::pi * n / kDirections;
    const Vec3d aside = std::sqrt(room) * (portable::cos(angle) * x + portable::sin(angle) * y);
    const std::array<Vec3d, 2> both = {middle + aside, middle - aside};
    const double largest = std::fmax(max_abs(both[0] - base), max_abs(both[1] - base));
    if (largest > least) continue;
    least = largest;
    best = both;
  }
  return best;
}

Vec3d unit_delta(const Vec3d& base, const Vec3d& vector) noexcept {
  Vec3d across = vector - dot(vector, base) * base;
  const double size = length(across);
  if (size > 1) across = (1 / size) * across;
  const Vec3d u = across + std::sqrt(std::fmax(0, 1 - dot(across, across))) * base;
  return farthest_that_fits(base, unit(u)) - base;
}

}  // namespace chronormal::inline internal
