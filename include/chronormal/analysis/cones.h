/// Normal cones: circular cones that contain the normals of an element over a whole interval of time.
///
/// The part of the curve n(t) over [t0, t1] has three control normals of its own (eq. 5 of docs/theory.md, restricted
/// to the interval), and every n(t) of the interval is a convex combination of these three vectors. A circular cone
/// with a half-angle of at most 90 degrees is convex. If such a cone contains the three control normals, the cone
/// contains every normal of the interval. (A cone around the normals at t0 and t1 may miss normals in between.)
///
/// A cone is four floats, made for the test of back-face culling. For a direction of view d, from the eye into the
/// scene,
///
///     dot(d, axis) >= sine * length(d)   =>   every normal n of the cone has dot(d, n) >= 0: no face with such
///                                        a normal is front-facing
///
/// The whole sphere is the axis 0 with the sine 1, which never passes this test. An element that has no normal at any
/// time has the empty cone, which is the axis 0 with the sine 0 and always passes. Cones with a half-angle above 90
/// degrees become the whole sphere.
///
/// Proof      Cones contain every exact n(t), and not only the rounded one: control normals are assumed to have
///            relative errors of at most 2^-26, as face_control_normals() guarantees, and the rounding of the cone
///            itself is added. This increases the sine of the half-angle by about 3e-7, plus 1e-6 of the sine
///            itself (docs/theory.md, section 20).
/// Zero       Control normals that are zero are left out: n(t) is a combination of the others.
/// Threads    pure, on the thread that calls: no allocation, no throw, the same bits on every instruction set.
/// Source     Tang, Curtis, Yoon, Manocha: ICCD (2009), for the control normals and cones of them; Tang, Manocha, Tong:
///            Fast continuous collision detection using deforming non-penetration filters (2010); Shirman, Abi-Ezzi:
///            The cone of normals technique (1993).
#ifndef CHRONORMAL_ANALYSIS_CONES_H_
#define CHRONORMAL_ANALYSIS_CONES_H_

#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

/// A set of directions around an axis. The axis is a unit vector up to float32 rounding, or zero in the two special
/// cones, which are the whole sphere and the empty cone. The centre of the cone is the exact direction of the three
/// floats of `axis`.
struct NormalCone {
  Vec3f axis;
  float sine = 0;  ///< sine of the half-angle, from 0 to 1

  [[nodiscard]] static constexpr NormalCone empty() noexcept { return {{}, 0}; }
  [[nodiscard]] static constexpr NormalCone whole_sphere() noexcept { return {{}, 1}; }
  [[nodiscard]] constexpr bool is_empty() const noexcept { return axis == Vec3f{} && sine < 1; }
  [[nodiscard]] constexpr bool is_whole_sphere() const noexcept { return axis == Vec3f{} && sine >= 1; }
  friend constexpr bool operator==(const NormalCone&, const NormalCone&) = default;
};

/// Returns the half-angle of a cone in radians: pi for the whole sphere, 0 for the empty cone, and at most pi / 2 for
/// every other cone.
[[nodiscard]] double half_angle(const NormalCone& cone) noexcept;

/// Writes the cone of each element over the times [t0, t1]. If a control normal of the interval nearly vanishes, so
/// that double cannot determine its direction, the cone of the whole segment is written instead. Cost: a few
/// nanoseconds per element. Preconditions: result has as many elements as normals; 0 <= t0 <= t1 <= 1.
void normal_cones(std::span<const ControlNormals> normals, double t0, double t1, std::span<NormalCone> result) noexcept;

/// Writes the cones of a range of faces over the times [t0, t1], computed from positions. If double cannot determine
/// the direction of a control normal, integer arithmetic does. Cost: that of the control normals, plus a few
/// nanoseconds per face. Preconditions: result has faces.count elements; the faces exist in the topology; 0 <= t0 <= t1
/// <= 1.
void face_normal_cones(const Segment& segment, IndexRange faces, double t0, double t1,
                       std::span<NormalCone> result) noexcept;

/// Returns the cone, over the times [t0, t1], of a vertex or corner whose normal is the sum of the normals of the given
/// faces (NormalGroups::faces()). Always computes with integers, which takes some microseconds for each face.
/// Preconditions: the faces exist in the topology; 0 <= t0 <= t1 <= 1.
[[nodiscard]] NormalCone normal_cone_of_faces(const Segment& segment, std::span<const std::uint32_t> faces, double t0,
                                              double t1) noexcept;

/// Returns a cone that contains all the given cones. Callers use it for a cluster with the cones of its faces, for a
/// node of a hierarchy with the cones of its children, or for a face with its cones of several segments. Empty cones
/// are ignored; if all cones are empty, the result is empty. The result is a few percent wider than the smallest
/// possible cone, and each level of a hierarchy adds about 1e-7 rad of rounding. Cost: 11 passes over the cones.
[[nodiscard]] NormalCone enclosing_cone(std::span<const NormalCone> cones) noexcept;

