/// Computes the mean angular error of a curve over t. The schemes quaternion:optimal and linear:scaled minimise it for
/// each element.
#ifndef CHRONORMAL_SCHEMES_MEAN_ERROR_H_
#define CHRONORMAL_SCHEMES_MEAN_ERROR_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "chronormal/normals/control_normals.h"
#include "core/portable_math.h"
#include "schemes/arc.h"

namespace chronormal::inline internal {

/// Returns the angle in radians between two unit vectors, given the square of the length of their difference. The error
/// is below 1e-8 rad. The function uses a polynomial instead of the arc sine, since a search calls it hundreds of times
/// per element.
[[nodiscard]] inline double angle_of_squared_chord(double square) noexcept {
  // The angle is 2 asin(sqrt(y)) with y = square / 4. For y > 1/2, asin(sqrt(y)) = pi/2 - asin(sqrt(1 - y)).
  const double y = std::min(0.25 * square, 1.0);
  const bool upper = y > 0.5;
  const double z = upper ? 1 - y : y;
  const double series =
      1.0000000016226231 +
      z * (0.16666614237825533 +
           z * (0.07502757316322511 +
                z * (0.04409161673659448 +
                     z * (0.035814239270631806 +
                          z * (-0.007020579119684662 +
                               z * (0.10740002125895513 + z * (-0.13591627120977998 + z * 0.12391349489483766)))))));
  const double half = std::sqrt(z) * series;
  return upper ? kPi - 2 * half : 2 * half;
}

/// The exact unit normals of one element at equidistant t inside the segment. (At the ends, schemes have no error.)
class ExactSamples {
 public:
  explicit ExactSamples(const ControlNormals& normals) {
    sample(normals, kIntervals);
    // If the normal turns fast between two samples, a sum over few samples would favour a wrong curve. In this case,
    // more samples are taken.
    constexpr double kFastTurn = 0.15;
    double longest = 0;
    for (std::size_t i = 0; i + 1 < count_; ++i) {
      const Vec3d step = exact_[i + 1] - exact_[i];
      longest = std::max(longest, dot(step, step));
    }
    if (longest > kFastTurn * kFastTurn) sample(normals, kFineIntervals);
  }

  /// Returns the mean angle in radians, over t, between the exact normal and the arc.
  [[nodiscard]] double mean_error(const Arc& arc) const {
    // Each point on the arc follows from the previous one by a rotation, so the loop computes no sine.
    const double step_cosine = portable::cos(arc.angle / intervals_), step_sine = portable::sin(arc.angle / intervals_);
    double cosine = 1, sine = 0, sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double next = cosine * step_cosine - sine * step_sine;
      sine = sine * step_cosine + cosine * step_sine;
      cosine = next;
      const Vec3d miss = (arc.w + cosine * arc.p + sine * arc.q) - exact_[i];
      sum += angle_of_squared_chord(dot(miss, miss));
    }
    return sum / intervals_;
  }

  /// Returns the mean angle in radians, over t, between the exact normal and (1 - t) u0 + t v.
  [[nodiscard]] double mean_error_of_line(const Vec3d& u0, const Vec3d& v) const {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3d p = lerp(u0, v, static_cast<double>(i + 1) / intervals_);
      const double square = dot(p, p);
      const Vec3d miss = (square > 0 ? 1 / std::sqrt(square) : 0.0) * p - exact_[i];
      sum += angle_of_squared_chord(dot(miss, miss));
    }
    return sum / intervals_;
  }

 private:
  static constexpr std::size_t kIntervals = 20, kFineIntervals = 200;

  void sample(const ControlNormals& normals, std::size_t intervals) {
    intervals_ = static_cast<double>(intervals);
    count_ = intervals - 1;
    for (std::size_t i = 0; i < count_; ++i)
      exact_[i] = unit_normal_at(normals, static_cast<double>(i + 1) / intervals_).vector;
  }

  double intervals_ = 0;
  std::size_t count_ = 0;
  std::array<Vec3d, kFineIntervals> exact_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_MEAN_ERROR_H_
