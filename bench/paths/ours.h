/// Our own paths, which are the same for faces and for vertices.
#ifndef BENCH_PATHS_OURS_H_
#define BENCH_PATHS_OURS_H_

#include "chronormal/normals/normal_groups.h"
#include "measure/suite.h"

namespace chronormal::bench {

/// Adds all of them: preparing, evaluating, many t, playing, on one thread and on all. No groups: of faces. The segment
/// and the groups must outlive the cases.
/// recompute_bytes: what recomputing all normals has to read at least, 0 where it is not known
/// float_limit: how far off normals from positions in float32 may be, in radians
void add_ours(CaseList& list, const Segment& segment, const NormalGroups* groups, std::size_t recompute_bytes,
              double float_limit);

/// Looks at a packed array (n, 3).
[[nodiscard]] Check packed_check(double t, const float* normals);

}  // namespace chronormal::bench

#endif  // BENCH_PATHS_OURS_H_
