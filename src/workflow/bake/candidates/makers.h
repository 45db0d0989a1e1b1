/// The functions that make candidates. Each of them makes a Candidate from a Making, which is a mesh with the
/// requirements of the bake. Private to workflow.
///
/// N is the stored normal of a vertex, D the delta of a target of the mesh, and E the delta of a correction target. Own
/// deltas are those of the mesh's own targets. "Across N" means perpendicular to N.
///
/// Threads    Uses all cores. The results have the same bits on any number of cores.
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

/// The lengths that N + D and the deltas E of correction targets may have.
enum class Lengths {
  /// N is the stored normal, D an own delta, E a delta of a correction target. N + D and N + E have the length of N, no
  /// component of D and E is beyond 1, and weights are from 0 to 1. Every viewer renders such deltas right, after any
  /// compressor.
  kUnit,
  /// N is the stored normal, D an own delta, E a delta of a correction target. N + D has the length of N. E is much
  /// shorter than N, and its weights are larger for this reason. A viewer that keeps only the direction of N + E loses
  /// the part of E along N, and almost nothing else.
  kShort,
  /// Deltas of any length. All viewers must add the deltas as stored.
  kFree
};

/// Returns the least restrictive lengths of deltas that all of these viewers render with little or no loss.
[[nodiscard]] Lengths lengths_for(std::span<const Viewer> named, std::span<const Viewer> spared);

/// Returns the factor by which weights for these lengths are larger than weights for deltas of any length.
[[nodiscard]] constexpr double weight_factor(Lengths lengths) noexcept { return lengths == Lengths::kShort ? 64 : 1; }

/// A mesh and the requirements for a candidate. The objects to which the references and spans refer must outlive this
/// object.
struct Making {
  const DeltaSource& source;
  const RightNormals& rights;
  const MeshWeights& weights;
  const Judge& judge;
  std::span<const Viewer> viewers;  ///< the viewers in which the candidate should be right
  Lengths lengths = Lengths::kFree;
  double tolerance = 0;  ///< degrees: the largest error that the candidate should have
  std::size_t most_extras = 0;
  bool animations_only = false;
  /// True if correction targets may have only deltas perpendicular to the stored normal, because some viewers do not
  /// keep the lengths of normals.
  bool keeps_across = false;

  [[nodiscard]] std::size_t targets() const { return source.shading.set.targets.size(); }
};

/// The part of the tolerance that may be used up by straight pieces of weight curves between two keys.
inline constexpr double kPartOfTracks = 0.2;

// Makers of candidates without correction targets (own.cpp).

/// Makes a candidate that has the deltas of the file.
[[nodiscard]] Candidate stored_candidate(const DeltaSource& source);

/// Makes a candidate with deltas of the mesh's own targets that are right at weight 1 of each target alone. If lengths
/// are free, makes the deltas that the plan of the source requires instead, whose errors are also small between the
/// weights 0 and 1. The deltas include those that were fitted by least squares to the weights of the file
/// (FittedLines).
[[nodiscard]] Candidate own_candidate(const DeltaSource& source, const RightNormals& rights, Lengths lengths);

/// Makes a candidate with the deltas that the plan of the source requires, of any length. If normals are not weighted by
/// area, these deltas are for a fit to the true normals.
[[nodiscard]] Candidate fitted_candidate(const DeltaSource& source);

// Makers of candidates with correction targets whose weights are products of the weights of the mesh's own targets
// (products.cpp).

/// Returns deltas of the mesh's own targets that make normals right at weight 1 of each target. The deltas of a target
/// are for the vertices of all elements that the target moves.
[[nodiscard]] std::vector<VertexVectors> end_deltas(const GltfShading& shading, const NormalTerms& terms,
                                                    const RightNormals& rights, Lengths lengths);

/// Counts the pairs of targets that are active together and move the same normal. A target with itself is a pair too.
/// Stops counting at `most` + 1.
[[nodiscard]] std::size_t count_products(const Making& making, std::size_t most);

/// Makes the candidate whose correction targets have products of weights, for the poses of the file or of the rig.
/// Vertices whose error is at most half the tolerance get no deltas of correction targets. If the limit allows fewer
/// correction targets than were made, keeps those that help most.
[[nodiscard]] Candidate products_candidate(const Making& making);

// Makers of correction targets whose weights animations set directly (low_rank.cpp).

/// Fits correction targets to the errors that new deltas of the mesh's own targets leave. Makes as many targets as the
/// tolerance needs, but at most making.most_extras. Vertices whose error is a small part of the tolerance are left out.
/// If only animations count and lengths are free, the deltas of own targets are fitted to the animations too. Computes
/// the true normals at all nodes of the weight curves; at most 480 nodes are fitted, and their normals take at most
/// about 700 MB of memory.
[[nodiscard]] Candidate low_rank_candidate(const Making& making, Candidate own);

// Makers of correction targets whose weights are quadratic in the weights of the mesh's own targets, for a mesh that no
// animation drives (quadratics.cpp).

/// Adds correction targets to `own`, a candidate that has none. Calls take(candidate) for larger and larger numbers of
/// correction targets, until take() returns false. As long as no program drives the correction targets, a viewer
/// renders the deltas of `own` alone. making.weights must have a rig.
void quadratics_candidates(const Making& making, const Candidate& own,
                           const std::function<bool(Candidate candidate)>& take);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_MAKERS_H_
