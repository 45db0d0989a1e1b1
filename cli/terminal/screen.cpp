#include "cli/terminal/screen.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "core/charconv.h"
#include "io/system/files.h"
#include "io/system/terminal.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kUsualColumns = 80, kLeastColumns = 40;

// Control sequences that select bold and colours (Select Graphic Rendition, ECMA-48, section 8.3.117).
constexpr std::string_view kBold = "\033[1m", kBoldRed = "\033[1;31m", kBoldYellow = "\033[1;33m", kUsual = "\033[0m";

std::string_view environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string marked(std::string_view mark, std::string_view text) {
  return text.empty() ? "" : std::string(mark).append(text).append(kUsual);
}

}  // namespace

std::size_t columns_of_output() {
  std::size_t columns = 0;
  const std::string_view given = environment("COLUMNS");
  from_chars(given.data(), given.data() + given.size(), columns);
  if (columns == 0) columns = columns_of_terminal(kStandardOutput);
  return columns == 0 ? kUsualColumns : std::max(columns, kLeastColumns);
}

bool shows_colour(int stream) {
  if (!environment("NO_COLOR").empty()) return false;
  const std::string_view forced = environment("CLICOLOR_FORCE");
  if (!forced.empty() && forced != "0") return true;
  return has_colours(stream);
}

std::string heading(std::string_view text) { return marked(kBold, text); }
std::string alarming(std::string_view text) { return marked(kBoldRed, text); }
std::string warning(std::string_view text) { return marked(kBoldYellow, text); }

std::string plain(std::string_view text) {
  std::string result;
  bool is_mark = false;
  for (const char c : text) {
    is_mark = is_mark || c == '\033';
    if (!is_mark) result += c;
    is_mark = is_mark && c != 'm';
  }
  return result;
}

std::string with_headings(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    const bool is_heading = !line.starts_with(' ') && line.ends_with(':');
    result.append(is_heading ? heading(line) : std::string(line));
    if (end < text.size()) result += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

}  // namespace chronormal::cli
