/// Extra targets of any length as those that viewers keep. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_SHARES_H_
#define CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_SHARES_H_

#include <cstddef>
#include <span>
#include <vector>

#include "workflow/bake/candidates/making.h"
#include "workflow/bake/deltas/right_normals.h"
#include "workflow/bake/deltas/vertex_columns.h"

namespace chronormal::inline internal {

/// One extra target made of another: its weight is `factor` times that one's, or what of this is above zero.
struct Share {
  std::size_t of = 0;
  double factor = 1;
  bool above_zero = false;
  VertexVectors vectors;
};

/// What short shares are like.
struct ShortShares {
  bool are_units = false;   ///< N + E is as long as N, but for what goes along N: viewers that keep directions keep it
  bool keep_along = false;  ///< and what goes along N stays
};

/// Makes targets of these lengths that add up to the given ones: one for each, or two of unit length.
[[nodiscard]] std::vector<Share> shares_of(const RightNormals& rights, std::vector<VertexVectors> extras,
                                           Lengths lengths, const ShortShares& how);

/// Replaces the weights of so many extra targets, (poses, extras), by those of shares.
void take_shares(std::span<const Share> shares, std::size_t extras, std::vector<double>& values);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_CANDIDATES_SHARES_H_
