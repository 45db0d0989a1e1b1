/// Normal cones: circular cones that contain the normals of an element over a whole interval of time.
///
/// Over [t0, t1] the curve n(t) has three control normals of its own (eq. 5 of docs/theory.md, restricted), and every
/// n(t) is a convex combination of them. A circular cone of at most 90 degrees around its axis is convex, so one that
/// contains the three contains every normal between. (A cone of the two end normals does not.)
///
/// A cone is four floats, made for the test of back-face culling. With d a direction of view, from the eye into the
/// scene,
///
///     dot(d, axis) >= sine * length(d)   ->   every normal n of the cone has dot(d, n) >= 0: no front face is in it
///
/// The whole sphere is the axis 0 with the sine 1, which never passes that test; the empty cone, of an element that has
/// no normal at any time, is the axis 0 with the sine 0, which always does. Wider cones than 90 degrees are the whole
/// sphere.
///
/// Proof      Cones contain every exact n(t), and not only the rounded one: control normals are taken to be within
///            2^-26 of their length, as face_control_normals() makes them, and all rounding of the cone itself is
///            added. What this adds to the half-angle is about 3e-7 rad, and 1e-6 of its sine. (docs/theory.md, section
///            20)
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

/// A set of directions around an axis. Except for the two special cones, the axis has a length of 1, as near as float32
/// can be; the cone is around the direction of these very floats.
struct NormalCone {
  Vec3f axis;
  float sine = 0;  ///< of the half-angle, from 0 to 1

  [[nodiscard]] static constexpr NormalCone empty() noexcept { return {{}, 0}; }
  [[nodiscard]] static constexpr NormalCone whole_sphere() noexcept { return {{}, 1}; }
  [[nodiscard]] constexpr bool is_empty() const noexcept { return axis == Vec3f{} && sine < 1; }
  [[nodiscard]] constexpr bool is_whole_sphere() const noexcept { return axis == Vec3f{} && sine >= 1; }
  friend constexpr bool operator==(const NormalCone&, const NormalCone&) = default;
};

/// Returns the half-angle in radians: up to pi / 2, pi for the whole sphere, and 0 for the empty cone.
[[nodiscard]] double half_angle(const NormalCone& cone) noexcept;

/// Writes the cone of each element over [t0, t1]. Where a control normal of a part of the segment nearly vanishes, so
/// that double cannot say where it points, the cone of the whole segment is written. Cost: a few nanoseconds an
/// element. result must have as many elements as normals; 0 <= t0 <= t1 <= 1
void normal_cones(std::span<const ControlNormals> normals, double t0, double t1, std::span<NormalCone> result) noexcept;

/// Writes the cones of a range of faces over [t0, t1], from positions: where double cannot say where a control normal
/// points, integers do. Cost: that of the control normals, and a few nanoseconds a face.
/// result must have faces.count elements; faces must lie inside the topology; 0 <= t0 <= t1 <= 1
void face_normal_cones(const Segment& segment, IndexRange faces, double t0, double t1,
                       std::span<NormalCone> result) noexcept;

/// Returns the cone of the normal of a vertex or corner, the sum of these faces (NormalGroups::faces()), always from
/// integers: some microseconds for each face. The same conditions.
[[nodiscard]] NormalCone normal_cone_of_faces(const Segment& segment, std::span<const std::uint32_t> faces, double t0,
                                              double t1) noexcept;

/// Returns a cone that contains all of these: that of a cluster from its faces, of a node from its children, of a face
/// from several segments. Empty ones do not count; the cone of none is empty. It is near the smallest one (a few
/// percent wider), and each level of a hierarchy adds about 1e-7 rad of rounding. Cost: 11 passes over the cones.
[[nodiscard]] NormalCone enclosing_cone(std::span<const NormalCone> cones) noexcept;

