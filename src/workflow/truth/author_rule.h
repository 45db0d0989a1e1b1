/// Finds which sums of face normals the normals of a mesh follow. Private to workflow.
///
/// The tool that made a mesh weighted polygons or triangles in its own way, and the stored normals show which rule it
/// used. The normals of targets at weight 1 are compared first, with the offset of the base applied: a flat base or a
/// cube has the same normals by all rules, but its targets do not. The base is used only if no target tells rules
/// apart.
///
///     candidates   five weightings, of triangles or quads, of an element's own corners or its whole point
///     tells        a stored normal tells if some candidate is more than 0.1 degrees from triangles by area there; at
///                  all other normals the candidates hardly differ
///     distance     of a candidate: a quantile, over the normals that tell, of the angle to the stored normal
///     found        the candidate that a tenth of these normals follow to 0.003 degrees, at a third of the distance of
///                  triangles by area, even if much of the mesh was bent by hand; among several such candidates, the
///                  one that three quarters of the normals follow exactly, if there is one. Otherwise the candidate
///                  with the smallest median, if that is at most a degree, and at most two thirds of the median of
///                  triangles by area. Otherwise triangles by area, which can be computed exactly at every time
///
/// The rule is changed around normals that do not follow it, if the change makes a normal follow exactly. Triangles in
/// a row become larger polygons, quads are split, and elements add up their whole point (also both sides of faces that
/// look like the two sides of a sheet but are not). Changes that only bring normals nearer to the sums are not made,
/// since that may be chance.
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
  /// The median over all stored normals that tell rules apart: the median of the largest angle between a candidate and
  /// triangles by area, in degrees.
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
/// deltas of normals. Takes O(corners) for each candidate in the base and in each target, but examines some tens of
/// thousands of normals at most. Uses all cores. The result has the same bits on any number of threads.
[[nodiscard]] FoundRule find_author_rule(const GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_RULE_H_
