/// Declares the loop over parts of segments that all queries use, and limits on the size of an answer. A part is the
/// range of t in one segment about which the caller asks.
#ifndef CHRONORMAL_WORKFLOW_QUERY_PARTS_H_
#define CHRONORMAL_WORKFLOW_QUERY_PARTS_H_

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/query.h"
#include "core/text.h"
#include "io/bytes/expansion.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::inline internal {

/// Returns the limit on the size of an answer to a query.
[[nodiscard]] inline Expansion expansion_of(const QuerySpan& span) {
  return span.expansion != nullptr ? *span.expansion : Expansion::unlimited();
}

/// Checks that the answer is within the limit if it has rows_of_part rows for every part: one row for each face, vertex
/// or corner. A row takes bytes_per_row bytes. Errors: those of Expansion::check().
[[nodiscard]] inline Status check_rows(std::size_t rows_of_part, std::string_view what,
                                       std::span<const SegmentPart> parts, std::uint64_t bytes_per_row,
                                       const QuerySpan& span) {
  const std::uint64_t rows = std::uint64_t{parts.size()} * rows_of_part;
  return expansion_of(span).check(bytes_per_row * rows,
                                  "the answer for every " + std::string(what) + " of every segment");
}

/// Returns the meaning of a fact in the right number: `one` for the count 1, and `several` for all other counts.
template <class Count>
[[nodiscard]] std::string worded(Count count, std::string_view one, std::string_view several) {
  return std::string(count == 1 ? one : several);
}

/// The vertices or corners about whose normals the caller asks. Each output has a vertex and an element. The element is
/// the group of faces that determine the normal of the output.
class AskedOutputs {
 public:
  /// Groups the corners of a motion into elements, as the options tell. Errors: those of make_groups().
  [[nodiscard]] static Result<AskedOutputs> make(const Motion& motion, const ElementOptions& options) {
    Result<NormalGroups> groups = make_groups(motion, options);
    if (!groups) return groups.error();
    return AskedOutputs(motion.topology, std::move(groups).value());
  }

  [[nodiscard]] std::size_t size() const noexcept { return groups_.element_of_output().size(); }
  [[nodiscard]] std::size_t element_count() const noexcept { return groups_.size(); }
  [[nodiscard]] std::size_t element(std::size_t output) const noexcept { return groups_.element_of_output()[output]; }
  [[nodiscard]] std::uint32_t vertex(std::size_t output) const noexcept {
    return groups_.outputs_are_vertices() ? static_cast<std::uint32_t>(output) : topology_->corners()[output];
  }
  /// Returns the faces of an element. Isolated vertices have no faces.
  [[nodiscard]] std::span<const std::uint32_t> faces(std::size_t element) const noexcept {
    return groups_.faces(element);
  }

 private:
  AskedOutputs(const Topology& topology, NormalGroups groups) : topology_(&topology), groups_(std::move(groups)) {}

  const Topology* topology_;
  NormalGroups groups_;
};

/// Checks, while an answer grows, that the size of the answer stays within the limit. Serves answers whose length is
/// known only at the end. The written answer may be slightly larger, so the writer checks the size once more.
class RowsInBounds {
 public:
  explicit RowsInBounds(const Expansion& expansion) noexcept : expansion_(expansion) {}

  /// Adds the bytes of another part of a segment. The message of an error states that `done` of `total` parts are
  /// finished. Errors: those of Expansion::check(), as soon as the sum is too large.
  [[nodiscard]] Status add(std::uint64_t bytes, std::size_t done, std::size_t total) {
    bytes_ += bytes;
    return expansion_.check(
        bytes_, "the answer, after " + std::to_string(done) + " of " + counted(total, "segment", "segments"));
  }

 private:
  const Expansion& expansion_;
  std::uint64_t bytes_ = 0;
};

/// Calls answer(part) for every part of a segment in `parts`, on all cores, and returns the results in the order of the
/// parts. Each round handles as many parts as there are threads. After each round, the sum of bytes_of(result) is
/// compared with the limit on the size of the answer. Errors: those of RowsInBounds::add().
template <class T, class Answer, class BytesOf>
[[nodiscard]] Result<std::vector<T>> for_bounded_parts(std::span<const SegmentPart> parts, const QuerySpan& span,
                                                       const QueryProgress& progress, const Answer& answer,
                                                       const BytesOf& bytes_of) {
  std::vector<T> results(parts.size());
  const Expansion expansion = expansion_of(span);
  RowsInBounds rows(expansion);
  SegmentRun run;
  run.progress = progress;
  run.begin(parts.size());
  const Status answered =
      run.over(run.share(), std::max<std::size_t>(thread_count(), 1), [&](IndexRange some) -> Status {
        parallel_for(some.count, [&](std::size_t i) { results[some.first + i] = answer(parts[some.first + i]); });
        for (std::size_t i = some.first; i < some.end(); ++i)
          if (Status status = rows.add(bytes_of(results[i]), i + 1, parts.size()); !status) return status;
        return Success{};
      });
  if (!answered) return answered.error();
  return results;
}

/// Calls answer(part) for every part, on all cores, and returns the results in the order of the parts. Does not check
/// the size of the results, so the caller must have called check_rows() before.
template <class T, class Answer>
[[nodiscard]] std::vector<T> for_parts(std::span<const SegmentPart> parts, const QueryProgress& progress,
                                       const Answer& answer) {
  return for_bounded_parts<T>(parts, {}, progress, answer, [](const T&) { return std::uint64_t{0}; }).value();
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_QUERY_PARTS_H_
