/// Runs a program in a shell, and returns its output and its exit code.
#ifndef TESTS_SUPPORT_PROCESS_H_
#define TESTS_SUPPORT_PROCESS_H_

#include <string>

namespace chronormal {

struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal if a signal ended the command
  std::string out;     ///< standard output
  std::string err;     ///< standard error
};

/// Runs a shell command in a folder, with `input` as its standard input.
[[nodiscard]] ProcessResult run_shell(const std::string& command, const std::string& folder,
                                      const std::string& input = "");

}  // namespace chronormal

#endif  // TESTS_SUPPORT_PROCESS_H_
