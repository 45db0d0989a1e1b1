#include "cli/terminal/text.h"

#include <algorithm>
#include <cstdint>
#include <vector>
#include "cli/terminal/format.h"
namespace chronormal::cli {

std::size_t width_of(std::string_view text) noexcept {
  std::size_t width = 0;
  bool is_mark = false;
  for (const char c : text) {
    is_mark = is_mark || c == '\033';
    width += !is_mark && (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1U : 0U;
    is_mark = is_mark && c != 'm';
  }
  return width;
}

}  // namespace chronormal::cli