// The bounds of clusters of faces of a deforming mesh, in the layout of meshoptimizer. They are computed for an
// interval of time, and are valid at every instant of it.
//
// Engines cull meshlets that show no face from the front. meshopt_computeMeshletBounds() computes the bounds for this
// test for a mesh at rest. For a moving mesh, the sphere must contain every vertex on its whole path, and the cone must
// contain every normal. The apex must stay behind the plane of every face: n(t).(p(t) - apex) >= 0, a cubic in t that
// is decided by its Bernstein coefficients. With these bounds, none of the tests of meshoptimizer.h rejects a cluster
// with a face that is front-facing from the camera at any instant of [t0, t1]:
//
//     dot(view, cone_axis) >= cone_cutoff                                                      orthographic
//     dot(normalize(cone_apex - camera), cone_axis) >= cone_cutoff                             perspective
//     dot(center - camera, cone_axis) >= cone_cutoff * length(center - camera) + radius        perspective, no apex
//
// The tests may be computed in float32, because cone_cutoff includes 2^-20 for their rounding. The 8-bit form of the
// cutoff, which is decoded as x / 127, includes 2^-20, too. A cluster that must never be culled has the axis 0 and the
// cutoff 1 (127). A cluster without a normal at any time, which shows nothing, has the axis 0 and the cutoff 0.
//
// Proof      docs/theory.md, section 20. The proof is for vertices exactly on straight lines, p(t) = (1-t) p0 + t p1. A
//            renderer that moves vertices in float32 may draw either side of faces that are edge-on, with or without
//            culling.
// Threads    pure, on the thread that calls.
// Source     meshoptimizer 0.18, src/clusterizer.cpp; Shirman, Abi-Ezzi: The cone of normals technique (1993).

/// The bounds of a cluster of faces: the members of meshoptimizer's meshopt_Bounds, in the same order.
struct ClusterBounds {
  float center[3] = {};  ///< center and radius: a sphere that contains the whole path of every vertex
  float radius = 0;
  float cone_apex[3] = {};  ///< a point that is behind the planes of all faces at every instant of the interval
  float cone_axis[3] = {};
  float cone_cutoff = 0;  ///< the sine of the half-angle of the normals' cone, plus 2^-20
  std::int8_t cone_axis_s8[3] = {};
  std::int8_t cone_cutoff_s8 = 0;
};

/// Returns the bounds of some faces over the times [t0, t1]. If no cone with a half-angle of 84 degrees contains their
/// normals, the bounds never let a program cull the cluster. Cost: about 0.3 microseconds per face. Allocates memory.
/// Preconditions: the faces exist in the topology; 0 <= t0 <= t1 <= 1.
[[nodiscard]] ClusterBounds cluster_bounds(const Segment& segment, std::span<const std::uint32_t> faces, double t0,
                                           double t1);

// Averages normals over an open shutter: the mean of n(t), and the mean of the unit normal n(t) / |n(t)|, over an
// interval of time.
//
// A renderer with motion blur averages all instants of [t0, t1]. If the renderer stores one normal for a pixel, or
// shades the pixel only once, this normal should be the mean of the unit normal. The normal at the middle of the
// interval, or halfway between the end normals, is another vector in general. The two means are
//
//     mean        1 / (t1 - t0) integral of n(t) dt             exactly a third of the sum of the three control
//                                                               normals of [t0, t1]
//     mean_unit   1 / (t1 - t0) integral of n(t) / |n(t)| dt    an elliptic integral, computed within a proven bound
//
// `mean` weights instants by the area of the face (half of `mean` is the mean vector area); `mean_unit` does not. The
// length of mean_unit measures the spread of the normals: 1 if they are all equal, 0 if they cancel.
//
// Proof      Gauss's rule with 8 nodes on pieces in which |n(z)|^2 has no zero for complex z nearby, so that the unit
//            normal is analytic there and the error is known (docs/theory.md, section 21). Pieces with an instant at
//            which n(t) = 0 are halved until they are 2^-28 of the interval. The integral over these last pieces counts
//            as error.
// Threads    pure, on the thread that calls: no allocation, no throw, the same bits everywhere.

struct ShutterNormal {
  Vec3d mean;       ///< mean of n(t), in squared units of length; for triangles twice the mean vector area
  Vec3d mean_unit;  ///< mean of n(t) / |n(t)|; zero if n is zero at all times
  /// A bound of the distance between mean_unit and its exact value. The bound is about 1e-7 if n(t) stays away from
  /// zero.
  double error = 0;
};

/// Returns the mean of the normal and the mean of the unit normal over the times [t0, t1]. Assumes that control normals
/// have a relative error of at most 2^-26, and includes this error in `error`. If t0 and t1 are equal, the means are
/// the normals at that instant. Cost: about 0.2 microseconds if normals turn little, more if n(t) comes close to zero.
/// Precondition: 0 <= t0 <= t1 <= 1.
[[nodiscard]] ShutterNormal shutter_normal(const ControlNormals& normals, double t0, double t1) noexcept;

/// Writes the mean normals and the mean unit normals of a range of faces over the times [t0, t1], computed from
/// positions. If control normals of the interval cancel so far that double is not accurate enough, integer arithmetic
/// computes the means. Preconditions: result has faces.count elements; the faces exist in the topology; 0 <= t0 <= t1
/// <= 1.
void face_shutter_normals(const Segment& segment, IndexRange faces, double t0, double t1,
                          std::span<ShutterNormal> result) noexcept;

/// Returns the mean normal and the mean unit normal, over the times [t0, t1], of a vertex or corner whose normal is the
/// sum of the normals of the given faces (NormalGroups::faces()). Always computes with integers, which takes some
/// microseconds for each face. Preconditions: the faces exist in the topology; 0 <= t0 <= t1 <= 1.
[[nodiscard]] ShutterNormal shutter_normal_of_faces(const Segment& segment, std::span<const std::uint32_t> faces,
                                                    double t0, double t1) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CONES_H_
