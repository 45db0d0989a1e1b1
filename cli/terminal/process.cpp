#include "cli/terminal/process.h"

#include <atomic>
#include <cfenv>
#include <csignal>
#include <exception>
#include <new>

#include "chronormal/io/output.h"
#include "cli/terminal/print.h"
#include "io/system/files.h"
#include "io/system/process.h"
#include "io/system/terminal.h"

namespace chronormal::cli {
namespace {

constexpr int kExitFailed = 1;

volatile std::sig_atomic_t stderr_is_terminal = 0;
std::atomic<const char*> last_words{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free,
              "a signal handler must not wait for a lock, so this type must be lock-free");

// Clears the current line of the terminal before it prints the message, because the line may show a progress bar.
void end_line_and_say(const char* message) {
  if (stderr_is_terminal != 0) say_raw("\r\033[K");
  say_ending(message);
  if (const char* const text = last_words; text != nullptr) say_raw(text);
}

// Removes temporary files, and prints why the program ends. A rank prints no message, because mpirun reports which rank
// a signal has ended, and then sends SIGTERM to all others.
void end_by_request(const char* message) {
  remove_temporaries();
  if (!speaks_as_rank()) end_line_and_say(message);
}

// Handles a pipe whose reader has ended. If messages get lost, the write fails and the program goes on. If results get
// lost, the program ends, as programs usually do in front of `head`. Returns true if the program must end.
bool end_by_lost_reader() {
  if (is_saying()) return false;
  remove_temporaries();
  return true;
}

void end_by_lost_input() {
  remove_temporaries();
  end_line_and_say("another program has shortened an input, or an input can no longer be read; run the command again");
  end_now(kExitFailed);
}

// Ends the program when memory runs out, without calling destructors. Unwinding would not be safe in all libraries for
// JSON and threads.
void end_for_want_of_memory() {
  remove_temporaries();
  end_line_and_say("out of memory; close other programs, or choose a smaller part of the input");
  end_now(kExitFailed);
}

void end_by_error() {
  remove_temporaries();
  end_line_and_say("out of memory, or an error in the program; try a smaller part of the input, or report the problem");
  end_now(kExitFailed);
}

// The C library calls abort() if it gets no memory for a thread, so release builds end the program in an orderly way
// then. In other builds, an abort is a failed assertion, and its signal keeps the default action.
#ifdef NDEBUG
constexpr auto end_by_abort = end_by_error;
#else
constexpr void (*end_by_abort)() = nullptr;
#endif

}  // namespace

void prepare_process() noexcept {
  // A library that was loaded earlier may have set another rounding mode of the floating-point unit, or have turned
  // subnormal numbers into zero. This call resets the unit.
  (void)std::fesetenv(FE_DFL_ENV);
  prepare_standard_streams();
  stderr_is_terminal = is_terminal(kStandardError) ? 1 : 0;
  watch_endings({end_by_request, end_by_lost_reader, end_by_lost_input, end_by_abort});
  std::set_new_handler(end_for_want_of_memory);
  std::set_terminate(end_by_error);
}

void say_at_end(const char* text) noexcept { last_words = text; }

}  // namespace chronormal::cli
