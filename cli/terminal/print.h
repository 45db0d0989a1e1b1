/// The one place where the program prints: what was asked for to stdout, everything else to stderr.
///
/// Either stream may be full, closed, or a pipe that nobody reads. What was asked for must arrive, or the command
/// fails; what is only said may get lost. Control characters of names in files and arguments are printed as printable()
/// has them (cli/terminal/text.h).
#ifndef CLI_TERMINAL_PRINT_H_
#define CLI_TERMINAL_PRINT_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal::cli {

/// Prints to stdout, with emphasis where that shows colours. Errors: kFailed where not all of it could be written, with
/// the place "<stdout>".
[[nodiscard]] Status print(std::string_view text);

/// Prints to stdout where the path is "-"; else writes the file, without emphasis. Errors: of write_output()
[[nodiscard]] Status print_to(const std::string& path, std::string_view text, bool force);

/// Says a text of several lines on stderr, with emphasis where that shows colours.
void say_text(std::string_view text);

/// Writes to stderr as it is, as much as it takes. Safe to call from the handler of a signal.
void say_raw(std::string_view text) noexcept;

/// Says "chronormal: message" as it is, of at most 200 bytes: why the process ends now. Safe to call from the handler
/// of a signal.
void say_ending(std::string_view message) noexcept;

/// Whether this thread writes to stderr just now. Safe to call from the handler of a signal.
[[nodiscard]] bool is_saying() noexcept;

/// Makes this process one of several that share a task: only the first of them, rank 0, says anything, and none shows
/// colours. But every rank says why it ends, with its number.
void speak_as_rank(int rank);
[[nodiscard]] bool speaks_as_rank() noexcept;

/// Says "chronormal COMMAND: message" on stderr, in one line; command may be empty. An error is what the exit code
/// tells, too.
enum class Tone { kWarning, kError };
void say(std::string_view command, std::string_view message, Tone tone);

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_PRINT_H_
