/// Errors of many vertices in many poses, gathered on all threads: their mean, the worst, and what 99.9 % are below. Private
/// to workflow.
///
/// Units      degrees
/// Threads    GatheredErrors::add() may be called for several vertices at once; the results are the same bits in any case.
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/workflow/bake.h"

namespace chronormal::inline internal {

/// Errors with their spread, to a sixteenth of themselves: how many lie in each sixteenth of an octave.
struct ErrorSpread {
  static constexpr std::size_t kBins = 320;

  std::size_t count = 0;
  double sum = 0, worst = 0;
  std::array<std::size_t, kBins> bins{};

  void add(const ErrorSpread& other);
  [[nodiscard]] ShownErrors errors() const;
};

/// The same while it is gathered: numbers of vertices, which are added up in their order, and counts, for which the order
/// does not matter.
struct GatheredErrors {
  explicit GatheredErrors(std::size_t vertices) : sum(vertices), worst(vertices), counts(vertices) {}

  /// Adds the errors of a vertex in some poses, but for those for which `known` is negative.
  void add(std::size_t vertex, std::span<const float> errors, std::span<const float> known);
  [[nodiscard]] ErrorSpread spread() const;

  std::vector<float> sum, worst;
  std::vector<std::uint32_t> counts;
  std::array<std::atomic<std::size_t>, ErrorSpread::kBins> bins{};
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_
