/// Properties of a terminal: its columns, and emphasis in colour.
///
/// Text for people is marked where it is made, by the control sequences of terminals, which printable() removes from
/// names (cli/terminal/text.h). The code that writes the text removes the marks, unless it goes to a terminal that
/// shows them. JSON and CSV have none.
#ifndef CLI_TERMINAL_SCREEN_H_
#define CLI_TERMINAL_SCREEN_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace chronormal::cli {

/// Returns the width of lines: COLUMNS if it is set, else the width of the terminal on stdout, else 80; at least 40.
[[nodiscard]] std::size_t columns_of_output();

/// Tells whether a stream (kStandardOutput) shows colours: it is a terminal that has them, or CLICOLOR_FORCE is set and
/// not 0. NO_COLOR turns colours off in any case.
[[nodiscard]] bool shows_colour(int stream);

/// Return the text with emphasis, for titles, errors and warnings. An empty text stays empty.
[[nodiscard]] std::string heading(std::string_view text);
[[nodiscard]] std::string alarming(std::string_view text);
[[nodiscard]] std::string warning(std::string_view text);

/// Returns the text without any emphasis.
[[nodiscard]] std::string plain(std::string_view text);

/// Marks as heading every line of the text that begins at its first column and ends in a colon.
[[nodiscard]] std::string with_headings(std::string_view text);

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_SCREEN_H_
