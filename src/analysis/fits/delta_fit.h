/// The normal deltas that a viewer should add up, by least squares.
///
/// A viewer shows normalize(N + sum_i w_i D_i) for the weights w. DeltaFit starts from some D, is told for weight vectors
/// of interest how much is missing, and finds what to add to every D so that as little as possible is:
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

/// What a viewer adds up.
struct DeltaNormals {
  std::vector<float> base;          ///< N, (elements, 3)
  std::vector<BlendTarget> deltas;  ///< D_i, of elements in place of vertices
};

/// Writes N + sum_i w_i D_i of all elements: what a viewer shows, of any length.
/// weights must have one for each delta, result one for each element
void shown_normals(const DeltaNormals& deltas, std::span<const double> weights, std::span<Vec3d> result) noexcept;

class DeltaFit {
 public:
  explicit DeltaFit(DeltaNormals start);

  /// The deltas as they are: those of the start, or of the last solve().
  [[nodiscard]] const DeltaNormals& deltas() const noexcept { return deltas_; }

  /// Asks for shown_normals(deltas(), weights) + missing. O(entries of deltas + targets^2).
  /// weights must have one for each delta, missing one for each element
  void add(std::span<const double> weights, std::span<const Vec3d> missing);

  /// Adds to the deltas what makes the sum of |missing|^2 over all rows since the last solve() smallest, for each
  /// element on its own. Where the rows do not tell deltas apart (fewer rows than targets, weights that always go
  /// together), the deltas nearest to those at the start. Cost: for each element a system of as many equations as it
  /// has deltas.
  void solve();

 private:
  DeltaNormals deltas_;
  // The normal equations: one matrix, of which each element has a part, and what is missing for each entry.
  std::vector<double> matrix_;
  std::vector<std::vector<Vec3d>> right_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_DELTA_FIT_H_
