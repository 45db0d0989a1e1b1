/// A form of a mesh that nothing drives, with extra targets whose weights are quadratics of the weights. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_UNDRIVEN_QUADRATIC_FORM_H_
#define CHRONORMAL_WORKFLOW_BAKE_UNDRIVEN_QUADRATIC_FORM_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "workflow/bake/forms/chosen_form.h"
#include "workflow/bake/undriven/quadratic_fit.h"

namespace chronormal::inline internal {

struct QuadraticLimits {
  std::size_t most_extras = 0, most_bytes = 0;
  std::size_t most_poses = 0;  ///< that errors are measured in
  double mean_without = 0;     ///< degrees: the mean error without extra targets
};

/// What so many extra targets come to before each vertex chooses whether it takes part: in poses that no fit has seen.
struct QuadraticGain {
  std::size_t fitted = 0;   ///< before hosts that keep no lengths take two targets for each
  std::size_t targets = 0;  ///< of the mesh
  std::size_t bytes = 0;
  ShownErrors played;
};

struct QuadraticChoice {
  std::vector<QuadraticGain> gains;  ///< of more and more extra targets
  std::optional<ChosenForm> form;    ///< nothing where none is worth it
};

/// Adds extra targets to the deltas of a form that has none, for the vertices where these do no harm and are nearer. A
/// file whose extra targets nobody drives shows these deltas alone. As many are taken as bring the error within the
/// tolerance; or where none do, as long as more of them take a tenth away from the mean error, up to 32 where no number
/// of targets is asked for. weights must have a rig
[[nodiscard]] QuadraticChoice choose_quadratics(const DeltaSource& source, const MeshWeights& weights,
                                                const BakeOptions& options, FormLengths lengths, const ChosenForm& own,
                                                const QuadraticLimits& limits);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_UNDRIVEN_QUADRATIC_FORM_H_
