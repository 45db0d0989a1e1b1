// Adds up angular errors over batches of samples, and computes their mean values.
#include "chronormal/analysis/quality.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "analysis/quality/kernels/reference_angles.h"

namespace chronormal {

double Quality::mean() const noexcept { return count == 0 ? 0 : sum / static_cast<double>(count); }

double Quality::rms() const noexcept { return count == 0 ? 0 : std::sqrt(sum_of_squares / static_cast<double>(count)); }

void Quality::add(std::span<const Vec3d> exact, VectorView<const float> normals, const ErrorPlace& first) {
  assert(exact.size() == normals.count);
  constexpr std::size_t kAtOnce = 256;
  std::array<double, kAtOnce> angles;
  Quality all = *this;  // a copy, so that the compiler keeps it in registers
  for (std::size_t begin = 0; begin < exact.size(); begin += kAtOnce) {
    const std::size_t size = std::min(kAtOnce, exact.size() - begin);
    angles_to_exact(exact.subspan(begin, size), normals.part({begin, size}), std::span(angles).first(size));
    for (std::size_t i = 0; i < size; ++i) {
      const double angle = angles[i];
      if (angle < 0) {
        ++(angle == kNoExactNormal ? all.degenerate : all.missing);
        continue;
      }
      all.sum += angle;
      all.sum_of_squares += angle * angle;
      ++all.count;
      if (angle > all.max) {
        all.max = angle;
        all.max_at = {first.segment, first.element + begin + i, first.t};
      }
    }
  }
  *this = all;
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
