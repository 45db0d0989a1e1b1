/// Handles positions far from the origin, which occur in surveys. A float32 has 24 bits, and far from the origin most
/// of these bits are equal for all vertices. Readers therefore subtract a common origin in double before they round
/// positions, and writers add it again (Motion::origin). Private to io.
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

/// Finds the origin to subtract from positions (V, 3). An origin is useful if the positions are farther from (0, 0, 0)
/// than 16 times their extent, so that at least four bits are saved. The origin is near the middle of the positions.
/// Its coordinates are multiples of a power of two of about the size of the extent, so that subtracting them does not
/// round. Returns (0, 0, 0) if no origin is useful.
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
/// place of the last decimal digit.
[[nodiscard]] inline bool loses_digits(double value, double last_digit) noexcept {
  return std::fabs(value - double{static_cast<float>(value)}) > last_digit / 2 * (1 + 1e-6);
}

/// Returns a note about positions (V, 3) that were rounded to float32 far from the origin, if the steps between float32
/// numbers there are large relative to the extent of the positions. Returns an empty text otherwise.
[[nodiscard]] std::string note_of_lost_digits(std::span<const float> positions);

/// Returns the coordinates of an origin as text: "(452312, 5411872, 0)".
[[nodiscard]] std::string origin_text(const Origin& origin);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_FAR_ORIGIN_H_
