/// The numbers behind extra targets of low rank: singular vectors of what is missing, and least squares of angles point
/// by point. Private to workflow.
///
/// Shapes     points, rows and stride as MissingNormals has them; extras = columns, in rows of `padded()` floats, of
///            which those beyond extras() are zero.
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_LOW_RANK_FIT_H_
#define CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_LOW_RANK_FIT_H_

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "workflow/bake/fits/missing_normals.h"

namespace chronormal::inline internal {

/// An instant between rows: what any quantity is there, as parabolas have it, follows from three rows.
using PlaceOfRows = CurveNodes::Place;

class LowRankFit {
 public:
  /// Fits are made to all rows and these places, and judged at unseen ones too. All arguments must outlive this.
  LowRankFit(const MissingNormals& missing, std::span<const PlaceOfRows> places, std::span<const PlaceOfRows> unseen);

  /// What is left with so many extra targets, of singular vectors alone: the error in degrees that 99.9 % of pairs of
  /// some points and rows are within, for each count.
  [[nodiscard]] std::vector<double> errors_with(std::span<const std::size_t> extras);

  /// Fits so many extra targets. Points that are beyond some degrees get least squares of their own, and where
  /// own_weights (rows, targets) are given, corrections of the deltas of the mesh's own targets with them.
  void fit(std::size_t extras, double tolerance, std::span<const float> own_weights, std::size_t own_targets);

  [[nodiscard]] std::size_t extras() const noexcept { return extras_; }
  [[nodiscard]] std::size_t padded() const noexcept { return padded_; }
  /// (rows, padded): the weights of the extra targets.
  [[nodiscard]] std::span<const float> weights() const noexcept { return weights_; }
  /// (3, padded): the deltas of a point.
  [[nodiscard]] std::span<const float> deltas(std::size_t point) const {
    return std::span(deltas_).subspan(3 * padded_ * point, 3 * padded_);
  }
  /// (3, own targets): the corrections of a point; empty without own weights.
  [[nodiscard]] std::span<const float> own_deltas(std::size_t point) const {
    return std::span(own_deltas_).subspan(3 * own_targets_ * point, 3 * own_targets_);
  }
  /// How much a point counts.
  [[nodiscard]] float importance(std::size_t point) const { return importance_[point]; }
  /// The largest error of all points, at unseen places too, degrees.
  [[nodiscard]] double worst() const;

 private:
  // A basis at rows and places: (instants, columns), padded, and the same turned round.
  struct Basis {
    std::size_t columns = 0, padded = 0, instants = 0, stride = 0;
    std::vector<float> by_instant, by_column;
  };
  // What a point shows, and should, at rows and places: three planes.
  struct Course {
    std::vector<float> shown, right;
    std::vector<char> is_known;
  };

  void set_first_importance();
  void take_weights(std::span<const double> vectors, std::size_t columns, std::size_t extras);
  void project();
  void measure_rows();
  void measure(std::span<const float> own_weights);
  [[nodiscard]] float error_of(std::size_t point, const Basis& basis, std::span<const PlaceOfRows> places) const;
  [[nodiscard]] std::vector<PlaceOfRows> dips_of(std::size_t point) const;
  [[nodiscard]] Basis basis_of(std::span<const float> own_weights, std::span<const PlaceOfRows> places) const;
  [[nodiscard]] Course course_of(std::size_t point, std::span<const PlaceOfRows> places) const;
  void refit(std::size_t point, const Basis& basis, std::span<const PlaceOfRows> places, double tolerance);

  const MissingNormals& missing_;
  std::span<const PlaceOfRows> places_, unseen_;
  std::size_t extras_ = 0, padded_ = 0, own_targets_ = 0;
  std::vector<float> importance_, errors_;  // of each point
  std::vector<float> weights_, deltas_, own_deltas_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_LOW_RANK_FIT_H_
