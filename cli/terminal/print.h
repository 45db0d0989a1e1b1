/// Prints results to stdout, and everything else to stderr. No other file of the program prints.
///
/// Either stream may be full, closed, or a pipe that nobody reads. If a result cannot be written, the command fails;
/// messages may get lost. Control characters in names of files and arguments are printed as printable() returns them
/// (cli/terminal/text.h).
#ifndef CLI_TERMINAL_PRINT_H_
#define CLI_TERMINAL_PRINT_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal::cli {

/// Prints a text to stdout, with emphasis if stdout shows colours. Errors: kFailed with the place "<stdout>" if some of
/// the text could not be written.
[[nodiscard]] Status print(std::string_view text);

/// Prints to stdout if the path is "-"; otherwise writes the file, without emphasis. Errors: those of write_output().
[[nodiscard]] Status print_to(const std::string& path, std::string_view text, bool force);

/// Prints a text of several lines on stderr, with emphasis if stderr shows colours.
void say_text(std::string_view text);

/// Writes to stderr without changes, as many bytes as stderr takes. Safe to call in a signal handler.
void say_raw(std::string_view text) noexcept;

/// Prints "chronormal: message", cut off after 256 bytes, to say why the process ends now. Safe to call in a signal
/// handler.
void say_ending(std::string_view message) noexcept;

/// Returns true if this thread is writing to stderr. Safe to call in a signal handler.
[[nodiscard]] bool is_saying() noexcept;

/// Makes this process one of several that share a task. After that, only the first process (rank 0) prints messages,
/// and none shows colours. However, every rank prints why it ends, with its number.
void speak_as_rank(int rank);
[[nodiscard]] bool speaks_as_rank() noexcept;

/// Prints "chronormal COMMAND: message" on stderr, in one line; `command` may be empty. An error that repeats a warning
/// of this process is not printed again. This function only prints; the caller reports an error by the exit code.
enum class Tone { kWarning, kError };
void say(std::string_view command, std::string_view message, Tone tone);

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_PRINT_H_
