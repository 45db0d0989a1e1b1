/// Helps to join shards of any kind (chronormal/workflow/shard.h). Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_ERRORS_SHARDS_H_
#define CHRONORMAL_WORKFLOW_ERRORS_SHARDS_H_

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// Sorts the results of segments by the number of the segment. Errors: kUsage unless each of so many segments is there
/// once.
template <class Found>
[[nodiscard]] Status put_in_order(std::size_t segments, std::vector<Found>& found) {
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.segment < b.segment; });
  for (std::size_t s = 0; s < std::max(segments, found.size()); ++s) {
    if (s < found.size() && found[s].segment == s) continue;
    const bool is_twice = s < found.size() && found[s].segment < s;
    return Error{ErrorCode::kUsage, "",
                 "segment " + std::to_string(is_twice ? found[s].segment : s) +
                     (is_twice ? " is in two of the shards" : " is in none of the shards")};
  }
  return Success{};
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_ERRORS_SHARDS_H_
