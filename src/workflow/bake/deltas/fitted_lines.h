/// The best single deltas of targets that move a normal together. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_EXACT_FITTED_LINES_H_
#define CHRONORMAL_WORKFLOW_BAKE_EXACT_FITTED_LINES_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "workflow/bake/deltas/terms.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// Deltas of elements for which |n(0)| is 1: where two targets move an element and are active at once somewhere in the
/// file, those of all active targets that move it, fitted together by least squares to the weights of the file
/// (docs/theory.md, eq. 44). Over the poses that were fitted to no element is off by more than with the best delta of
/// each target alone (analysis/fits/end_delta.h), neither at worst nor in the square mean; where that cannot be had it
/// keeps those, as it does where more than 64 targets move it.
class FittedLines {
 public:
  /// Has no deltas.
  FittedLines() = default;
  /// Fits deltas of the elements that are shown, of which `largest` are the lengths of the largest terms. Cost: the
  /// normals of all elements at 17 to 2,000 poses to fit to and more to state the error at, and for each element and
  /// pose some ten times the square of its active targets.
  FittedLines(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
              const std::vector<bool>& is_shown, const std::vector<double>& largest);

  /// Whether a target has a fitted delta for an element; then that.
  [[nodiscard]] bool find(std::size_t target, std::uint32_t element, Vec3d& delta) const;
  /// The largest angle between what is shown and the right normals, radians: at keys and fifteen instants between any
  /// two, or where these are too many, at fewer, and at some of the keys where even these are more than 4,000 to
  /// 100,000.
  [[nodiscard]] double largest_error() const noexcept { return largest_error_; }
  /// How many elements have fitted deltas.
  [[nodiscard]] std::size_t elements() const noexcept { return elements_; }

 private:
  std::vector<BlendTarget> deltas_;  // of elements in place of vertices
  double largest_error_ = 0;
  std::size_t elements_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_EXACT_FITTED_LINES_H_
