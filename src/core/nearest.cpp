#include "core/nearest.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace chronormal::inline internal {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last,
      // The rows of the table of edit distances between prefixes of `a` and prefixes of `b`. Each row is for one prefix
      // of `a`: `row` for the present prefix, `last` for the prefix one letter shorter, `before` for the prefix two
      // letters shorter.
      row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({last[j] + (a[i] == b[j] ? 0 : 1), last[j + 1] + 1, row[j] + 1});
      const bool are_swapped = i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j];
      if (are_swapped) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row.back();
}

std::string nearest_name(std::string_view word, std::span<const std::string> names) {
  constexpr std::size_t kShortest = 3, kLong = 5, kLongest = 32;
  if (word.size() > kLongest) return "";
  std::size_t least = word.size() < kShortest ? 1 : word.size() < kLong ? 2 : 3;  // a distance must be less than this
  std::string nearest;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(word, name);
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return nearest;
}

}  // namespace chronormal::inline internal
