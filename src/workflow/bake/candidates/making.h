/// The input of every maker of candidates. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_MAKING_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_MAKING_H_

#include <cstddef>
#include <span>

#include "chronormal/workflow/viewers.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/deltas/right_normals.h"
#include "workflow/bake/judge/judge.h"
#include "workflow/bake/poses/mesh_weights.h"

namespace chronormal::inline internal {

/// The lengths that N + D and the deltas E of extra targets may have.
enum class Lengths {
  kUnit,  ///< N + D and N + E are as long as N, no component of D and E is beyond 1, and weights are from 0 to 1: in any
          ///< viewer, after any compressor
  kShort,  ///< N + D is as long as N, and E short beside N, with weights as much larger: a viewer that keeps the direction
           ///< of N + E loses the part of E along N, and next to nothing of the rest
  kFree  ///< any length: where all viewers add up what is stored
};

/// Returns the lengths that all of these viewers keep, or lose little of.
[[nodiscard]] Lengths lengths_for(std::span<const Viewer> named, std::span<const Viewer> spared);

/// Returns how many times larger weights are than beside deltas of any length.
[[nodiscard]] constexpr double weight_factor(Lengths lengths) noexcept { return lengths == Lengths::kShort ? 64 : 1; }

/// A mesh, with what is asked of a candidate. The members that are references must outlive it.
struct Making {
  const DeltaSource& source;
  const RightNormals& rights;
  const MeshWeights& weights;
  const Judge& judge;
  std::span<const Viewer> viewers;  ///< in which it should be right
  Lengths lengths = Lengths::kFree;
  double tolerance = 0;  ///< degrees
  std::size_t most_extras = 0;
  bool animations_only = false;
  bool keeps_across = false;  ///< some of the viewers keep no lengths: extra targets turn normals by what is across N

  [[nodiscard]] std::size_t targets() const { return source.shading.set.targets.size(); }
};

/// The part of the tolerance that straight pieces between keys may leave.
inline constexpr double kPartOfTracks = 0.2;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_MAKING_H_
