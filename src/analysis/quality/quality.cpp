#include "chronormal/analysis/quality.h"

#include <cassert>
#include <cmath>

#include "core/portable_math.h"

namespace chronormal {

double Quality::mean() const noexcept { return count == 0 ? 0 : sum / static_cast<double>(count); }

double Quality::rms() const noexcept { return count == 0 ? 0 : std::sqrt(sum_of_squares / static_cast<double>(count)); }

void Quality::add(std::span<const Vec3d> exact, VectorView<const float> normals, const ErrorPlace& first) {
  assert(exact.size() == normals.count);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Vec3d u = to_double(normals[i]);
    // Through the largest component of the exact normal, whose length is an area of any size.
    const double scale = max_abs(exact[i]);
    if (scale == 0) {
      ++degenerate;
      continue;
    }
    const double square = dot(u, u);
    if (!(square > 0 && std::isfinite(square))) {
      ++missing;
      continue;
    }
    const Vec3d n{exact[i].x / scale, exact[i].y / scale, exact[i].z / scale};
    const Vec3d x = cross(n, u);
    const double angle = portable::atan2(std::sqrt(dot(x, x)), dot(n, u));
    sum += angle;
    sum_of_squares += angle * angle;
    ++count;
    if (angle > max) {
      max = angle;
      max_at = {first.segment, first.element + i, first.t};
    }
  }
}

void Quality::add(const Quality& other) {
  sum += other.sum;
  sum_of_squares += other.sum_of_squares;
  count += other.count;
  degenerate += other.degenerate;
  missing += other.missing;
  if (other.max > max) {
    max = other.max;
    max_at = other.max_at;
  }
}

}  // namespace chronormal
