/// Points that rest or move on straight lines, from a NumPy array: a .npy file of float32 or float64.
///
///     (n, 3)      each point rests
///     (n, 2, 3)   each point moves from the first position to the second
///
/// Errors     kInvalidInput with the file, and the element, as the place ("points.npy, [17, 0, 2]"): another shape or
///            type, coordinates that are not finite or too large for float32; kFailed where the file cannot be read.
/// Threads    pure
#ifndef CHRONORMAL_IO_POINTS_FILE_H_
#define CHRONORMAL_IO_POINTS_FILE_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal {

/// The ends of n straight lines, (n, 3) each; the same where points rest.
struct PointPaths {
  std::vector<double> from, to;

  [[nodiscard]] std::size_t count() const noexcept { return from.size() / 3; }
};

[[nodiscard]] Result<PointPaths> read_points_file(const std::string& path);

/// The same of its bytes; name is for messages.
[[nodiscard]] Result<PointPaths> parse_points(std::string_view bytes, const std::string& name);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_POINTS_FILE_H_
