/// Fits correction targets of low rank (docs/theory.md, section 17). The fit for all points takes singular vectors of
/// the missing normals. Points with large errors get another fit, by least squares of the angles. Private to workflow.
///
/// Shapes     Points, rows and stride are as in MissingNormals. Weights are stored in rows of `padded()` floats. The
///            first extras() floats of a row are weights, and the others are zero.
/// Threads    Uses all cores. The result has the same bits on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FITS_LOW_RANK_FIT_H_
#define CHRONORMAL_WORKFLOW_BAKE_FITS_LOW_RANK_FIT_H_

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "workflow/bake/fits/missing_normals.h"

namespace chronormal::inline internal {

/// An instant between rows. A parabola through the values of three rows gives the values at this instant.
using PlaceOfRows = CurveNodes::Place;

class LowRankFit {
 public:
  /// Prepares a fit to all rows, and to the instants in `places` between rows. Errors are also measured at the unseen
  /// places, which are not fitted. All arguments must outlive this object.
  LowRankFit(const MissingNormals& missing, std::span<const PlaceOfRows> places, std::span<const PlaceOfRows> unseen);

  /// Returns for each number of correction targets in `extras` the error, in degrees, that 99.9 % of the samples do not
  /// exceed if singular vectors alone are used. Measures the errors at some of the points and rows.
  [[nodiscard]] std::vector<double> errors_with(std::span<const std::size_t> extras);

  /// Fits `extras` correction targets. Points with errors beyond the tolerance (degrees) get a fit of their own. If
  /// own_weights (rows, targets) are given, the fit of such a point also corrects the deltas of the mesh's own targets.
  void fit(std::size_t extras, double tolerance, std::span<const float> own_weights, std::size_t own_targets);

  [[nodiscard]] std::size_t extras() const noexcept { return extras_; }
  [[nodiscard]] std::size_t padded() const noexcept { return padded_; }
  /// Returns the weights of the correction targets, (rows, padded).
  [[nodiscard]] std::span<const float> weights() const noexcept { return weights_; }
  /// Returns the deltas of all correction targets for a point, (3, padded).
  [[nodiscard]] std::span<const float> deltas(std::size_t point) const {
    return std::span(deltas_).subspan(3 * padded_ * point, 3 * padded_);
  }
  /// Returns the corrections of the own deltas of a point, (3, own targets). Returns an empty span if fit() got no
  /// own_weights.
  [[nodiscard]] std::span<const float> own_deltas(std::size_t point) const {
    return std::span(own_deltas_).subspan(3 * own_targets_ * point, 3 * own_targets_);
  }
  /// Returns the factor that multiplies the errors of a point in the fit.
  [[nodiscard]] float importance(std::size_t point) const { return importance_[point]; }
  /// Returns the largest error of all points in degrees, at all fitted and unseen instants.
  [[nodiscard]] double worst() const;

 private:
  // The basis of a fit: the vectors whose sums are fitted to the normals of a point. The vectors form an array
  // (instants, columns) for rows and places, with padding. The transposed array is stored too.
  struct Basis {
    std::size_t columns = 0, padded = 0, instants = 0, stride = 0;
    std::vector<float> by_instant, by_column;
  };
  // The rendered and the right normals of one point at rows and places. Each list has three planes: first all x, then
  // all y, then all z.
  struct Course {
    std::vector<float> shown, right;
    std::vector<char> is_known;
  };

  void set_first_importance();
  void take_weights(std::span<const double> vectors, std::size_t columns, std::size_t extras);
  void project();
  void measure_rows();
  void measure(std::span<const float> own_weights, std::span<const std::size_t> points);
  [[nodiscard]] float error_of(std::size_t point, const Basis& basis, std::span<const PlaceOfRows> places) const;
  [[nodiscard]] std::vector<PlaceOfRows> dips_of(std::size_t point) const;
  [[nodiscard]] Basis basis_of(std::span<const float> own_weights, std::span<const PlaceOfRows> places) const;
  [[nodiscard]] Course course_of(std::size_t point, std::span<const PlaceOfRows> places) const;
  void refit(std::size_t point, const Basis& basis, std::span<const PlaceOfRows> places, double tolerance);

  const MissingNormals& missing_;
  std::span<const PlaceOfRows> places_, unseen_;
  std::size_t extras_ = 0, padded_ = 0, own_targets_ = 0;
  std::vector<float> importance_, errors_;  // for each point: its factor in the fit, its largest error
  std::vector<float> weights_, deltas_, own_deltas_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FITS_LOW_RANK_FIT_H_
