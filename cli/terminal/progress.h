/// A progress bar on stderr: only on a terminal, only after a moment, and gone when the work is done.
#ifndef CLI_TERMINAL_PROGRESS_H_
#define CLI_TERMINAL_PROGRESS_H_

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace chronormal::cli {

class Progress {
 public:
  /// Shows nothing if quiet, or if stderr is not a terminal.
  explicit Progress(bool quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// A function for the library to tell how far it is. The Progress must outlive it.
  [[nodiscard]] std::function<void(std::size_t done, std::size_t total)> callback(std::string label);

  /// Removes the bar from the screen.
  void clear();

 private:
  void show(const std::string& label, std::size_t done, std::size_t total);

  bool enabled_;
  bool visible_ = false;
  int last_percent_ = -1;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_PROGRESS_H_
