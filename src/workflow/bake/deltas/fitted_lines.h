/// Fits the best single deltas of targets that move a normal together. Private to workflow.
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

/// Deltas of elements for which |n(0)| is 1. If two targets move an element and are active at once somewhere in the
/// file, the deltas of all active targets that move it are fitted together, by least squares to the weights of the file
/// (docs/theory.md, eq. 44). Over the poses that are fitted to, no element gets a larger worst error or mean square
/// than with the best delta of each target alone (analysis/fits/end_delta.h); an element for which that is impossible
/// keeps those, and so does one that more than 64 targets move.
class FittedLines {
 public:
  /// Has no deltas.
  FittedLines() = default;
  /// Fits deltas of the elements that are shown; `largest` has the lengths of their largest terms. Cost: the normals of
  /// all elements at 17 to 2,000 poses to fit to, and at more poses to state the error; and for each element and pose
  /// some ten times the square of its active targets.
  FittedLines(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
              const std::vector<bool>& is_shown, const std::vector<double>& largest);

  /// Returns whether a target has a fitted delta for an element, and writes it.
  [[nodiscard]] bool find(std::size_t target, std::uint32_t element, Vec3d& delta) const;
  /// Returns the largest angle between rendered and right normals, in radians: at keys and fifteen instants between any
  /// two; if these are too many, at fewer, and if even the keys are more than 4,000 to 100,000, at some of them.
  [[nodiscard]] double largest_error() const noexcept { return largest_error_; }
  /// Returns the number of elements that have fitted deltas.
  [[nodiscard]] std::size_t elements() const noexcept { return elements_; }

 private:
  std::vector<BlendTarget> deltas_;  // by elements instead of vertices
  double largest_error_ = 0;
  std::size_t elements_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_EXACT_FITTED_LINES_H_
