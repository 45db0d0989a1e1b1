/// Computes the signs that decide whether a moving point crosses a moving triangle. The signs are exact, and are not
/// zero in special positions.
///
/// The corners a, b, c of the triangle, relative to the point, move on straight lines. Two kinds of polynomials in t
/// decide whether the point crosses the triangle:
///
///     volume     V(t) = a . (b x c)                 cubic; zero if the point is in the plane of the triangle
///     side       S_ab(t) = a_x b_y - a_y b_x        quadratic, one for each edge; all three have the same sign if the
///                                                   line through the point along z meets the triangle
///
/// Sides may be taken along any axis along which the normal n(t) is not zero throughout: if the point is in the plane
/// of the triangle, it is between the edges if and only if the line meets the triangle. V changes from - to + when the
/// point leaves the side to which the normal points. A polynomial over a cell [t0, t1] of time is judged by the signs
/// of its Bernstein coefficients, which are polynomials in the corners at t0 and t1: without a change of sign the
/// polynomial has no root, and with one change of sign it has exactly one root (Descartes).
///
/// Ties       A point may go exactly through an edge, or stay in a plane. So all signs are computed as if the point
///            were moved by e = (e1, e2, e3), infinitely small with e1 >> e2 >> e3 > 0 (simulation of simplicity):
///                V - e . n(t)   and   S_ab - e1 (b - a)_y + e2 (b - a)_x
///            The first term that is not zero decides. A sign is 0 only if the triangle then has no area.
/// Numbers    Signs are computed in double with a bound of the rounding error; if double is not enough, in integers of
///            any size (core/wide_integer.h), from the floats and their residuals. Times are multiples of 2^-48.
///
/// Source: Edelsbrunner, Muecke, Simulation of Simplicity (1990); for the cubic, Provot, Collision and self-collision
/// handling (1997).
#ifndef CHRONORMAL_ANALYSIS_CONTAINMENT_CROSSING_SIGNS_H_
#define CHRONORMAL_ANALYSIS_CONTAINMENT_CROSSING_SIGNS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// A time within a segment, in units of 2^-48 of the segment, from 0 to kTicks.
using Tick = std::int64_t;
inline constexpr int kTickBits = 48;
inline constexpr Tick kTicks = Tick{1} << kTickBits;

/// A piece of time within a segment; if from == to, the piece is a moment.
struct Cell {
  Tick from = 0, to = kTicks;
};

/// A point that moves on a straight line through a segment.
struct MovingPoint {
  Vec3f from, to;
  Vec3d from_residual = {}, to_residual = {};  ///< the remainders of the rounding to float (motion/segment_end.h)
};

/// The answer to the question whether the point crosses a triangle during a cell of time.
struct Verdict {
  enum Kind {
    kNothing,   ///< the point does not cross the triangle
    kCrossing,  ///< the point crosses the triangle once
    kOpen       ///< the cell of time is too long to tell
  };
  Kind kind = kNothing;
  int change = 0;  ///< the sign of the volume after a crossing; the winding number changes by this number
};

class CrossingSigns {
 public:
  CrossingSigns(const std::array<MovingPoint, 3>& corners, const MovingPoint& point) noexcept;

  /// Returns true if all corners stay on the same side of the point along one axis, so that the point cannot cross the
  /// triangle.
  [[nodiscard]] bool is_beside() const noexcept;

  /// Tells whether the point crosses the triangle during a cell of time. `axis` (0, 1 or 2) is the axis along which
  /// sides are taken.
  [[nodiscard]] Verdict judge(std::size_t axis, const Cell& cell) const noexcept;

  /// Returns the number that the triangle adds to the winding number at a moment. This number is 1 if the half-line
  /// from the point along the axis leaves the mesh through the triangle, -1 if the half-line enters the mesh, and
  /// otherwise 0.
  [[nodiscard]] int crossing_of_ray(std::size_t axis, Tick t) const noexcept;

  /// Returns the sign of the volume V at a moment, which tells on which side of the triangle's plane the point is.
  [[nodiscard]] int volume_at(Tick t) const noexcept;

  /// Returns the Bernstein coefficients of the volume V over a cell of time, to the precision of double.
  [[nodiscard]] Bernstein<double, 3> rounded_volume(const Cell& cell) const noexcept;

 private:
  using Seen = std::array<double, 3>;
  using Corners = std::array<Seen, 3>;
  [[nodiscard]] Corners corners_at(Tick t) const noexcept;

  std::array<MovingPoint, 3> corners_;
  MovingPoint point_;
  Corners from_, to_;  // the corners relative to the point at both ends of the segment, rounded to double
  Seen side_bound_{};  // bounds of the rounding errors of sides, by axis
  double volume_bound_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CONTAINMENT_CROSSING_SIGNS_H_
