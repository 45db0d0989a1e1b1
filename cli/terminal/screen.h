/// Finds the number of columns of the terminal, and marks text for emphasis by colour.
///
/// The functions that make text for people mark emphasis by the control sequences of terminals. (printable() removes
/// such sequences from names; see cli/terminal/text.h.) The functions that write the text remove the marks, unless the
/// text goes to a terminal that shows them. JSON and CSV have no marks.
#ifndef CLI_TERMINAL_SCREEN_H_
#define CLI_TERMINAL_SCREEN_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace chronormal::cli {

/// Returns the width of lines in columns, at least 40: COLUMNS if it is set, else the width of the terminal on stdout,
/// else 80.
[[nodiscard]] std::size_t columns_of_output();

/// Returns true if a stream, such as kStandardOutput, shows colours: if the stream is a terminal with colours, or if
/// CLICOLOR_FORCE is set and not 0. NO_COLOR turns colours off in any case.
[[nodiscard]] bool shows_colour(int stream);

/// Return the text with marks of emphasis for a title, an error or a warning. An empty text stays empty.
[[nodiscard]] std::string heading(std::string_view text);
[[nodiscard]] std::string alarming(std::string_view text);
[[nodiscard]] std::string warning(std::string_view text);

/// Returns the text without its marks of emphasis.
[[nodiscard]] std::string plain(std::string_view text);

/// Returns the text with marks of emphasis around its headings. A heading is a line that begins in the first column and
/// ends in a colon.
[[nodiscard]] std::string with_headings(std::string_view text);

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_SCREEN_H_
