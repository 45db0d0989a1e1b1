/// Removes from a list the values that are not kept. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_KEEP_ONLY_H_
#define CHRONORMAL_WORKFLOW_REPORT_KEEP_ONLY_H_

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace chronormal::inline internal {

/// Removes groups of `width` consecutive values. Group i stays if kept[i] is true. The order of the values is kept.
/// `kept` may have more entries than there are groups.
template <class T>
void keep_only(const std::vector<bool>& kept, std::size_t width, std::vector<T>& values) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < kept.size() && width * i < values.size(); ++i) {
    if (!kept[i]) continue;
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(width * i);
    const auto to = values.begin() + static_cast<std::ptrdiff_t>(width * count++);
    if (from != to) std::move(from, from + static_cast<std::ptrdiff_t>(width), to);
  }
  values.resize(width * count);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_KEEP_ONLY_H_
