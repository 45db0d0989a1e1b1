/// Handles positions far from the origin, as in surveys. A float32 has 24 bits, and far from the origin most of them
/// are equal for all vertices. So a common origin is subtracted in double before positions are rounded, and writers add
/// it again (Motion::origin). Private to io.
#ifndef CHRONORMAL_IO_MESH_FAR_ORIGIN_H_
#define CHRONORMAL_IO_MESH_FAR_ORIGIN_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

namespace chronormal::inline internal {

using Origin = std::array<double, 3>;

/// Finds the origin to subtract from positions (V, 3) if that saves at least four bits, that is, if they are farther
/// from (0, 0, 0) than 16 times their extent. The origin is near their middle, and a multiple of a power of two of
/// about that extent, so that subtracting it does not round. Returns (0, 0, 0) otherwise.
template <class Real>
[[nodiscard]] Origin far_origin(std::span<const Real> positions) {
  constexpr double kFar = 16, kBeside = 4;
  Origin middle = {};
  double extent = 0, farthest = 0;
  for (std::size_t axis = 0; axis < 3 && positions.size() >= 3; ++axis) {
    double low{positions[axis]}, high = low;
    for (std::size_t i = axis; i < positions.size(); i += 3) {
      low = std::min(low, double{positions[i]});
      high = std::max(high, double{positions[i]});
    }
    middle[axis] = low / 2 + high / 2;
    extent = std::max(extent, high / 2 - low / 2);
    farthest = std::max(farthest, std::fabs(middle[axis]));
  }
  if (!(extent > 0) || farthest < kFar * extent) return {};
  const double unit = std::ldexp(1.0, std::ilogb(extent));
  for (double& coordinate : middle)
    coordinate = std::fabs(coordinate) < kBeside * extent ? 0 : unit * std::round(coordinate / unit);
  return middle;
}

/// Returns true if rounding a number to float32 loses some of its decimal digits. last_digit is the value of a 1 in the
/// place of its last digit.
[[nodiscard]] inline bool loses_digits(double value, double last_digit) noexcept {
  return std::fabs(value - double{static_cast<float>(value)}) > last_digit / 2 * (1 + 1e-6);
}

/// Returns a note on the digits that positions lost before, when they were rounded to float32, if the loss is large
/// relative to their extent. Returns an empty text otherwise.
[[nodiscard]] std::string note_of_lost_digits(std::span<const float> positions);

/// Returns the coordinates as text: "(452312, 5411872, 0)".
[[nodiscard]] std::string origin_text(const Origin& origin);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_FAR_ORIGIN_H_
