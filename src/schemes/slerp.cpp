// The scheme slerp. It takes the shortest arc from u0 to u1 at constant speed (section 2.3 and eq. 5 of the paper).
//
// Let q be the unit vector perpendicular to u0 in the plane of u0 and u1, and T the angle between u0 and u1. Then u(t)
// = cos(t T) u0 + sin(t T) q is the same curve as (sin((1-t) T) u0 + sin(t T) u1) / sin T, but without the division
// that fails at T = 0 and T = pi. If the ends are equal, the curve stays there. Antipodal ends turn about a fixed
// perpendicular, and count as a fallback.

#include "schemes/arc.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

struct Slerp {
  [[nodiscard]] std::size_t plane_count() const { return 7; }  // u0, q and T

  void fit(ElementMotion& element, double* c) const {
    const CircleFamily circles(element.start().vector, element.end().vector);
    if (circles.kind == CircleFamily::Kind::kAntipodal) element.use_fallback();
    const Arc arc = circles.great_arc();
    put_vector(c, 0, arc.p);
    put_vector(c, 1, arc.q);
    c[6] = arc.angle;
  }

  [[nodiscard]] Formula formula() const { return Formula::kGreatArc; }

  // Returns how many numbers the curve of an element needs to be played step by step. Each step rotates the normal by
  // the same angle. The paper cites Barrera (2004) for such playback; the form that is used here drifts least.
  [[nodiscard]] std::size_t state_planes() const { return kTurnPlanes; }
  void anchor(ElementCoefficients c, double t, double step, double* state) const {
    put_turn(state, t * static_cast<double>(c[6]), step * static_cast<double>(c[6]));
  }
};

}  // namespace

std::unique_ptr<Scheme> make_slerp() { return std::make_unique<CurveScheme<Slerp>>(Slerp{}); }

}  // namespace chronormal::inline internal
