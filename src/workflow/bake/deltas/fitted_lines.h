/// Fits the best single deltas of several targets that move the same normal. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_FITTED_LINES_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_FITTED_LINES_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "workflow/bake/deltas/terms.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// Deltas that are fitted for several targets together. Each delta belongs to an element, and is scaled so that |n(0)|
/// is 1. If two targets move an element and are active at the same time somewhere in the file, the deltas of all active
/// targets that move the element are fitted together, by least squares over the weights of the file (docs/theory.md,
/// eq. 44).
///
/// In the fitted poses, neither the largest error nor the mean square error of an element gets larger than with the
/// best delta of each target alone (analysis/fits/end_delta.h). If this is impossible, or if more than 64 targets move
/// the element, each target keeps its best delta alone.
class FittedLines {
 public:
  /// Creates an object that has no deltas.
  FittedLines() = default;
  /// Fits deltas of the elements for which is_shown is true. `largest` has the length of the largest term of each
  /// element. Computes the normals of all elements in 17 to 2,000 poses for the fit, and in more poses for the error.
  /// In addition, an element with k active targets takes some 10 k^2 operations in each pose.
  FittedLines(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
              const std::vector<bool>& is_shown, const std::vector<double>& largest);

  /// Writes the fitted delta that a target has for an element to `delta`. Returns false if there is no fitted delta.
  [[nodiscard]] bool find(std::size_t target, std::uint32_t element, Vec3d& delta) const;
  /// Returns the largest angle that the fitted deltas leave between rendered and true normals, in radians. The angle is
  /// measured at all keys, and at fifteen times between neighbouring keys. If these times are too many, fewer times are
  /// used. If even the keys are too many, only some of the keys are used; the limit depends on the size of the mesh,
  /// and is never above 100,000 keys.
  [[nodiscard]] double largest_error() const noexcept { return largest_error_; }
  /// Returns the number of elements that have fitted deltas.
  [[nodiscard]] std::size_t elements() const noexcept { return elements_; }

 private:
  std::vector<BlendTarget> deltas_;  // for each target, the deltas of elements; vertices stand for elements
  double largest_error_ = 0;
  std::size_t elements_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_FITTED_LINES_H_
