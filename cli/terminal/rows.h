/// Limits that the tables of all reports share for names and rows, and angles in degrees.
#ifndef CLI_TERMINAL_ROWS_H_
#define CLI_TERMINAL_ROWS_H_

#include <cstddef>

#include "chronormal/core/vec3.h"

namespace chronormal::cli {

/// The most characters that a table shows of a name from a file.
inline constexpr std::size_t kLongestName = 32;

/// The most rows of a table for people; --json has all rows.
inline constexpr std::size_t kMostRows = 16;

[[nodiscard]] constexpr double in_degrees(double radians) noexcept { return radians * kDegreesPerRadian; }

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_ROWS_H_
