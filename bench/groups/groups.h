/// Declares the groups of measurements. Each group has a file of its own.
#ifndef BENCH_GROUPS_GROUPS_H_
#define BENCH_GROUPS_GROUPS_H_

#include <string>
#include <vector>

#include "measure/suite.h"
#include "paths/ours.h"

namespace chronormal::bench {

void run_faces(Suite& suite, const Size& size);
void run_vertices(Suite& suite, const Size& size);
/// Measures how long unit normals take on meshes other than the torus: thin triangles, varied valence, a sphere that
/// collapses, and meshes by other people in CHRONORMAL_DATA (a dance, a human face).
void run_meshes(Suite& suite);
/// Measures how long every scheme takes, both at one arbitrary t and in playback with small steps.
void run_schemes(Suite& suite, const Size& size);

/// Measures how long it takes to compute certificates of the largest errors of schemes, and, for comparison, to sample
/// these errors densely.
void run_certificates(Suite& suite, const Size& size);

/// Measures how long it takes to compute normal cones, bounds of clusters of faces, and mean normals for a whole
/// segment, and, for comparison, to sample the normals.
void run_cones(Suite& suite, const Size& size);

/// Measures how long normals of blend shapes take: many sparse targets with a few active at once, and few targets that
/// move every vertex.
void run_blend(Suite& suite, const Size& size);

/// Measures how long queries about a whole segment take: when faces collapse, and from which side a viewer sees them.
void run_uses(Suite& suite, const Size& size);
/// Measures how fast all crossings of moving points through the surface of a deforming mesh are found.
void run_containment(Suite& suite, const Size& size);

/// The angular errors of a scheme in degrees, and its memory: one row of the table of quality against cost.
struct SchemeQuality {
  std::string scheme, mesh;
  double mean_degrees = 0, max_degrees = 0;
  double bytes = 0;  ///< bytes of prepared data for each element
};
[[nodiscard]] std::vector<SchemeQuality> scheme_qualities();
[[nodiscard]] std::vector<std::string> benchmark_schemes();

/// The errors of a path (a way to compute normals) in radians, over all elements and many t, and its memory.
struct Accuracy {
  std::string path, mesh, elements;
  double bound = 0;                          ///< the bound that the path promises, in radians
  double mean = 0, share_9999 = 0, max = 0;  ///< 99.99 % of the errors are at most share_9999
  std::size_t samples = 0;                   ///< number of pairs of an element and a t
  double bytes = 0;                          ///< bytes of prepared data for each element; 0 if the path keeps none
};
/// Measures the accuracy of all paths. Throws std::runtime_error if a path exceeds the error that it promises.
[[nodiscard]] std::vector<Accuracy> measure_accuracy(const Suite& suite);

}  // namespace chronormal::bench

#endif  // BENCH_GROUPS_GROUPS_H_
