#include "cli/terminal/progress.h"

#include <cmath>
#include <utility>

#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "io/system/files.h"
#include "io/system/terminal.h"

namespace chronormal::cli {
namespace {

constexpr std::chrono::milliseconds kPatience{300}, kLeastForPace{1000}, kRedrawn{1000};
constexpr int kWidth = 24;

// Returns a duration in at most two units: "45 s", "3 min 20 s", "2 h 5 min".
std::string duration_text(double seconds) {
  constexpr double kMost = 1e7;
  const auto whole = static_cast<std::size_t>(std::fmin(std::ceil(seconds), kMost));
  if (whole < 60) return formatted("{} s", whole);
  if (whole < 3600) return formatted("{} min {} s", whole / 60, whole % 60);
  return formatted("{} h {} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string pace_text(double share_done, double seconds, double share_left, std::size_t count,
                      const std::string& things) {
  std::string text;
  const double rate = share_done * static_cast<double>(count) / seconds;
  if (!things.empty() && rate >= 1)
    text = formatted("{:.1f} {}/s, ", rate, things);
  else if (!things.empty())
    text = formatted("{:.1f} {}/min, ", 60 * rate, things);
  return text + duration_text(share_left / share_done * seconds) + " left";
}

Progress::Progress(bool quiet)
    : is_quiet_(quiet), enabled_(!quiet && is_clever_terminal(kStandardError)), start_(Clock::now()) {}

std::function<void(std::size_t, std::size_t)> Progress::callback(std::string label, std::string things,
                                                                 std::size_t count) {
  if (!enabled_) return {};
  return [this, work = Work{std::move(label), std::move(things), count}](std::size_t done, std::size_t total) mutable {
    show(work, done, total);
  };
}

void Progress::show(Work& work, std::size_t done, std::size_t total) {
  if (total == 0) return;
  const Clock::time_point now = Clock::now();
  const double share = static_cast<double>(done) / static_cast<double>(total);
  if (work.done_at_start < 0) {
    work.start = now;
    work.done_at_start = share;
  }
  if (now - start_ < kPatience) return;
  const int percent = static_cast<int>(100 * share), filled = static_cast<int>(kWidth * share);
  if (percent == last_percent_ && now - shown_ < kRedrawn) return;
  last_percent_ = percent;
  shown_ = now;
  visible_ = true;
  std::string pace;
  if (now - work.start >= kLeastForPace && share > work.done_at_start && share < 1) {
    const double seconds = std::chrono::duration<double>(now - work.start).count();
    pace = ", " +
           pace_text(share - work.done_at_start, seconds, 1 - share, work.count > 0 ? work.count : total, work.things);
  }
  say_raw(formatted("\r{} [{:=<{}}{:<{}}] {:3} %{}\033[K", work.label, "", filled, "", kWidth - filled, percent, pace));
}

void Progress::clear() {
  if (visible_) say_raw("\r\033[K");
  visible_ = false;
  last_percent_ = -1;
}

}  // namespace chronormal::cli
