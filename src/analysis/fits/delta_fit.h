/// Fits the normal deltas that a viewer should add up, by least squares.
///
/// A viewer renders normalize(N + sum_i w_i D_i) for the weights w. DeltaFit starts from given deltas D. For some
/// weight vectors, the caller gives the difference between the wanted and the rendered normals. DeltaFit then changes
/// every D so that these differences become as small as possible:
///
///     DeltaFit fit(start);
///     for (each weight vector w) {
///       shown_normals(fit.deltas(), w, shown);
///       ... missing[e] = wanted normal of e at w - shown[e]
///       fit.add(w, missing);
///     }
///     fit.solve();                       // fit.deltas() are the new deltas
///
/// Threads    one call at a time on each object.
#ifndef CHRONORMAL_ANALYSIS_FITS_DELTA_FIT_H_
#define CHRONORMAL_ANALYSIS_FITS_DELTA_FIT_H_

#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// The base normals and the deltas of normals that a viewer adds up.
struct DeltaNormals {
  std::vector<float> base;          ///< N of each element, (elements, 3)
  std::vector<BlendTarget> deltas;  ///< D_i of each target; its `vertices` are numbers of elements
};

/// Writes N + sum_i w_i D_i of all elements. The sum has the direction that a viewer renders, and is not scaled to
/// length 1. Preconditions: `weights` has a value for each target, and `result` a vector for each element.
void shown_normals(const DeltaNormals& deltas, std::span<const double> weights, std::span<Vec3d> result) noexcept;

class DeltaFit {
 public:
  explicit DeltaFit(DeltaNormals start);

  /// Returns the present deltas, which are the start deltas until the first solve(), and then the result of the last
  /// solve().
  [[nodiscard]] const DeltaNormals& deltas() const noexcept { return deltas_; }

  /// Adds a row to the fit: with the weights `weights`, a viewer should render shown_normals(deltas(), weights) +
  /// missing. O(entries of deltas + targets^2). Preconditions: `weights` has a value for each target, and `missing` a
  /// vector for each element.
  void add(std::span<const double> weights, std::span<const Vec3d> missing);

  /// Changes the deltas so that the sum of |missing|^2 over all rows since the last solve() becomes as small as
  /// possible, for each element separately. If there are fewer rows than targets, or if some weights always change
  /// together, the rows may leave deltas undetermined. The result then has those deltas that are nearest to the start
  /// deltas. Cost: for each element, a linear system with one equation for each of its deltas.
  void solve();

 private:
  DeltaNormals deltas_;
  // The normal equations of all elements. matrix_ has a row and a column for each target, and each element uses the
  // part for its own targets. right_ has a right-hand side for each delta.
  std::vector<double> matrix_;
  std::vector<std::vector<Vec3d>> right_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_DELTA_FIT_H_
