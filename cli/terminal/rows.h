/// Defines the largest lengths of names and tables that all reports share, and converts angles to degrees.
#ifndef CLI_TERMINAL_ROWS_H_
#define CLI_TERMINAL_ROWS_H_

#include <cstddef>

#include "chronormal/core/vec3.h"

namespace chronormal::cli {

/// The largest number of characters that a table shows of a name from a file.
inline constexpr std::size_t kLongestName = 32;

/// The largest number of rows in a table for people; --json has all rows.
inline constexpr std::size_t kMostRows = 16;

[[nodiscard]] constexpr double in_degrees(double radians) noexcept { return radians * kDegreesPerRadian; }

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_ROWS_H_
