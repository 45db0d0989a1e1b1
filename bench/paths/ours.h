/// Makes the cases of chronormal's own paths, which are its ways to compute normals, with the same code for faces and
/// for vertices.
#ifndef BENCH_PATHS_OURS_H_
#define BENCH_PATHS_OURS_H_

#include "chronormal/normals/normal_groups.h"
#include "measure/suite.h"

namespace chronormal::bench {

/// Adds the cases of preparing curves, evaluating them at one t and at many t, and playing them in small steps, each on
/// one thread and on all. Without groups, the elements are faces. The segment and the groups must outlive the cases.
/// recompute_bytes is the smallest number of bytes that recomputing all normals has to read, or 0 if unknown.
/// float_limit is the largest allowed error of normals from positions in float32, in radians.
void add_ours(CaseList& list, const Segment& segment, const NormalGroups* groups, std::size_t recompute_bytes,
              double float_limit);

/// Makes a check that compares a packed array (n, 3) of normals with the normals of the oracle at t.
[[nodiscard]] Check packed_check(double t, const float* normals);

}  // namespace chronormal::bench

#endif  // BENCH_PATHS_OURS_H_
