/// Extra targets of low rank: what the deltas of a mesh's own targets lack along the animations of a file, as the sum
/// of a few deltas whose weights are curves in time (docs/theory.md, section 17). Private to workflow.
///
///     n(w(t)) / |n(0)|  =  N + sum_i w_i(t) D_i + sum_k s_k(t) E_k, nearly
///
/// The s_k are the leading left singular vectors of what is missing, in which points where n(w) gets short count more;
/// the E_k are the right ones. Where that leaves a point far off, its own E_k are fitted again by least squares of the
/// angles, in which the length of n(w) is free at every instant and bad instants count more.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_LOW_RANK_FORM_H_
#define CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_LOW_RANK_FORM_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/judge/right_normals.h"
#include "workflow/bake/low_rank/extra_curves.h"
#include "workflow/bake/mesh_weights.h"

namespace chronormal::inline internal {

struct LowRankForm {
  std::vector<VertexVectors> own;     ///< of each target of the mesh
  std::vector<VertexVectors> extras;  ///< of any length, for weights from -1 to 1
  TrackCurves curves;                 ///< of the extra targets, for each track
  PoseList rest;                      ///< their weights in the poses that the file stores
  double worst = 0;                   ///< degrees: of all points at the instants that were fitted to
};

struct LowRankLimits {
  std::size_t most_extras = 0;
  double tolerance = 0;     ///< degrees: extra targets are added until the worst that is seen is within it
  bool refits_own = false;  ///< the deltas of own targets are fitted to the animations too, and to nothing else
};

/// Fits as many extra targets as the tolerance needs, within the limit. own has the deltas of the mesh's own targets,
/// which vertices that are within a part of the tolerance keep as they are, with nothing from extra targets. Cost: the
/// right normals at all nodes of the curves; 480 of these at most are fitted to, and 700 MB are used for them.
[[nodiscard]] LowRankForm low_rank_form(const RightNormals& rights, const MeshWeights& weights,
                                        std::span<const std::uint32_t> vertices,
                                        std::span<const std::uint32_t> element_of_vertex,
                                        std::vector<VertexVectors> own, const LowRankLimits& limits);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_LOW_RANK_LOW_RANK_FORM_H_
