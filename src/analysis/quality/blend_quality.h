/// Measures the error of normals in viewers that add one normal delta per target, at any weights.
///
/// A viewer renders normalize(N + sum_i w_i D_i). The true normal is a quadratic form in the weights (docs/theory.md,
/// section 14), so no choice of D is exact everywhere. Three choices are compared: the deltas that a file stores; the
/// end-point deltas, which are exact for each target alone at weight 1; and the deltas with the smallest overall error
/// for given weights:
///
///     const std::vector<double> weights = random_blend_weights({.targets = 102, .rows = 200, .active = 8});
///     BlendNormals normals = BlendNormals::of_groups(set, groups);
///     const Quality ends = delta_quality(endpoint_deltas(normals), normals, weights);
///     const Quality best = delta_quality(best_deltas(normals, weights), normals, weights);
///
/// Weights    rows with a weight for each target: random rows, or the frames of an animation.
/// Threads    functions use the scratch memory of the BlendNormals, so only one call per object may run at a time.
#ifndef CHRONORMAL_ANALYSIS_QUALITY_BLEND_QUALITY_H_
#define CHRONORMAL_ANALYSIS_QUALITY_BLEND_QUALITY_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/fits/delta_fit.h"
#include "chronormal/analysis/quality.h"
#include "chronormal/motion/motion.h"
#include "normals/blend/blend_normals.h"

namespace chronormal::inline internal {

/// Returns exact base normals. The delta of each target leads from the base normals to the exact normals of this target
/// alone at weight 1.
[[nodiscard]] DeltaNormals endpoint_deltas(BlendNormals& normals);

/// Returns exact base normals, and the deltas that make sum |N + sum_i w_i D_i - u(w)|^2 over all rows smallest, for
/// each element separately. u(w) is the exact unit normal. If there are fewer rows than targets, or if some weights
/// always change together, the rows may leave deltas undetermined. The result is then closest to the end-point deltas.
/// Cost: an evaluation for each row, and for each element a linear system with one equation for each target that moves
/// the element. Precondition: weights is (rows, targets).
[[nodiscard]] DeltaNormals best_deltas(BlendNormals& normals, std::span<const double> weights);

/// Measures the angles between the rendered and the exact normals, over all rows. Elements count in a row if their
/// rendered or exact normal differs from that of the base. In Quality::max_at, `segment` is the index of the row.
/// Preconditions: `weights` is (rows, targets), and `deltas` has the elements and targets of `normals`.
[[nodiscard]] Quality delta_quality(const DeltaNormals& deltas, BlendNormals& normals, std::span<const double> weights);

struct BlendWeightOptions {
  std::size_t targets = 0;
  std::size_t rows = 100;
  /// Number of targets with a nonzero weight in each row; 0, or a number above `targets`, stands for all targets.
  std::size_t active = 0;
  double low = 0, high = 1;
  std::uint64_t seed = 1;
};

/// Returns rows of random weights. In each row, `active` random targets have weights that are uniform between `low` and
/// `high`. Pure: the result is the same on every system.
[[nodiscard]] std::vector<double> random_blend_weights(const BlendWeightOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_BLEND_QUALITY_H_
