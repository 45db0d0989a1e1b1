/// Errors of many vertices in many poses: their mean, the worst, and the bound of 99.9 %. Private to workflow.
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

/// The distribution of errors, to a sixteenth of themselves: it counts the errors in each sixteenth of an octave.
struct ErrorSpread {
  static constexpr std::size_t kBins = 320;

  std::size_t count = 0;
  double sum = 0, worst = 0;
  std::array<std::size_t, kBins> bins{};

  void add(const ErrorSpread& other);
  /// Adds errors. Negative ones stand for missing errors, and are skipped.
  void add(std::span<const float> errors);
  [[nodiscard]] ShownErrors errors() const;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_
