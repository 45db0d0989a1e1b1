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

#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

/// A set of directions around an axis. What is not one of the two special cones has an axis of length 1, as near as
/// float32 can be; the direction of these very floats is what the cone is around.
struct NormalCone {
  Vec3f axis;
  float sine = 0;  ///< of the half-angle, from 0 to 1

  [[nodiscard]] static constexpr NormalCone empty() noexcept { return {{}, 0}; }
  [[nodiscard]] static constexpr NormalCone whole_sphere() noexcept { return {{}, 1}; }
  [[nodiscard]] constexpr bool is_empty() const noexcept { return axis == Vec3f{} && sine < 1; }
  [[nodiscard]] constexpr bool is_whole_sphere() const noexcept { return axis == Vec3f{} && sine >= 1; }
  friend constexpr bool operator==(const NormalCone&, const NormalCone&) = default;
};

/// The half-angle in radians: up to pi / 2, pi for the whole sphere, and 0 for the empty cone.
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

/// Returns a cone that contains all of these: that of a cluster from its faces, of a node from its children, of a face
/// from several segments. Empty ones do not count; the cone of none is empty. It is near the smallest one (a few
/// percent wider), and each level of a hierarchy adds about 1e-7 rad of rounding. Cost: 11 passes over the cones.
[[nodiscard]] NormalCone enclosing_cone(std::span<const NormalCone> cones) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CONES_H_
