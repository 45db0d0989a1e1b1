/// Finds the rule by which a modelling tool added up face normals to the normals of a mesh. Private to workflow.
///
/// Each modelling tool weights polygons or triangles in its own way, and the stored normals of a mesh show which rule
/// its tool used. The normals of targets at weight 1 are compared first, with the author's change of the base normals
/// applied: a flat base or a cube has the same normals by all rules, but its targets do not. The base is used only if
/// no target tells rules apart.
///
///     candidate    a rule that the tool may have used: one of five weightings, of triangles or of quads, over the
///                  corners of an element or over all corners at the point of the element
///     tells        a stored normal tells rules apart if some candidate differs there by more than 0.1 degrees from
///                  weighting triangles by area; at all other normals the candidates hardly differ
///     distance     a quantile of the angles between a candidate and the stored normals that tell rules apart
///
/// Three choices are tried in this order:
///
///     1. A candidate that a tenth of the telling normals follow to 0.003 degrees, even if much of the mesh was bent by
///        hand. The distance of this candidate must be at most a third of the distance of triangles by area. Among
///        several such candidates, one that three quarters of the normals follow exactly is preferred.
///     2. The candidate with the smallest median distance, if this distance is at most a degree, and at most two thirds
///        of the median distance of triangles by area.
///     3. Triangles by area, since their normals can be computed exactly at every time.
///
/// Around stored normals that do not follow the rule, the rule is changed if the change makes a stored normal follow
/// exactly. Three changes are possible: consecutive triangles become larger polygons, quads are split, and elements add
/// up all corners at their points (also on both sides of faces that look like the two sides of a sheet but are not). A
/// change that only brings stored normals nearer to their sums is not made, since the gain may be chance. If most stored
/// normals are near the sums of the rule but not equal to them, they were rounded, and no change is made at all.
#ifndef CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_RULE_H_
#define CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_RULE_H_

#include <cstddef>

#include "chronormal/normals/weighting.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/truth/author_sums.h"

namespace chronormal::inline internal {

struct AuthorRule {
  Weighting weighting = Weighting::kArea;
  bool is_followed = false;      ///< if false, no rule was found, and weighting by area is as good as another rule
  bool any_polygons = false;     ///< true if some triangles count as parts of polygons
  bool any_whole_point = false;  ///< true if some elements add up more than the corners that show them
  std::size_t telling = 0;       ///< the number of stored normals that tell rules apart
  double distance = 0;           ///< the median distance of the candidate that was found, in degrees
  /// For each stored normal that tells rules apart, takes the largest angle between a candidate and triangles by area.
  /// `spread` is the median of these angles, in degrees.
  double spread = 0;

  [[nodiscard]] bool is_plain() const noexcept {
    return weighting == Weighting::kArea && !any_polygons && !any_whole_point;
  }
};

struct FoundRule {
  AuthorRule rule;
  AuthorSums sums;  ///< the sums of the rule; empty if the rule is plain and no target stores normals
};

/// Finds the rule of a mesh. Preconditions: the groups of the shading have their corners, and the shading has kept its
/// deltas of normals. Takes O(corners) time for each candidate in the base and in each target, but examines some tens
/// of thousands of normals at most. Uses all cores. The result has the same bits on any number of threads.
[[nodiscard]] FoundRule find_author_rule(const GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_RULE_H_
