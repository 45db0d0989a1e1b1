// Makes new deltas for the targets of a mesh, without correction targets.
#include "workflow/bake/candidates/makers.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace chronormal::inline internal {

Lengths lengths_for(std::span<const Viewer> named, std::span<const Viewer> spared) {
  const auto any = [](std::span<const Viewer> viewers, NormalRule rule) {
    return std::any_of(viewers.begin(), viewers.end(), [rule](const Viewer& viewer) { return viewer.normals == rule; });
  };
  if (any(named, NormalRule::kClamped)) return Lengths::kUnit;
  return any(named, NormalRule::kUnit) || any(spared, NormalRule::kUnit) ? Lengths::kShort : Lengths::kFree;
}

Candidate stored_candidate(const DeltaSource& source) {
  Candidate result;
  result.name = "as it is";
  result.own = stored_deltas(source.shading);
  result.own.resize(source.shading.set.targets.size());
  return result;
}

Candidate fitted_candidate(const DeltaSource& source) {
  Candidate result;
  result.name = "own deltas";
  for (std::size_t i = 0; i < source.shading.set.targets.size(); ++i) {
    const TargetDeltas deltas = own_target_deltas(source, i);
    result.fit_error = std::fmax(result.fit_error, deltas.error);
    result.own.push_back(as_column(source.shading, deltas));
  }
  result.fit_error = std::fmax(result.fit_error, source.plan.lines.largest_error());
  return result;
}

Candidate own_candidate(const DeltaSource& source, const RightNormals& rights, Lengths lengths) {
  // If the true normals are not quadratic in the weight, the terms of n(w) are only a fit to the true normals. For this
  // reason deltas are computed from the true normal at weight 1 instead.
  const bool is_of_truth = source.plan.encoding == BakeEncoding::kSmallest && !rights.are_by_area();
  if (lengths != Lengths::kFree || is_of_truth) {
    // The deltas give the normal at weight 1 the length of N. The stored normals of an author have that length too, so
    // stored deltas that are right hardly change.
    Candidate result;
    result.name = "own deltas";
    result.own =
        end_deltas(source.shading, source.terms, rights, lengths == Lengths::kUnit ? lengths : Lengths::kShort);
    return result;
  }
  return fitted_candidate(source);
}

}  // namespace chronormal::inline internal
