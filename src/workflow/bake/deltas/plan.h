/// Plans the bake of one mesh: which pairs of targets get a correction target, and which are left out. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_EXACT_PLAN_H_
#define CHRONORMAL_WORKFLOW_BAKE_EXACT_PLAN_H_

#include <cstddef>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "workflow/bake/deltas/fitted_lines.h"
#include "workflow/bake/deltas/terms.h"
#include "workflow/bake/poses/tracks.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// The range of the weights of a file, extended to contain 0 and 1.
struct WeightRange {
  double low = 0, high = 1;
};

struct MeshPlan {
  BakeEncoding encoding = BakeEncoding::kExact;
  bool is_driven = false;           ///< an animation gives some moving target a weight
  bool products_fit = true;         ///< products of weights fit into float32; otherwise nothing can be exact
  std::vector<bool> is_line;        ///< of each target: it gets the best single delta
  std::vector<WeightRange> ranges;  ///< of each target: the weights that its error is stated for
  FittedLines lines;                ///< of targets that are active together, for the encoding endpoint
  std::vector<ExtraWeight> extras;  ///< ascending (i, j)
  std::vector<bool> is_shown;       ///< of each element: some vertex shows it
  std::vector<double> largest;      ///< of each element: the length of its largest term
  double left_out = 0;              ///< degrees: how far the pairs that were left out turn a normal
};

/// Returns the requested encoding, or kSmallest if none was requested.
[[nodiscard]] inline BakeEncoding encoding_of(const BakeOptions& options) {
  return options.encoding.value_or(BakeEncoding::kSmallest);
}

/// Decides what to write. `use` has the weights that the file gives the mesh; is_driven is true if animations set any
/// of them. Pure. Errors: kInvalidInput if there would be too many pairs.
[[nodiscard]] Result<MeshPlan> plan_mesh(const GltfDocument& document, const GltfShading& shading,
                                         const NormalTerms& terms, const WeightUse& use, bool is_driven,
                                         const BakeOptions& options);

[[nodiscard]] inline bool moves(const GltfShading& shading, std::size_t target) noexcept {
  return !shading.set.targets[target].vertices.empty();
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_EXACT_PLAN_H_
