/// Errors of many vertices in many poses: their mean, the worst, and what 99.9 % are below. Private to workflow.
///
/// Units      degrees
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/workflow/bake.h"

namespace chronormal::inline internal {

/// Errors with their spread, to a sixteenth of themselves: how many lie in each sixteenth of an octave.
struct ErrorSpread {
  static constexpr std::size_t kBins = 320;

  std::size_t count = 0;
  double sum = 0, worst = 0;
  std::array<std::size_t, kBins> bins{};

  void add(const ErrorSpread& other);
  /// Adds errors, but for negative ones, which stand for none.
  void add(std::span<const float> errors);
  [[nodiscard]] ShownErrors errors() const;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_
