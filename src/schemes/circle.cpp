// The schemes circle and circle:timed. They follow the circle through three exact normals, u0, u(1/2) and u1. This
// circle gives, in closed form, the frames with which quaternion slerp interpolates best (docs/theory.md, section 4.7).
//
//   circle         at constant speed
//   circle:timed   reaches the middle normal at t = 1/2 as well: t is replaced by r t / ((1-r)(1-t) + r t), where r is
//                  the share of the arc that lies before the middle; monotone for every r in (0, 1)
//
// If the three normals do not determine a circle (u1 = u0, or the middle normal is equal or opposite to an end), both
// schemes fall back to slerp.

#include "schemes/arc.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

struct ThroughMiddle {
  Arc arc;
  double share = 0.5;  // the share of the arc's angle that lies before the middle normal
};

ThroughMiddle circle_through_middle(ElementMotion& element) {
  const Vec3d u0 = element.start().vector, u1 = element.end().vector, middle = element.node(0.5);
  const Vec3d to_middle = middle - u0, to_end = u1 - u0;
  const Vec3d normal = cross(to_middle, to_end);

  // A circle needs three different points. On a short arc, the area of their triangle is tiny, of third order in the
  // length of the arc, so the sine of an angle of the triangle is tested and not the area.
  constexpr double kSmallestChord = 1e-12, kSmallestSine = 1e-10;
  const double chords = length(to_middle) * length(to_end);
  if (length(to_end) > kSmallestChord && length(middle + u0) > kSmallestChord &&
      length(normal) > kSmallestSine * chords && chords > 0) {
    Arc arc = arc_about(unit(normal), u0, 0);
    arc.angle = angle_along(arc, u1);
    const double middle_angle = angle_along(arc, middle);
    if (0 < middle_angle && middle_angle < arc.angle) return {arc, middle_angle / arc.angle};
  }
  // If the turn is too small for float32, nothing is lost without a circle, so such a turn does not count as a
  // fallback. Every other case without a circle counts as a fallback.
  constexpr double kInvisibleTurn = 1e-7;
  if (maximum_number(length(to_end), length(to_middle)) > kInvisibleTurn) element.use_fallback();
  const CircleFamily circles(u0, u1);
  return {circles.great_arc(), 0.5};
}

struct Circle : UniformArc {
  void fit(ElementMotion& element, double* c) const { put_arc(c, circle_through_middle(element).arc); }
};

struct TimedCircle {
  [[nodiscard]] std::size_t plane_count() const { return kArcPlanes + 1; }

  void fit(ElementMotion& element, double* c) const {
    const ThroughMiddle circle = circle_through_middle(element);
    put_arc(c, circle.arc);
    c[kArcPlanes] = circle.share;
  }

  [[nodiscard]] Formula formula() const { return Formula::kTimedCircleArc; }
};

}  // namespace

std::unique_ptr<Scheme> make_circle() { return std::make_unique<CurveScheme<Circle>>(Circle{}); }
std::unique_ptr<Scheme> make_timed_circle() { return std::make_unique<CurveScheme<TimedCircle>>(TimedCircle{}); }

}  // namespace chronormal::inline internal
