/// Bounds of clusters of faces of a deforming mesh, in the layout of meshoptimizer: made for one interval of time, and
/// right at every instant of it.
///
/// Engines cull meshlets of which no face can be seen from the front. meshopt_computeMeshletBounds() makes what that
/// test needs of a mesh that stands still. For a mesh that moves, the sphere must hold every vertex on its whole way,
/// the cone every normal on its, and the apex must stay behind the plane of every face: n(t).(p(t) - apex) >= 0, a
/// cubic in t whose Bernstein coefficients decide it. These are the tests of meshoptimizer.h, and none of them rejects
/// a cluster of which one face is front-facing from the camera at any instant of [t0, t1]:
///
///     dot(view, cone_axis) >= cone_cutoff                                                      orthographic
///     dot(normalize(cone_apex - camera), cone_axis) >= cone_cutoff                             perspective
///     dot(center - camera, cone_axis) >= cone_cutoff * length(center - camera) + radius        perspective, no apex
///
/// They may be computed in float32: cone_cutoff has 2^-20 for that. So do the forms of 8 bits, decoded as x / 127.
/// A cluster that can always be seen has the axis 0 and the cutoff 1 (127), and one that has no normal at any time, and
/// so nothing to be seen, the axis 0 and the cutoff 0.
///
/// Proof      docs/theory.md, section 20. For vertices on straight lines, p(t) = (1-t) p0 + t p1, without rounding; a
///            viewer that moves vertices in float32 shows faces that are edge on from either side, as it does anyhow.
/// Threads    pure, on the thread that calls.
/// Source     meshoptimizer 0.18, src/clusterizer.cpp; Shirman, Abi-Ezzi: The cone of normals technique (1993).
#ifndef CHRONORMAL_ANALYSIS_CLUSTER_BOUNDS_H_
#define CHRONORMAL_ANALYSIS_CLUSTER_BOUNDS_H_

#include <cstdint>
#include <span>

#include "chronormal/analysis/cones.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// The members of meshopt_Bounds, in their order.
struct ClusterBounds {
  float center[3] = {};  ///< a sphere around all vertices on their way
  float radius = 0;
  float cone_apex[3] = {};  ///< a point behind all faces at any instant
  float cone_axis[3] = {};
  float cone_cutoff = 0;  ///< the sine of the half-angle, and 2^-20
  std::int8_t cone_axis_s8[3] = {};
  std::int8_t cone_cutoff_s8 = 0;
};

/// Returns the bounds of some faces over [t0, t1]. Where their normals fill more than 84 degrees around any axis, the
/// cluster can always be seen. Cost: some 0.3 microseconds a face; allocates memory.
/// faces must lie inside the topology; 0 <= t0 <= t1 <= 1
[[nodiscard]] ClusterBounds cluster_bounds(const Segment& segment, std::span<const std::uint32_t> faces, double t0,
                                           double t1);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CLUSTER_BOUNDS_H_
