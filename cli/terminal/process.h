/// Starts and ends the program: prepares its standard streams, and handles the signals that it gets.
///
///     SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU   removes temporary files and prints a line, then the signal ends the
///                                                 program (128 + n to a shell); ignored signals stay ignored
///     SIGBUS                                      an input that is mapped became shorter: removes temporary files,
///                                                 prints a line, and exits with code 1
///     SIGXFSZ                                     ignored: writing beyond the limit is an error like any other
///     no memory for an object                     ends like SIGBUS; destructors do not run (not all are safe)
///     SIGABRT                                     ends like SIGBUS: the C library aborts if it gets no memory for a
///                                                 thread
///     an exception that nothing can catch         ends like SIGBUS
///
/// If results get lost because nobody reads them, as in front of `head`, SIGPIPE ends the program, as usual. If nobody
/// reads stderr, messages get lost, and the program goes on. If SIGPIPE was ignored when the program started, it stays
/// ignored, and writing results that nobody reads is then an error.
#ifndef CLI_TERMINAL_PROCESS_H_
#define CLI_TERMINAL_PROCESS_H_

namespace chronormal::cli {

/// Opens closed standard streams, so that no other file gets their descriptors (0 to 2) and receives their text.
/// Reading and writing these streams still fails. Installs the signal handlers. Makes the floating-point unit of this
/// thread, and of threads that it starts, round to nearest. Must be called before everything else.
void prepare_process() noexcept;

/// Sets a text that is printed after the line about a signal or lack of memory. The text includes its line feed;
/// nullptr means no text. The text must live as long as it may be printed.
void say_at_end(const char* text) noexcept;

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_PROCESS_H_
