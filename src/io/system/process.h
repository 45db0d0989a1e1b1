/// The beginning and the end of a process, as the system has them. What a program does then is its own matter:
/// cli/terminal/process.h. Private to the program.
#ifndef CHRONORMAL_IO_SYSTEM_PROCESS_H_
#define CHRONORMAL_IO_SYSTEM_PROCESS_H_

namespace chronormal::inline internal {

/// Opens each standard stream that is closed on the null device, the wrong way round: reading and writing still fail,
/// but no file that is opened later becomes this stream. On Windows, bytes then pass unchanged through all three.
void prepare_standard_streams() noexcept;

/// Actions of a program when something ends it. Each runs in the handler of a signal, or in a thread that the system
/// has made for it, while all other threads go on.
struct Endings {
  /// Somebody tells the program to end. The process ends when this returns, as the system says: by the signal on POSIX
  /// systems, with the exit code of Ctrl-C on Windows.
  void (*by_request)(const char* message);
  /// Somebody has closed the pipe that this thread writes to. Where this returns true the process ends; where it
  /// returns false, writing is an error. Windows has no signal for it: writing is an error always.
  bool (*by_lost_reader)();
  /// An input that is mapped became shorter, or its disk failed. Must not return.
  void (*by_lost_input)();
  /// A library called std::abort(). Must not return; nullptr where that ends the program by the signal.
  void (*by_abort)();
};

/// Calls these from now on. What was ignored before stays ignored. Writing beyond the limit of a file is an error like
/// any other.
void watch_endings(const Endings& endings) noexcept;

/// Gives memory that was freed back to the system, where the C library can be told to.
void give_back_free_memory() noexcept;

/// Ends the process at once, without destructors. Safe to call from a handler.
[[noreturn]] void end_now(int exit_code) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_PROCESS_H_
