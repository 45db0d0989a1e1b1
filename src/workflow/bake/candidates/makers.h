/// The makers of candidates: each makes a Candidate of a Making, a mesh with what is asked. Private to workflow.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_MAKERS_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_MAKERS_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

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

// Candidates without extra targets (own.cpp).

/// Makes a candidate of what the file stores.
[[nodiscard]] Candidate stored_candidate(const DeltaSource& source);

/// Deltas that are right at weight 1 of each target alone. Where lengths are free they are those that leave least on the
/// way there, as the plan of the source has it: with fitted lines, by least squares over the weights of the file.
[[nodiscard]] Candidate own_candidate(const DeltaSource& source, const RightNormals& rights, Lengths lengths);

// Extra targets that products of weights drive (products.cpp).

/// Computes the deltas of the mesh's own targets to their ends, for all vertices of elements that these move.
[[nodiscard]] std::vector<VertexVectors> end_deltas(const GltfShading& shading, const NormalTerms& terms,
                                                    const RightNormals& rights, Lengths lengths);

/// Counts the pairs of targets that move a normal both and are active together, a target with itself among them, but no
/// more than one beyond `most`.
[[nodiscard]] std::size_t count_products(const Making& making, std::size_t most);

/// Makes the candidate, for the poses of the file or of the rig. Vertices that are right to half the tolerance take part
/// in no extra target; of those beyond the limit the ones that gain most are kept.
[[nodiscard]] Candidate products_candidate(const Making& making);

// Extra targets that animations drive (low_rank.cpp).

/// Fits as many extra targets as the tolerance needs, within the limit, to what new deltas of the mesh's own targets
/// leave wrong. Vertices that are right to a part of the tolerance take no part. Where animations are all that counts and
/// lengths are free, the deltas of own targets are fitted to the animations too. Cost: the right normals at all nodes of
/// the curves; 480 of these at most are fitted to, and 700 MB are used for them.
[[nodiscard]] Candidate low_rank_candidate(const Making& making, Candidate own);

// Extra targets whose weights are quadratics of the weights, for a mesh that nothing drives (quadratics.cpp).

/// Adds more and more extra targets to the deltas of a candidate that has none, and calls take(candidate) for each number
/// of them, until that returns false. A file whose extra targets nobody drives shows the deltas of `own` alone.
/// making.weights must have a rig
void quadratics_candidates(const Making& making, const Candidate& own,
                           const std::function<bool(Candidate candidate)>& take);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_MAKERS_H_
