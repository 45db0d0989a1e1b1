/// Prepares the standard streams of a process, and calls functions of the program when something ends the process.
/// cli/terminal/process.h decides what these functions do. Private to the program.
#ifndef CHRONORMAL_IO_SYSTEM_PROCESS_H_
#define CHRONORMAL_IO_SYSTEM_PROCESS_H_

namespace chronormal::inline internal {

/// Opens each closed standard stream on the null device, in the direction that the program does not use. Using such a
/// stream fails as before, but no file that is opened later gets the number of the stream. On Windows, also makes all
/// three streams pass bytes unchanged.
void prepare_standard_streams() noexcept;

/// The functions that are called when something ends the program. Each runs in a signal handler, or in a thread that
/// the system creates for it, while all other threads go on.
struct Endings {
  /// Called when somebody asks the program to end. When the function returns, the process ends: by the signal on POSIX
  /// systems, and with the exit code of Ctrl-C on Windows.
  void (*by_request)(const char* message);
  /// Called when somebody has closed the pipe to which this thread writes. If the function returns true, the process
  /// ends. If it returns false, the write fails with an error. On Windows, the write always fails, because there is no
  /// signal.
  bool (*by_lost_reader)();
  /// Called when an input file that is mapped into memory became shorter, or its disk failed. Must not return.
  void (*by_lost_input)();
  /// Called when a library has called std::abort(). Must not return. If nullptr, the signal ends the program.
  void (*by_abort)();
};

/// Installs the functions, which are called from now on. Signals that the process ignored before stay ignored.
/// Afterwards, writing a file beyond the size limit of the process fails with an ordinary error, and does not end the
/// process by a signal.
void watch_endings(const Endings& endings) noexcept;

/// Gives freed memory back to the system, if the C library supports that.
void give_back_free_memory() noexcept;

/// Ends the process at once, without destructors. Safe to call in a signal handler. The function is not noexcept: a
/// wasm module ends by an exception of JavaScript, which must pass all callers.
[[noreturn]] void end_now(int exit_code);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_PROCESS_H_
