/// Moves the t that a caller passes into the range [0, 1] of a segment. No other functions move t.
#ifndef CHRONORMAL_NORMALS_CONTROL_LOCAL_TIME_H_
#define CHRONORMAL_NORMALS_CONTROL_LOCAL_TIME_H_

#include <cmath>

#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// The smallest t that does not count as 0. For this t, t^2 times the smallest product of two floats is far above the
/// smallest double.
inline constexpr double kSmallestTime = 0x1p-200;

/// Returns t in [0, 1]. A t outside of [0, 1] is moved to the nearer end, and a t below kSmallestTime becomes 0. NaN
/// stays NaN, and callers then write the normal (0, 0, 0).
[[nodiscard]] inline double local_time(double t) noexcept {
  if (std::isnan(t)) return t;
  return t < kSmallestTime ? 0 : t > 1 ? 1 : t;
}

/// Returns a time clamped to [0, 1]. The time may be a quotient that no double can represent. A time closer than
/// kSmallestTime to an end becomes that end.
[[nodiscard]] inline LocalTime local_time(const LocalTime& time) noexcept {
  if (time.is_double()) return local_time(time.t);
  if (time.t < kSmallestTime) return 0.0;
  if (time.rest < kSmallestTime) return 1.0;
  return time;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_LOCAL_TIME_H_
