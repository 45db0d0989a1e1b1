/// Plans the bake of one mesh. The plan tells which pairs of targets get a correction target. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_PLAN_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_PLAN_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/deltas/fitted_lines.h"
#include "workflow/bake/deltas/terms.h"
#include "workflow/bake/poses/tracks.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// The range of the weights that a file gives one target. The range is extended to contain 0 and 1.
struct WeightRange {
  double low = 0, high = 1;
};

struct MeshPlan {
  BakeEncoding encoding = BakeEncoding::kExact;
  bool is_driven = false;  ///< true if an animation gives some moving target a weight
  /// True if products of weights fit into float32; otherwise the encoding exact is impossible.
  bool products_fit = true;
  std::vector<bool> is_line;        ///< for each target, true if it gets the best single delta
  std::vector<WeightRange> ranges;  ///< for each target, the weights for which its error is stated
  FittedLines lines;                ///< deltas of targets that are active together, for the encoding endpoint
  std::vector<ExtraWeight> extras;  ///< the correction targets, in ascending order of (i, j)
  std::vector<bool> is_shown;       ///< for each element, true if some vertex shows it
  std::vector<double> largest;  ///< for each element, the length of the longest vector in the sum that is its normal
  double left_out = 0;          ///< degrees: the largest angle by which a normal turns because pairs were left out
};

/// Returns the requested encoding, or kSmallest if none was requested.
[[nodiscard]] inline BakeEncoding encoding_of(const BakeOptions& options) {
  return options.encoding.value_or(BakeEncoding::kSmallest);
}

/// Decides what a bake writes for a mesh. `use` has the weights that the file gives the mesh. is_driven is true if
/// animations set any of these weights. The function is pure. Errors: kInvalidInput if there would be too many pairs.
[[nodiscard]] Result<MeshPlan> plan_mesh(const GltfDocument& document, const GltfShading& shading,
                                         const NormalTerms& terms, const WeightUse& use, bool is_driven,
                                         const BakeOptions& options);

[[nodiscard]] inline bool moves(const GltfShading& shading, std::size_t target) noexcept {
  return !shading.set.targets[target].vertices.empty();
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_PLAN_H_
