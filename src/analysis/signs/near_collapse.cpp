#include "analysis/signs/near_collapse.h"

#include <algorithm>
#include <cmath>

#include "chronormal/core/polynomial.h"

namespace chronormal::inline internal {
namespace {

double length_squared(const Vec3d& v) { return dot(v, v); }

// Returns true if |n(t)| certainly stays above kCollapseShare. The proof is that n(t) . w is at least the smallest of
// c_k . w, for control normals c_k.
bool stays_long(const ControlNormals& c) {
  const Vec3d w = c.n0 + c.n1;
  const double smallest = std::min({dot(c.n0, w), dot(c.m, w), dot(c.n1, w)});
  return smallest > 0 && smallest * smallest > kCollapseShare * kCollapseShare * length_squared(w);
}

// Returns n at a t between `from` and `end`, an end of the segment. Of the tried times, t is the one nearest to `from`
// at which n is clearly longer than in the collapse and has a direction again.
Vec3d clear_of(const ControlNormals& c, double from, double end) {
  constexpr double kClear = 4 * kCollapseShare;
  double step = kCollapseMargin;
  while (step < std::fabs(end - from)) {
    const Vec3d n = normal_at(c, end < from ? from - step : from + step);
    if (length_squared(n) > kClear * kClear) return n;
    step *= 2;
  }
  return normal_at(c, end);
}

}  // namespace

NearCollapses find_near_collapses(const ControlNormals& normals) noexcept {
  NearCollapses found;
  const double largest = std::max({max_abs(normals.n0), max_abs(normals.m), max_abs(normals.n1)});
  if (largest == 0) {
    found.everywhere = true;
    return found;
  }
  const auto scaled = [largest](const Vec3d& v) { return Vec3d{v.x / largest, v.y / largest, v.z / largest}; };
  const ControlNormals c{scaled(normals.n0), scaled(normals.m), scaled(normals.n1)};
  if (stays_long(c)) return found;

  // Between neighbouring roots of the derivative, |n(t)| is monotone. If |n(t)| does not exceed the limit between two
  // neighbouring minima, these minima belong to one collapse.
  const Bernstein<Vec3d, 2> n = {c.n0, c.m, c.n1};
  const Bernstein<double, 4> square = multiply(n, n, dot<double>);
  Bernstein<double, 3> derivative;
  for (std::size_t k = 0; k < derivative.size(); ++k) derivative[k] = square[k + 1] - square[k];
  const Roots<3> roots = roots_in_unit_interval(derivative);
  double first = 0, last = 0, best = 0, smallest = 0;
  bool is_open = false;
  const auto close = [&] {
    if (is_open && found.count < found.at.size())
      found.at[found.count++] = {best, dot(clear_of(c, first, 0), clear_of(c, last, 1)) < 0};
    is_open = false;
  };
  for (std::size_t i = 0; i < roots.count; ++i) {
    const double t = roots.t[i], size = length_squared(normal_at(c, t));
    if (!(t > kCollapseMargin && t < 1 - kCollapseMargin) || size > kCollapseShare * kCollapseShare) {
      close();
      continue;
    }
    if (!is_open) first = t;
    if (!is_open || size < smallest) {
      best = t;
      smallest = size;
    }
    last = t;
    is_open = true;
  }
  close();
  return found;
}

}  // namespace chronormal::inline internal
