#include "cli/terminal/print.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>

#include "chronormal/io/output.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/text.h"

namespace chronormal::cli {

Status print(std::string_view text) { return print_to("-", text, false); }

Status print_to(const std::string& path, std::string_view text, bool force) {
  if (path == "-" && shows_colour(STDOUT_FILENO)) return write_output(path, text, force);
  return write_output(path, plain(text), force);
}

void say_text(std::string_view text) { say_raw(shows_colour(STDERR_FILENO) ? std::string(text) : plain(text)); }

void say_raw(std::string_view text) noexcept {
  const int system_error = errno;
  while (!text.empty()) {
    const ssize_t count = ::write(STDERR_FILENO, text.data(), text.size());
    if (count > 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
      continue;
    }
    if (count < 0 && errno == EINTR) continue;
    if (count == 0 || errno != EAGAIN) break;
    pollfd waiting{STDERR_FILENO, POLLOUT, 0};  // the other side made the pipe non-blocking
    if (::poll(&waiting, 1, -1) < 0 && errno != EINTR) break;
  }
  errno = system_error;
}

void say(std::string_view command, std::string_view message, Tone tone) {
  std::string who = "chronormal";
  if (!command.empty()) who.append(" ").append(command);
  who += ':';
  say_text((tone == Tone::kError ? alarming(who) : warning(who)).append(" ").append(printable(message)).append("\n"));
}

}  // namespace chronormal::cli
