/// Measures the width of text on a terminal.
#ifndef CLI_TERMINAL_TEXT_H_
#define CLI_TERMINAL_TEXT_H_

#include <cstddef>
#include <string_view>

#include "core/text.h"

namespace chronormal::cli {

/// Returns the number of columns that a text takes on a terminal: one for each character of UTF-8, and none for the
/// marks of emphasis (cli/terminal/screen.h).
[[nodiscard]] std::size_t width_of(std::string_view text) noexcept;

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_TEXT_H_
