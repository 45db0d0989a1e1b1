/// Errors of many vertices in many poses: their mean, their largest value, and the value that 99.9 % of them do not
/// exceed. Private to workflow.
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

/// The distribution of errors as a histogram with sixteen bins for each factor of two, so a value is known to a
/// sixteenth.
struct ErrorSpread {
  static constexpr std::size_t kBins = 320;

  std::size_t count = 0;
  double sum = 0, worst = 0;
  std::array<std::size_t, kBins> bins{};

  void add(const ErrorSpread& other);
  /// Adds errors. Skips negative values, which mean that there is no error to judge.
  void add(std::span<const float> errors);
  [[nodiscard]] ShownErrors errors() const;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_
