/// Fits the best single deltas of several targets that move the same normal. Private to workflow.
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

/// Deltas of elements, scaled so that |n(0)| is 1. If two targets move an element and are active at the same time
/// somewhere in the file, the deltas of all active targets that move it are fitted together, by least squares to the
/// weights of the file (docs/theory.md, eq. 44).
///
/// The fit never makes the worst error or the mean square of an element larger, over the fitted poses, than the best
/// delta of each target alone (analysis/fits/end_delta.h). If that is impossible, or if more than 64 targets move the
/// element, it keeps the best deltas of each target alone.
class FittedLines {
 public:
  /// Creates an object without deltas.
  FittedLines() = default;
  /// Fits deltas of the elements that are shown; `largest` has the length of the largest term of each element. Cost:
  /// the normals of all elements at 17 to 2,000 poses for the fit, and at more poses for the error; for each element
  /// and pose, some ten times the square of the number of its active targets.
  FittedLines(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
              const std::vector<bool>& is_shown, const std::vector<double>& largest);

  /// Writes the fitted delta of a target for an element, and returns true if there is one.
  [[nodiscard]] bool find(std::size_t target, std::uint32_t element, Vec3d& delta) const;
  /// Returns the largest angle between rendered and true normals, in radians. It is measured at all keys and at fifteen
  /// instants between neighbouring keys. If these are too many, it is measured at fewer instants; if the keys alone are
  /// more than 4,000 to 100,000, at some of the keys.
  [[nodiscard]] double largest_error() const noexcept { return largest_error_; }
  /// Returns the number of elements that have fitted deltas.
  [[nodiscard]] std::size_t elements() const noexcept { return elements_; }

 private:
  std::vector<BlendTarget> deltas_;  // numbered by elements instead of vertices
  double largest_error_ = 0;
  std::size_t elements_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_EXACT_FITTED_LINES_H_
