#include "cli/terminal/process.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cfenv>
#include <csignal>
#include <cstddef>
#include <exception>
#include <new>

#include "chronormal/io/output.h"
#include "cli/terminal/print.h"

namespace chronormal::cli {
namespace {

constexpr int kExitFailed = 1;

struct Ending {
  int signal;
  const char* message;
};

constexpr Ending kEndings[] = {
    {SIGHUP, "stopped, since its terminal was closed (SIGHUP)"},
    {SIGINT, "interrupted (SIGINT)"},
    {SIGQUIT, "stopped (SIGQUIT)"},
    {SIGTERM, "stopped (SIGTERM)"},
    {SIGXCPU, "stopped, since it used more time than allowed (SIGXCPU)"},
};

volatile std::sig_atomic_t stderr_is_terminal = 0;
std::atomic<const char*> last_words{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler may not wait");

// Clears the line first, since it may show a progress bar.
void end_line_and_say(const char* message) {
  if (stderr_is_terminal != 0) say_raw("\r\033[K");
  say_ending(message);
  if (const char* const text = last_words; text != nullptr) say_raw(text);
}

extern "C" void end_by_signal(int signal) {
  remove_temporaries();
  for (const Ending& ending : kEndings) {
    // A rank stays silent: mpirun reports which rank a signal has ended, and sends SIGTERM to all others.
    if (ending.signal == signal && !speaks_as_rank()) end_line_and_say(ending.message);
  }
  // SA_RESETHAND has restored the default action, which runs when the handler returns.
  (void)std::raise(signal);
}

// Handles a pipe that nobody reads any more. Messages may get lost: write() fails then, and the program goes on. If
// results get lost, the program ends like every other one in front of `head`.
extern "C" void end_by_lost_reader(int signal) {
  if (is_saying()) return;
  remove_temporaries();
  (void)std::signal(signal, SIG_DFL);
  (void)std::raise(signal);
}

extern "C" void end_by_lost_input(int /*signal*/) {
  remove_temporaries();
  end_line_and_say("an input was shortened by another program, or can no longer be read");
  ::_exit(kExitFailed);
}

// Ends the program without destructors if memory runs out: not every library behind JSON or threads survives unwinding
// then.
void end_for_want_of_memory() {
  remove_temporaries();
  end_line_and_say("out of memory");
  ::_exit(kExitFailed);
}

// Handles SIGABRT: the C library aborts if it gets no memory for a thread. A failed assertion ends by the signal.
#ifdef NDEBUG
extern "C" void end_by_abort(int /*signal*/) {
  remove_temporaries();
  end_line_and_say("out of memory, or an internal error");
  ::_exit(kExitFailed);
}
#endif

void end_by_exception() {
  remove_temporaries();
  end_line_and_say("out of memory, or an internal error");
  ::_exit(kExitFailed);
}

void install(int signal, void (*handler)(int), unsigned flags = SA_RESETHAND) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(flags);  // of SIG_IGN nothing
  (void)::sigfillset(&action.sa_mask);
  (void)::sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// Opens closed streams. The system assigns the lowest numbers first. Each stream is opened in its unused direction.
void open_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

}  // namespace

void prepare_process() noexcept {
  // A library loaded earlier may have set another rounding mode or flush subnormal numbers to zero.
  (void)std::fesetenv(FE_DFL_ENV);
  open_standard_streams();
  stderr_is_terminal = ::isatty(STDERR_FILENO);
  for (const Ending& ending : kEndings) {
    if (!is_ignored(ending.signal)) install(ending.signal, end_by_signal);
  }
  install(SIGBUS, end_by_lost_input);
  install(SIGXFSZ, SIG_IGN);
  if (!is_ignored(SIGPIPE)) install(SIGPIPE, end_by_lost_reader, 0);
#ifdef NDEBUG
  install(SIGABRT, end_by_abort);
#endif
  std::set_new_handler(end_for_want_of_memory);
  std::set_terminate(end_by_exception);
}

void say_at_end(const char* text) noexcept { last_words = text; }

}  // namespace chronormal::cli
