/// A progress bar on stderr: only on a terminal, only after a moment, and removed when the work is done.
///
///     comparing [=========               ]  38 %, 12.5 segments/s, 3 min 20 s left
///
/// Rate and time left are measured from the first report of progress, so that work of an earlier run counts as done but
/// does not raise the rate. They are shown after a few seconds.
#ifndef CLI_TERMINAL_PROGRESS_H_
#define CLI_TERMINAL_PROGRESS_H_

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace chronormal::cli {

/// Returns the rate and the time left, "12.5 segments/s, 3 min 20 s left". The shares are fractions of `count` things:
/// share_done took this many seconds, and share_left is left. If `things`, the name of the things, is empty, returns
/// only the time.
[[nodiscard]] std::string pace_text(double share_done, double seconds, double share_left, std::size_t count,
                                    const std::string& things);

class Progress {
 public:
  /// Creates a bar that shows nothing if quiet, or if stderr is not a terminal.
  explicit Progress(bool quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Returns true if only warnings are printed.
  [[nodiscard]] bool is_quiet() const noexcept { return is_quiet_; }

  /// Returns a function by which the library reports progress. The Progress must outlive it. The bar shows a rate in
  /// `things`, of which there are `count` in the whole task; if `count` is 0, the steps that the library reports are
  /// the things. Without a name of things, the bar shows no rate.
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
    Clock::time_point start = {};  // time and progress at the first report
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
