/// A progress bar on stderr: only on a terminal, only after a moment, and gone when the work is done.
///
///     comparing [=========               ]  38 %, 12.5 segments/s, 3 min 20 s left
///
/// Rate and time left are those since the work was heard of first, so that what an earlier run did counts as done and
/// not as fast. They are shown after a few seconds.
#ifndef CLI_TERMINAL_PROGRESS_H_
#define CLI_TERMINAL_PROGRESS_H_

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace chronormal::cli {

/// "12.5 segments/s, 3 min 20 s left" for a share that was done in so many seconds, and a share that is left, of so
/// many things; without a name of things, the time alone.
[[nodiscard]] std::string pace_text(double share_done, double seconds, double share_left, std::size_t count,
                                    const std::string& things);

class Progress {
 public:
  /// Shows nothing if quiet, or if stderr is not a terminal.
  explicit Progress(bool quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Returns whether it was made quiet: then nothing else is said either that is no warning.
  [[nodiscard]] bool is_quiet() const noexcept { return is_quiet_; }

  /// A function for the library to tell how far it is. The Progress must outlive it. The rate is that of so many
  /// things of this name, whatever the library counts; with a count of 0 it is that of what the library counts, and
  /// there is none without a name.
  [[nodiscard]] std::function<void(std::size_t done, std::size_t total)> callback(std::string label,
                                                                                  std::string things = {},
                                                                                  std::size_t count = 0);

  /// Removes the bar from the screen.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  struct Work {
    std::string label, things;
    std::size_t count = 0;
    Clock::time_point start = {};  // when it was heard of first, and how much was done then
    double done_at_start = -1;
  };

  void show(Work& work, std::size_t done, std::size_t total);

  bool is_quiet_, enabled_;
  bool visible_ = false;
  int last_percent_ = -1;
  Clock::time_point start_, shown_ = {};
};

}  // namespace chronormal::cli

#endif  // CLI_TERMINAL_PROGRESS_H_