// The bounds of clusters of faces of a deforming mesh, in the layout of meshoptimizer. They are made for one interval
// of time, and are right at every instant of it.
//
// Engines cull meshlets of which no face can be seen from the front. meshopt_computeMeshletBounds() makes what that
// test needs of a mesh that stands still. For a mesh that moves, the sphere must hold every vertex on its whole way,
// the cone every normal on its, and the apex must stay behind the plane of every face: n(t).(p(t) - apex) >= 0, a
// cubic in t whose Bernstein coefficients decide it. These are the tests of meshoptimizer.h, and none of them rejects
// a cluster of which one face is front-facing from the camera at any instant of [t0, t1]:
//
//     dot(view, cone_axis) >= cone_cutoff                                                      orthographic
//     dot(normalize(cone_apex - camera), cone_axis) >= cone_cutoff                             perspective
//     dot(center - camera, cone_axis) >= cone_cutoff * length(center - camera) + radius        perspective, no apex
//
// They may be computed in float32: cone_cutoff has 2^-20 for that. So do the forms of 8 bits, decoded as x / 127.
// A cluster that can always be seen has the axis 0 and the cutoff 1 (127), and one that has no normal at any time, and
// so nothing to be seen, the axis 0 and the cutoff 0.
//
// Proof      docs/theory.md, section 20. For vertices on straight lines, p(t) = (1-t) p0 + t p1, without rounding; a
//            viewer that moves vertices in float32 shows faces that are edge on from either side, as it does anyhow.
// Threads    pure, on the thread that calls.
// Source     meshoptimizer 0.18, src/clusterizer.cpp; Shirman, Abi-Ezzi: The cone of normals technique (1993).

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

// Averages normals over an open shutter: the mean of n(t), and the mean of the unit normal n(t) / |n(t)|, over an
// interval of time.
//
// A renderer with motion blur sees every instant of [t0, t1] and shows their mean. What it should store as the normal
// of a pixel, or shade with where it shades once, is the mean of the unit normal, and not the normal in the middle or
// half way between the ends:
//
//     mean        1 / (t1 - t0) integral of n(t) dt             a third of the three control normals of [t0, t1], exactly
//     mean_unit   1 / (t1 - t0) integral of n(t) / |n(t)| dt    an elliptic integral; here to a bound that is proven
//
// The first weighs instants by the area of the face at each (half of it is the mean vector area), the second does not.
// The length of mean_unit says how far normals spread: 1 where they are all the same, 0 where they cancel.
//
// Proof      Gauss's rule with 8 nodes on pieces in which |n(z)|^2 has no zero for complex z nearby, so that the unit
//            normal is analytic there and the error is known (docs/theory.md, section 21). Around an instant at which
//            n(t) = 0, pieces are halved until they are 2^-28 of the interval, and count as error.
// Threads    pure, on the thread that calls: no allocation, no throw, the same bits everywhere.

struct ShutterNormal {
  Vec3d mean;       ///< of n(t); for triangles twice the mean vector area
  Vec3d mean_unit;  ///< of n(t) / |n(t)|; zero where n is zero all the time
  double error =
      0;  ///< the exact mean of the unit normal is within this of mean_unit; some 1e-7 where nothing collapses
};

/// Returns the means over [t0, t1]. Control normals are taken to be within 2^-26 of their length, and that is in the
/// error. Cost: about 0.2 microseconds where normals turn little, more where n(t) comes near zero.
/// 0 <= t0 <= t1 <= 1; where both are the same, the means are the normals at that instant
[[nodiscard]] ShutterNormal shutter_normal(const ControlNormals& normals, double t0, double t1) noexcept;

/// Writes the means of a range of faces over [t0, t1], from positions; if control normals of the interval cancel,
/// integers compute them. result must have faces.count elements; faces must lie inside the topology; 0 <= t0 <= t1 <= 1
void face_shutter_normals(const Segment& segment, IndexRange faces, double t0, double t1,
                          std::span<ShutterNormal> result) noexcept;

/// Returns the means of a vertex or corner, whose normal is the sum of these faces (NormalGroups::faces()), always from
/// integers: some microseconds for each face. The same conditions.
[[nodiscard]] ShutterNormal shutter_normal_of_faces(const Segment& segment, std::span<const std::uint32_t> faces,
                                                    double t0, double t1) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CONES_H_
