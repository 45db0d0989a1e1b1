/// Shows a progress bar on stderr. It appears only on a terminal and only after a moment, and is removed when the work
/// is done.
///
///     comparing [=========               ]  38 %, 12.5 segments/s, 3 min 20 s left
///
/// Rate and time left are measured from the first report of progress, so that work of an earlier run counts as done but
/// does not raise the rate. Rate and time left appear after one second.
#ifndef CLI_TERMINAL_PROGRESS_H_
#define CLI_TERMINAL_PROGRESS_H_

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace chronormal::cli {

/// Returns the rate and the time left: "12.5 segments/s, 3 min 20 s left". The task has `count` steps, which are called
/// `things`, such as "segments". The fraction share_done of the steps took `seconds`, and the fraction share_left is
/// left. If `things` is empty, returns only the time.
[[nodiscard]] std::string pace_text(double share_done, double seconds, double share_left, std::size_t count,
                                    const std::string& things);

class Progress {
 public:
  /// Creates a bar. It shows nothing if `quiet` is true or stderr is not a terminal.
  explicit Progress(bool quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Returns true if the user asked for no output except warnings.
  [[nodiscard]] bool is_quiet() const noexcept { return is_quiet_; }

  /// Returns a function by which the library reports progress. This object must outlive the function. The bar shows a
  /// rate in `things`, of which the whole task has `count`. If `count` is 0, the steps that the library reports are
  /// counted instead. If `things` is empty, the bar shows no rate.
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
    // The time at the first report of progress, and the share of the work that was done then.
    Clock::time_point start = {};
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
