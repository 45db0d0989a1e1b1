/// Arcs of circles on the unit sphere, for slerp, quaternion slerp and the circle schemes.
///
/// A rotation about a fixed axis at constant speed takes u0 along a circle,
///     u(t) = w + cos(t A) p + sin(t A) q,   w = (axis . u0) axis,  p = u0 - w,  q = axis x u0        (eq. 7)
/// Quaternion slerp between two frames is such a rotation, so at run time an evaluation needs one sine with its cosine
/// and six multiplications and additions, and no quaternion. On a great circle w = 0, which is vector slerp.
#ifndef CHRONORMAL_SCHEMES_ARC_H_
#define CHRONORMAL_SCHEMES_ARC_H_

#include <cmath>

#include "chronormal/core/vec3.h"
#include "core/portable_math.h"
#include "schemes/curve_scheme.h"

namespace chronormal::inline internal {

struct Arc {
  Vec3d w, p, q;
  double angle = 0;  ///< A in radians, from u0 to u1 counter-clockwise about the axis, in [0, 2 pi]

  [[nodiscard]] Vec3d at(double t) const { return w + portable::cos(t * angle) * p + portable::sin(t * angle) * q; }
};

inline constexpr double kPi = 3.14159265358979323846;

/// Returns the arc on which u0 turns by an angle in radians about a unit axis.
[[nodiscard]] inline Arc arc_about(const Vec3d& axis, const Vec3d& u0, double angle) {
  const Vec3d w = dot(axis, u0) * axis;
  return {w, u0 - w, cross(axis, u0), angle};
}

/// Returns the angle in radians from the start of the arc to v, counter-clockwise about the axis of the arc, in [0, 2
/// pi).
[[nodiscard]] inline double angle_along(const Arc& arc, const Vec3d& v) {
  const double angle = portable::atan2(dot(arc.q, v), dot(arc.p, v));
  return angle < 0 ? angle + 2 * kPi : angle;
}

/// All circles through u0 and u1. A circle is given by one angle phi, which determines its axis: axis(phi) = cos(phi)
/// pole + sin(phi) bisector (eq. 6).
struct CircleFamily {
  Vec3d u0, u1;
  Vec3d pole;      ///< axis of the great circle, which slerp follows: phi = 0
  Vec3d bisector;  ///< unit(u0 + u1), the axis about which u0 reaches u1 by half a turn: phi = pi / 2
  enum class Kind {
    kGeneral,
    kEqual,      ///< u0 = u1; every arc of the family stays at this point
    kAntipodal,  ///< u1 = -u0; the pole is a fixed perpendicular of u0, and every circle is a great circle
  } kind;

  CircleFamily(const Vec3d& start, const Vec3d& end) : u0(start), u1(end) {
    // The sine of the angle between u0 and u1 below which the direction of u0 x u1 is mostly rounding error.
    constexpr double kSmallestSine = 1e-10;
    const Vec3d normal = cross(u0, u1);
    if (length(normal) > kSmallestSine) {
      kind = Kind::kGeneral;
      pole = unit(normal);
      bisector = dot(u0, u1) > 0 ? unit(u0 + u1) : cross(unit(u1 - u0), pole);
      if (dot(bisector, u0) < 0) bisector = -bisector;
    } else {
      kind = dot(u0, u1) > 0 ? Kind::kEqual : Kind::kAntipodal;
      pole = any_perpendicular(u0);
      bisector = cross(pole, u0);
    }
  }

  /// Returns the arc from u0 to u1 about axis(phi). The arc turns by at most half a turn for phi in [-pi/2, pi/2], and
  /// by more for other phi.
  [[nodiscard]] Arc arc(double phi) const {
    if (kind == Kind::kEqual) return {{}, u0, {}, 0};
    Arc arc = arc_about(portable::cos(phi) * pole + portable::sin(phi) * bisector, u0, 0);
    arc.angle = angle_along(arc, u1);
    return arc;
  }

  /// Returns the phi for which axis(phi) is the given axis, which should have the same angle to u0 as to u1.
  [[nodiscard]] double phi_of(const Vec3d& axis) const { return portable::atan2(dot(axis, bisector), dot(axis, pole)); }

  /// Returns the arc for phi = 0, which is vector slerp. If the ends are equal, the arc stays there; antipodal ends
  /// turn about a fixed perpendicular.
  [[nodiscard]] Arc great_arc() const { return arc(0); }
};

/// The number of planes of the state with which an arc at uniform speed is played. The planes are the cosine and sine
/// of the current angle, and the cosine and sine of the angle of one step.
inline constexpr std::size_t kTurnPlanes = 4;

inline void put_turn(double* state, double angle, double step_angle) {
  state[0] = portable::cos(angle);
  state[1] = portable::sin(angle);
  state[2] = portable::cos(step_angle);
  state[3] = portable::sin(step_angle);
}

/// The number of planes of an arc: three each for w, p and q, and one for A.
inline constexpr std::size_t kArcPlanes = 10;

inline void put_arc(double* c, const Arc& arc) {
  put_vector(c, 0, arc.w);
  put_vector(c, 1, arc.p);
  put_vector(c, 2, arc.q);
  c[9] = arc.angle;
}

/// The members that all schemes with arcs at uniform speed share (curve_scheme.h). Each scheme adds its own fit().
struct UniformArc {
  [[nodiscard]] std::size_t plane_count() const { return kArcPlanes; }

  [[nodiscard]] Formula formula() const { return Formula::kCircleArc; }

  [[nodiscard]] std::size_t state_planes() const { return kTurnPlanes; }
  void anchor(ElementCoefficients c, double t, double step, double* state) const {
    put_turn(state, t * static_cast<double>(c[9]), step * static_cast<double>(c[9]));
  }
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_ARC_H_
