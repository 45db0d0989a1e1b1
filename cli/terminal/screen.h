/// What a terminal shows: so many columns, and emphasis in colour.
///
/// Text for people is marked where it is made, by the control sequences of terminals, which printable() lets no name
/// have (cli/terminal/text.h). Whoever writes the text takes the marks out, unless it goes to a terminal that shows
/// them. JSON and CSV have none.
#ifndef CLI_TERMINAL_SCREEN_H_
#define CLI_TERMINAL_SCREEN_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace chronormal::cli {

/// How many columns lines may have: COLUMNS where it is set, else as many as the terminal has on stdout, else 80; at
/// least 40.
[[nodiscard]] std::size_t columns_of_output();

/// Whether TERM says that the terminal cannot take a line back or show colours.
[[nodiscard]] bool is_dumb_terminal();

/// Whether a stream (STDOUT_FILENO) shows colours: a terminal that is not dumb, where NO_COLOR is not set. A
/// CLICOLOR_FORCE other than 0 makes every stream one, but not against NO_COLOR.
[[nodiscard]] bool shows_colour(int stream);

/// The text with emphasis: of titles, of what is wrong, of what deserves a look. Nothing stays nothing.
[[nodiscard]] std::string heading(std::string_view text);
[[nodiscard]] std::string alarming(std::string_view text);
[[nodiscard]] std::string warning(std::string_view text);

/// The text without any emphasis.
[[nodiscard]] std::string plain(std::string_view text);

/// The text with a heading of every line that begins at its first column and ends in a colon.
[[nodiscard]] std::string with_headings(std::string_view text);

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_SCREEN_H_
