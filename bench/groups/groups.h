/// The groups of rows, a file each.
#ifndef BENCH_GROUPS_GROUPS_H_
#define BENCH_GROUPS_GROUPS_H_

#include <string>
#include <vector>

#include "measure/suite.h"
#include "paths/ours.h"

namespace chronormal::bench {

void run_faces(Suite& suite, const Size& size);
void run_vertices(Suite& suite, const Size& size);
/// Meshes other than the torus: thin triangles, varied valence, a sphere that collapses, and those of other people that
/// CHRONORMAL_DATA has (a dance, a face).
void run_meshes(Suite& suite);
/// Every scheme, at random access and played.
void run_schemes(Suite& suite, const Size& size);

/// Normals of degree 6 of vertices on cubics, beside degree 2, double, and positions that move first.

/// Bounds of the largest errors of schemes, beside dense sampling.
void run_certificates(Suite& suite, const Size& size);

/// Cones, bounds of clusters and means over a segment, beside samples.
void run_cones(Suite& suite, const Size& size);

/// Blend shapes: many sparse ones, a few active at once, and few that move everything.
void run_blend(Suite& suite, const Size& size);

/// What holds over a whole segment: collapse, facing.
void run_uses(Suite& suite, const Size& size);
/// Points that go through the surface.
void run_containment(Suite& suite, const Size& size);

/// How good a scheme is, to be held against what it costs.
struct SchemeQuality {
  std::string scheme, mesh;
  double mean_degrees = 0, max_degrees = 0;
  double bytes = 0;  ///< an element
};
[[nodiscard]] std::vector<SchemeQuality> scheme_qualities();
[[nodiscard]] std::vector<std::string> benchmark_schemes();

/// How far a path is off, over all elements and many t.
struct Accuracy {
  std::string path, mesh, elements;
  double bound = 0;  ///< what is promised, radians
  double mean = 0, share_9999 = 0, max = 0;
  std::size_t samples = 0;  ///< (element, t) pairs
  double bytes = 0;         ///< an element; 0: none are kept
};
/// Throws std::runtime_error where a path breaks its promise.
[[nodiscard]] std::vector<Accuracy> measure_accuracy(const Suite& suite);

}  // namespace chronormal::bench

#endif  // BENCH_GROUPS_GROUPS_H_
