/// Which sums of face normals the normals of a mesh follow. Private to workflow.
///
/// The tool that made a mesh weighed polygons or triangles in its own way; what it stored says which. Asked are the
/// normals of the targets at weight 1, with what was added to the base carried along, and where no target tells, those
/// of the base: a base that is flat or a cube is the same by all rules, and its targets are not.
///
///     candidates   five weightings, of triangles and of quads, of an element's own corners and of its whole point
///     tells        a stored normal around which two candidates differ by more than 0.1 degrees: elsewhere all agree
///     distance     of a candidate: a quantile, over the normals that tell, of the angle to the stored one
///     found        the candidate that a tenth of these normals follow to 0.003 degrees, at a third of the distance of
///                  triangles by area, however much of the mesh was bent by hand; or else the one whose median is
///                  smallest, where that is at most a degree, and two thirds of that by area; or else triangles by
///                  area, which are exact at every time
///
/// The rule is mended around the normals that do not follow it: triangles in a row become larger polygons, quads
/// are taken apart, and elements add up their whole point, where that makes a normal follow exactly. What is merely
/// nearer may be so by chance.
#ifndef CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_RULE_H_
#define CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_RULE_H_

#include <cstddef>

#include "chronormal/normals/weighting.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/truth/author_sums.h"

namespace chronormal::inline internal {

struct AuthorRule {
  Weighting weighting = Weighting::kArea;
  bool is_followed = false;      ///< or nothing is known of a rule, and area is as good as another
  bool any_polygons = false;     ///< some triangles count as parts of polygons
  bool any_whole_point = false;  ///< some elements add up more than the corners that show them
  std::size_t telling = 0;       ///< stored normals that tell rules apart
  double distance = 0;           ///< degrees, the median of the candidate that was found
  double spread = 0;             ///< degrees, the median of how far the candidates are from each other there

  [[nodiscard]] bool is_plain() const noexcept {
    return weighting == Weighting::kArea && !any_polygons && !any_whole_point;
  }
};

struct FoundRule {
  AuthorRule rule;
  AuthorSums sums;  ///< empty where the rule is plain, and no target stores normals
};

/// Finds the rule of a mesh, whose groups must have their corners and whose deltas of normals must be kept. O(corners)
/// for each candidate, base and target, of which some tens of thousands of normals are asked at most. On all cores; the
/// same bits on any number of threads.
[[nodiscard]] FoundRule find_author_rule(const GltfShading& shading);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_AUTHOR_RULE_H_
