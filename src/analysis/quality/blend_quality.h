/// How far normals are off in viewers that add one normal delta per target, at any weights.
///
/// A viewer shows normalize(N + sum_i w_i D_i). The true normal is a quadratic form in the weights (docs/theory.md,
/// section 14), so no choice of D is right everywhere. Three of them are compared: what a file stores; the end-point
/// deltas, right for each target alone at weight 1; and those that are best on the whole for given weights:
///
///     const std::vector<double> weights = random_blend_weights({.targets = 102, .rows = 200, .active = 8});
///     BlendNormals normals = BlendNormals::of_groups(set, groups);
///     const Quality ends = delta_quality(endpoint_deltas(normals), normals, weights);
///     const Quality best = delta_quality(best_deltas(normals, weights), normals, weights);
///
/// Weights    rows of one weight for each target: random ones, or the frames of an animation.
/// Threads    uses the scratch of the BlendNormals: one call at a time on each.
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

/// Exact base normals, and what is missing to the exact ones of each target alone at weight 1.
[[nodiscard]] DeltaNormals endpoint_deltas(BlendNormals& normals);

/// Exact base normals, and the deltas that make sum |N + sum_i w_i D_i - u(w)|^2 over all rows smallest, for each
/// element on its own. Where the rows do not tell deltas apart (fewer rows than targets, weights that always go
/// together), those nearest to the end-point deltas. Cost: an evaluation for each row, and for each element a system of
/// as many equations as targets touch it.
/// weights must be (rows, targets)
[[nodiscard]] DeltaNormals best_deltas(BlendNormals& normals, std::span<const double> weights);

/// The angles between what a viewer shows and the exact normals, over all rows, and all elements of which one of the two
/// is not as in the base. max_at has the row as its segment.
/// weights must be (rows, targets), deltas of the elements and targets of normals
[[nodiscard]] Quality delta_quality(const DeltaNormals& deltas, BlendNormals& normals, std::span<const double> weights);

struct BlendWeightOptions {
  std::size_t targets = 0;
  std::size_t rows = 100;
  std::size_t active = 0;  ///< targets with a weight other than 0 in each row; 0, or more than there are: all
  double low = 0, high = 1;
  std::uint64_t seed = 1;
};

/// Rows of random weights, evenly between low and high, of as many random targets. Pure: the same on every system.
[[nodiscard]] std::vector<double> random_blend_weights(const BlendWeightOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_BLEND_QUALITY_H_
