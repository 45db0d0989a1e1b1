/// The loop that all questions share: one result for each part of a segment.
#ifndef CHRONORMAL_WORKFLOW_QUERY_PARTS_H_
#define CHRONORMAL_WORKFLOW_QUERY_PARTS_H_

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/workflow/query.h"

namespace chronormal::inline internal {

/// Whether an answer may have a row of so many bytes for every face of every part. Errors: of Expansion::check().
[[nodiscard]] inline Status check_rows(const Motion& motion, std::span<const SegmentPart> parts,
                                       std::uint64_t bytes_per_row, const QuerySpan& span) {
  const std::uint64_t rows = std::uint64_t{parts.size()} * motion.topology.face_count();
  return span.expansion.check(bytes_per_row * rows, "the answer for every face of every segment");
}

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
