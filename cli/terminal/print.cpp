#include "cli/terminal/print.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <functional>
#include <set>
#include <string>

#include "chronormal/io/output.h"
#include "cli/terminal/format.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/text.h"
#include "io/system/files.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kLongestEnding = 256;
std::string who_ends = "chronormal: ";
bool is_rank = false, is_silent = false;
// A flag that is 1 while this thread writes to stderr. Each thread has its own flag, because the handler of SIGPIPE
// runs in the thread that writes.
thread_local volatile std::sig_atomic_t writes_to_stderr = 0;

void write_to_stderr(std::string_view text) noexcept {
  const int system_error = errno;
  writes_to_stderr = 1;
  (void)write_bytes(kStandardError, text);
  writes_to_stderr = 0;
  errno = system_error;
}

}  // namespace

bool is_saying() noexcept { return writes_to_stderr != 0; }

Status print(std::string_view text) { return print_to("-", text, false); }

Status print_to(const std::string& path, std::string_view text, bool force) {
  if (path == "-" && is_silent) return Success{};
  if (path == "-" && !is_rank && shows_colour(kStandardOutput)) return write_output(path, text, force);
  return write_output(path, plain(text), force);
}

void say_text(std::string_view text) {
  say_raw(!is_rank && shows_colour(kStandardError) ? std::string(text) : plain(text));
}

void say_raw(std::string_view text) noexcept {
  if (!is_silent) write_to_stderr(text);
}

// Writes the whole line in one call of the system, so that lines of several ranks do not mix.
void say_ending(std::string_view message) noexcept {
  std::array<char, kLongestEnding> line{};
  auto end = line.begin();
  for (const std::string_view part : {std::string_view(who_ends), message, std::string_view("\n")})
    end =
        std::copy_n(part.begin(), std::min<std::size_t>(part.size(), static_cast<std::size_t>(line.end() - end)), end);
  write_to_stderr({line.data(), static_cast<std::size_t>(end - line.begin())});
}

void speak_as_rank(int rank) {
  who_ends = formatted("chronormal: rank {}: ", rank);
  is_rank = true;
  is_silent = rank != 0;
}

bool speaks_as_rank() noexcept { return is_rank; }

void say(std::string_view command, std::string_view message, Tone tone) {
  // A fault in a glTF file may be a warning when the file is opened, and the error of the command afterwards.
  static std::set<std::string, std::less<>> warnings;
  if (tone == Tone::kError && warnings.contains(message)) return;
  if (tone == Tone::kWarning) warnings.emplace(message);
  std::string who = "chronormal";
  if (!command.empty()) who.append(" ").append(command);
  who += ':';
  say_text((tone == Tone::kError ? alarming(who) : warning(who)).append(" ").append(printable(message)).append("\n"));
}

}  // namespace chronormal::cli
