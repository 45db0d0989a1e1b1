/// The loop that all questions share: one result for each part of a segment.
#ifndef CHRONORMAL_WORKFLOW_QUERY_PARTS_H_
#define CHRONORMAL_WORKFLOW_QUERY_PARTS_H_

#include <algorithm>
#include <span>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/workflow/query.h"

namespace chronormal::inline internal {

/// Calls answer(part) for every part, on all cores, and returns the results in the order of the parts.
template <class T, class Answer>
[[nodiscard]] std::vector<T> for_parts(std::span<const SegmentPart> parts, const QueryProgress& progress,
                                       const Answer& answer) {
  std::vector<T> results(parts.size());
  const std::size_t wave = std::max<std::size_t>(thread_count(), 1);
  for (std::size_t first = 0; first < parts.size(); first += wave) {
    const std::size_t count = std::min(wave, parts.size() - first);
    parallel_for(count, [&](std::size_t i) { results[first + i] = answer(parts[first + i]); });
    if (progress) progress(first + count, parts.size());
  }
  return results;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_QUERY_PARTS_H_
