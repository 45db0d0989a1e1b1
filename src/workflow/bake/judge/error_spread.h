/// Counts the errors of many vertices in many poses. From the counts follow the mean error, the largest error, and the
/// error that 99.9 % of the samples do not exceed. Private to workflow.
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

/// The distribution of errors as a histogram. Each factor of two in the error has sixteen bins, so an error is known to
/// a sixteenth of its value.
struct ErrorSpread {
  static constexpr std::size_t kBins = 320;

  std::size_t count = 0;
  double sum = 0, worst = 0;
  std::array<std::size_t, kBins> bins{};

  void add(const ErrorSpread& other);
  /// Adds errors. Skips negative values, which stand for vertices that are not judged.
  void add(std::span<const float> errors);
  [[nodiscard]] ShownErrors errors() const;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_ERROR_SPREAD_H_
