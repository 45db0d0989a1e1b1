/// Adds the baselines to a benchmark: a loop in plain C++, a loop with Eigen, and the libraries in bench/peers that
/// were installed when the benchmark was built.
#ifndef BENCH_PATHS_RIVALS_H_
#define BENCH_PATHS_RIVALS_H_

#include <map>
#include <string>

#include "measure/meshes.h"
#include "measure/suite.h"

namespace chronormal::bench {

/// Adds the cases of plain loops, which interpolate the positions and then compute normals. `limit` is the largest
/// allowed error of a normal in radians. The mesh must outlive the cases.
void add_loops(CaseList& list, const Mesh& mesh, Elements elements, double limit);
/// Returns the largest allowed error of normals from float32 positions on the torus, in radians.
[[nodiscard]] double float_limit(std::size_t elements);
/// Adds the cases of libraries. The positions are interpolated and put into the structure of the library beforehand, so
/// only the computation of normals is timed.
void add_libraries(CaseList& list, const Mesh& mesh, Elements elements);

/// Returns the names and versions of the libraries with which this benchmark was built.
[[nodiscard]] std::map<std::string, std::string> rival_versions();

}  // namespace chronormal::bench

#endif  // BENCH_PATHS_RIVALS_H_
