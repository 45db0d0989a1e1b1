#include "cli/terminal/progress.h"

#include <unistd.h>

#include <utility>

#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/screen.h"

namespace chronormal::cli {
namespace {

constexpr std::chrono::milliseconds kPatience{300};
constexpr int kWidth = 40;

}  // namespace

Progress::Progress(bool quiet)
    : enabled_(!quiet && isatty(STDERR_FILENO) != 0 && !is_dumb_terminal()), start_(std::chrono::steady_clock::now()) {}

std::function<void(std::size_t, std::size_t)> Progress::callback(std::string label) {
  if (!enabled_) return {};
  return [this, label = std::move(label)](std::size_t done, std::size_t total) { show(label, done, total); };
}

void Progress::show(const std::string& label, std::size_t done, std::size_t total) {
  if (total == 0 || std::chrono::steady_clock::now() - start_ < kPatience) return;
  const double share = static_cast<double>(done) / static_cast<double>(total);
  const int percent = static_cast<int>(100 * share), filled = static_cast<int>(kWidth * share);
  if (percent == last_percent_) return;
  last_percent_ = percent;
  visible_ = true;
  say_raw(formatted("\r{} [{:=<{}}{:<{}}] {:3} %", label, "", filled, "", kWidth - filled, percent));
}

void Progress::clear() {
  if (visible_) say_raw("\r\033[K");
  visible_ = false;
  last_percent_ = -1;
}

}  // namespace chronormal::cli
