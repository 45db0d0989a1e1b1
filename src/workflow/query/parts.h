/// The loop that all queries share, with one result for each part of a segment, and limits on the size of an answer.
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
#include "io/bytes/expansion.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::inline internal {

/// Returns the limit on the size of an answer.
[[nodiscard]] inline Expansion expansion_of(const QuerySpan& span) {
  return span.expansion != nullptr ? *span.expansion : Expansion::unlimited();
}

/// Checks that the limit allows an answer with rows of bytes_per_row bytes: one for every face, vertex or corner of
/// every part. Errors: of Expansion::check().
[[nodiscard]] inline Status check_rows(std::size_t rows_of_part, std::string_view what,
                                       std::span<const SegmentPart> parts, std::uint64_t bytes_per_row,
                                       const QuerySpan& span) {
  const std::uint64_t rows = std::uint64_t{parts.size()} * rows_of_part;
  return expansion_of(span).check(bytes_per_row * rows,
                                  "the answer for every " + std::string(what) + " of every segment");
}

/// The vertices or corners whose normals are requested. Each has a vertex, and an element: the faces that determine its
/// normal.
class AskedOutputs {
 public:
  /// Groups the corners of a motion by the options. Errors: of make_groups()
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
  /// The faces of an element; none for isolated vertices.
  [[nodiscard]] std::span<const std::uint32_t> faces(std::size_t element) const noexcept {
    return groups_.faces(element);
  }

 private:
  AskedOutputs(const Topology& topology, NormalGroups groups) : topology_(&topology), groups_(std::move(groups)) {}

  const Topology* topology_;
  NormalGroups groups_;
};

/// A check that an answer of unknown length stays within the limit of its span while it grows. The written answer may
/// be slightly larger, so the writer checks it once more.
class RowsInBounds {
 public:
  explicit RowsInBounds(const Expansion& expansion) noexcept : expansion_(expansion) {}

  /// Adds the bytes of another part, number `done` of `total`. Errors: those of Expansion::check(), as soon as the sum
  /// is too large.
  [[nodiscard]] Status add(std::uint64_t bytes, std::size_t done, std::size_t total) {
    bytes_ += bytes;
    return expansion_.check(bytes_,
                            "the answer, after " + std::to_string(done) + " of " + std::to_string(total) + " segments");
  }

 private:
  const Expansion& expansion_;
  std::uint64_t bytes_ = 0;
};

/// Calls answer(part) for every part, on all cores, and returns the results in the order of the parts. Each round
/// handles as many parts as there are threads, and then checks the sum of bytes_of(result) against the limit. Errors:
/// those of RowsInBounds::add().
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

/// Calls answer(part) for every part, like for_bounded_parts(), but without its check of the size: check_rows() must
/// have limited the answer already.
template <class T, class Answer>
[[nodiscard]] std::vector<T> for_parts(std::span<const SegmentPart> parts, const QueryProgress& progress,
                                       const Answer& answer) {
  return for_bounded_parts<T>(parts, {}, progress, answer, [](const T&) { return std::uint64_t{0}; }).value();
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_QUERY_PARTS_H_
