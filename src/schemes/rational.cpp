// The scheme rational: the cross product as a function of t, with its normalisation in the formula (eq. 3 of the
// paper). The normal is three quadratics over the square root of one quartic, |n(t)|^2, whose coefficients are
// prepared. The prepared quartic saves a sum of squares in each evaluation, but has five more coefficients to read. The
// direction is that of the scheme polynomial, but is not computed in double where n(t) is small.

#include "chronormal/core/polynomial.h"
#include "schemes/curve_scheme.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

// The length that a control normal at an end gets if it vanishes, where the longest control normal has length 1. This
// length is below the rounding of float32, but its square is well above zero.
constexpr double kVanishingLength = 1e-7;

class Rational {
 public:
  [[nodiscard]] std::size_t plane_count() const { return 14; }  // n0, m, n1, and the five coefficients of the quartic

  void fit(ElementMotion& element, double* c) const {
    const ControlNormals& exact = element.control_normals();
    const double largest = maximum_number(length(exact.n0), maximum_number(length(exact.m), length(exact.n1)));
    const double scale = 1 / largest;
    // An end that vanishes, or nearly does, keeps its direction. The length kVanishingLength is so small that the end
    // only matters where the other control normals have no weight.
    const auto end = [scale](const Vec3d& n, const UnitNormal& u) {
      const Vec3d scaled = scale * n;
      return length(scaled) > kVanishingLength ? scaled : kVanishingLength * u.vector;
    };
    const Vec3d n0 = end(exact.n0, element.start()), m = scale * exact.m, n1 = end(exact.n1, element.end());
    put_vector(c, 0, n0);
    put_vector(c, 1, m);
    put_vector(c, 2, n1);
    const Bernstein<Vec3d, 2> n = {n0, m, n1};
    const Bernstein<double, 4> square = multiply(n, n, dot<double>);
    for (std::size_t k = 0; k < square.size(); ++k) c[9 + k] = square[k];
  }

  [[nodiscard]] Formula formula() const { return Formula::kRational; }
};

}  // namespace

std::unique_ptr<Scheme> make_rational() { return std::make_unique<CurveScheme<Rational>>(Rational{}); }

}  // namespace chronormal::inline internal
