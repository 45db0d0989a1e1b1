/// How the program lives and ends: its standard streams, and the signals that it gets.
///
///     SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU   temporary files are removed, a line is said, and the signal ends the
///                                                 program (128 + n to a shell); those that are ignored stay ignored
///     SIGBUS                                      an input that is mapped became shorter: the same, with exit code 1
///     SIGXFSZ                                     ignored: writing beyond the limit is an error like any other
///     no memory for an object                     the same; nothing is unwound, since not all that libraries do is safe then
///     SIGABRT                                     the same: the C library aborts where it gets no memory for a thread
///     an exception where none may be              removes temporary files, and exit code 1
///
/// SIGPIPE ends the program as it ends every other one where data were asked for, as in front of `head`. Where nobody
/// reads stderr, what is said gets lost, and nothing else changes. Where SIGPIPE is ignored already, it stays ignored:
/// writing data is an error then.
#ifndef CLI_TERMINAL_PROCESS_H_
#define CLI_TERMINAL_PROCESS_H_

namespace chronormal::cli {

/// Opens what is closed of stdin, stdout and stderr, so that no file takes their place and gets what is meant for them:
/// reading and writing there stays an error. Installs the handlers. Has the floating point unit of this thread, and of
/// those that it starts, round to nearest. To be called first of all.
void prepare_process() noexcept;

/// What is said after the line of a signal or of memory that ran out, with its line feed; nullptr for nothing. The text
/// must live as long as it may be said.
void say_at_end(const char* text) noexcept;

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_PROCESS_H_
