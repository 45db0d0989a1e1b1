/// Everybody else: a loop in plain C++, one with Eigen, and libraries where they are built (bench/peers).
#ifndef BENCH_PATHS_RIVALS_H_
#define BENCH_PATHS_RIVALS_H_

#include <map>
#include <string>

#include "measure/meshes.h"
#include "measure/suite.h"

namespace chronormal::bench {

/// The mesh must outlive the cases. Loops interpolate the positions and compute normals.
void add_loops(CaseList& list, const Mesh& mesh, Elements elements, double limit);
/// How far off normals from float32 positions may be on the torus, in radians.
[[nodiscard]] double float_limit(std::size_t elements);
/// Libraries have the interpolated positions in their own structure already, and only compute normals.
void add_libraries(CaseList& list, const Mesh& mesh, Elements elements);

/// Which of them are built, and their versions.
[[nodiscard]] std::map<std::string, std::string> rival_versions();

}  // namespace chronormal::bench

#endif  // BENCH_PATHS_RIVALS_H_
