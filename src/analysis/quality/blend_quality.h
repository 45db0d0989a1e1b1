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
#include "chronormal/normals/blend_normals.h"

namespace chronormal::inline internal {

/// Returns exact base normals, and for each target the delta from them to the exact normals of this target alone at
/// weight 1.
[[nodiscard]] DeltaNormals endpoint_deltas(BlendNormals& normals);

/// Returns exact base normals, and the deltas that make sum |N + sum_i w_i D_i - u(w)|^2 over all rows smallest, for
/// each element separately. If the rows do not determine the deltas (fewer rows than targets, weights that always go
/// together), the result is closest to the end-point deltas. Cost: an evaluation for each row, and for each element a
/// linear system with one equation for each target that moves it. weights must be (rows, targets)
[[nodiscard]] DeltaNormals best_deltas(BlendNormals& normals, std::span<const double> weights);

/// Returns the angles between the rendered and the exact normals, over all rows, and all elements for which one of the
/// two differs from the base. max_at has the row as its segment. `weights` must be (rows, targets), and `deltas` must
/// have the elements and targets of `normals`
[[nodiscard]] Quality delta_quality(const DeltaNormals& deltas, BlendNormals& normals, std::span<const double> weights);

struct BlendWeightOptions {
  std::size_t targets = 0;
  std::size_t rows = 100;
  std::size_t active = 0;  ///< targets with a nonzero weight in each row; 0, or more than there are: all
  double low = 0, high = 1;
  std::uint64_t seed = 1;
};

/// Returns rows of random weights of `active` random targets, uniform between low and high. Pure: the same on every
/// system.
[[nodiscard]] std::vector<double> random_blend_weights(const BlendWeightOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_BLEND_QUALITY_H_
