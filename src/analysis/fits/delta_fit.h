/// Fits the normal deltas that a viewer should add up, by least squares.
///
/// A viewer renders normalize(N + sum_i w_i D_i) for the weights w. DeltaFit starts from given deltas D, gets the
/// differences to the wanted normals for some weight vectors, and then changes every D to minimise the differences:
///
///     DeltaFit fit(start);
///     for (each weight vector w) {
///       shown_normals(fit.deltas(), w, shown);
///       ... missing[e] = wanted normal of e at w - shown[e]
///       fit.add(w, missing);
///     }
///     fit.solve();                       // fit.deltas() are the new ones
///
/// Threads    one call at a time on each object.
#ifndef CHRONORMAL_ANALYSIS_FITS_DELTA_FIT_H_
#define CHRONORMAL_ANALYSIS_FITS_DELTA_FIT_H_

#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// The normals that a viewer adds up.
struct DeltaNormals {
  std::vector<float> base;          ///< N, (elements, 3)
  std::vector<BlendTarget> deltas;  ///< D_i, by elements instead of vertices
};

/// Writes N + sum_i w_i D_i of all elements: the direction that a viewer renders, not normalised. `weights` must have a
/// value for each delta, and `result` a vector for each element
void shown_normals(const DeltaNormals& deltas, std::span<const double> weights, std::span<Vec3d> result) noexcept;

class DeltaFit {
 public:
  explicit DeltaFit(DeltaNormals start);

  /// Returns the present deltas: the ones at the start, or the result of the last solve().
  [[nodiscard]] const DeltaNormals& deltas() const noexcept { return deltas_; }

  /// Adds a row to the fit: with these weights, a viewer should render shown_normals(deltas(), weights) + missing.
  /// O(entries of deltas + targets^2). `weights` must have a value for each delta, and `missing` a vector for each
  /// element
  void add(std::span<const double> weights, std::span<const Vec3d> missing);

  /// Changes the deltas so that the sum of |missing|^2 over all rows since the last solve() is smallest, for each
  /// element separately. If the rows do not determine the deltas (fewer rows than targets, weights that always go
  /// together), the result has the deltas that are nearest to those at the start. Cost: for each element, a linear
  /// system with one equation for each of its deltas.
  void solve();

 private:
  DeltaNormals deltas_;
  // The normal equations: one matrix, of which each element uses a part, and a right-hand side for each entry.
  std::vector<double> matrix_;
  std::vector<std::vector<Vec3d>> right_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_DELTA_FIT_H_
