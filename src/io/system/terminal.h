/// Finds out facts about terminals that only the system knows. Private to io and the program.
#ifndef CHRONORMAL_IO_SYSTEM_TERMINAL_H_
#define CHRONORMAL_IO_SYSTEM_TERMINAL_H_

#include <cstddef>

namespace chronormal::inline internal {

[[nodiscard]] bool is_terminal(int stream) noexcept;

/// Returns true if a stream is a terminal that can erase a line, according to TERM or to the console of Windows.
[[nodiscard]] bool is_clever_terminal(int stream) noexcept;

/// Returns true if a stream is a terminal that shows colours.
[[nodiscard]] bool has_colours(int stream) noexcept;

/// Returns the number of columns of the terminal on a stream. Returns 0 if the stream is not a terminal, or if the
/// terminal does not report its width.
[[nodiscard]] std::size_t columns_of_terminal(int stream) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_TERMINAL_H_
