/// Text that came out of a file, made safe to print.
#ifndef CLI_TERMINAL_TEXT_H_
#define CLI_TERMINAL_TEXT_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace chronormal::cli {

/// Names in files are anyone's words. Control characters, characters that turn the direction of writing, and bytes that
/// are not UTF-8 come out as \xNN; what is longer than `most` characters ends in "...".
/// 4 <= most
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = static_cast<std::size_t>(-1));

/// The text of a JSON document, in UTF-8, with the same characters as \uNNNN inside its strings; line ends stay.
[[nodiscard]] std::string escaped_for_json(std::string_view document);

/// How many columns of a terminal a text takes: one for each character of UTF-8, and none for the marks of emphasis
/// (cli/terminal/screen.h).
[[nodiscard]] std::size_t width_of(std::string_view text) noexcept;

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_TEXT_H_
