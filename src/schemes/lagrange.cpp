// Lagrange interpolation through the exact unit normals at K + 1 equidistant nodes, then normalised: linear is K = 1,
// quadratic 2, cubic 3 (section 2.2 of the paper).
//
// The weights L_k(t) are the same for all elements and are made once per t, in double; an element is a weighted sum.

#include <array>
#include <cmath>

#include "schemes/curve_scheme.h"
#include "schemes/makers.h"

namespace chronormal {
namespace {

// A degree that the compiler knows (kFixed > 0) lets it unroll and vectorise; 0 takes any at run time.
template <std::size_t kFixed>
class Lagrange {
 public:
  explicit Lagrange(std::size_t degree) : any_degree_(degree) {}

  [[nodiscard]] std::size_t plane_count() const { return 3 * (degree() + 1); }

  void fit(ElementMotion& element, double* c) const {
    put_vector(c, 0, element.start().vector);
    for (std::size_t k = 1; k < degree(); ++k) put_vector(c, k, element.node(node_time(k)));
    put_vector(c, degree(), element.end().vector);
  }

  template <class S>
  [[nodiscard]] std::array<S, kMaxLagrangeDegree + 1> at(double t) const {
    const auto exact = weights_at(t);
    std::array<S, kMaxLagrangeDegree + 1> weights;
    for (std::size_t k = 0; k <= degree(); ++k) weights[k] = S(static_cast<float>(exact[k]));
    return weights;
  }

  /// Where the sum vanishes (opposite ends meet in the middle) the result is the normal at t = 0.
  template <class S>
  [[nodiscard]] Vec3<S> evaluate(Coefficients<S> c, const std::array<S, kMaxLagrangeDegree + 1>& weights) const {
    Vec3<S> sum = weights[0] * c.vector(0);
    for (std::size_t k = 1; k <= degree(); ++k) sum = sum + weights[k] * c.vector(k);
    return normalized_or(sum, c.vector(0));
  }

  // Played by forward differences: K additions per component and step. Not beyond degree 3: differences of high order
  // are smaller than the rounding of float32.
  [[nodiscard]] std::size_t state_planes() const requires(kFixed > 0) { return 3 * (degree() + 1); }

  void anchor(Coefficients<float> c, double t, double step, double* state) const {
    std::array<Vec3d, kMaxLagrangeDegree + 1> differences;
    for (std::size_t j = 0; j <= degree(); ++j) {
      const auto weights = weights_at(t + static_cast<double>(j) * step);
      differences[j] = {};
      for (std::size_t k = 0; k <= degree(); ++k) differences[j] = differences[j] + weights[k] * to_double(c.vector(k));
    }
    for (std::size_t level = 0; level <= degree(); ++level) {
      put_vector(state, level, differences[0]);
      for (std::size_t j = 0; j + level < degree(); ++j) differences[j] = differences[j + 1] - differences[j];
    }
  }

  template <class S>
  [[nodiscard]] Vec3<S> advance(Coefficients<S> c, State<S> state) const {
    const Vec3<S> here = state.vector(0);
    Vec3<S> difference = here;
    for (std::size_t k = 0; k < degree(); ++k) {
      const Vec3<S> next = state.vector(k + 1);
      state.set_vector(k, difference + next);
      difference = next;
    }
    return normalized_or(here, c.vector(0));
  }

 private:
  [[nodiscard]] std::array<double, kMaxLagrangeDegree + 1> weights_at(double t) const {
    std::array<double, kMaxLagrangeDegree + 1> weights;
    const double x = t * static_cast<double>(degree());  // the nodes are 0, 1, ..., degree
    for (std::size_t k = 0; k <= degree(); ++k) {
      weights[k] = 1;
      for (std::size_t j = 0; j <= degree(); ++j) {
        if (j != k) weights[k] *= (x - static_cast<double>(j)) / (static_cast<double>(k) - static_cast<double>(j));
      }
    }
    return weights;
  }

  [[nodiscard]] double node_time(std::size_t k) const { return static_cast<double>(k) / static_cast<double>(degree()); }

  [[nodiscard]] std::size_t degree() const { return kFixed > 0 ? kFixed : any_degree_; }

  std::size_t any_degree_;
};

}  // namespace

std::unique_ptr<Scheme> make_lagrange(std::size_t degree) {
  switch (degree) {
    case 1:
      return std::make_unique<CurveScheme<Lagrange<1>>>(Lagrange<1>(degree));
    case 2:
      return std::make_unique<CurveScheme<Lagrange<2>>>(Lagrange<2>(degree));
    case 3:
      return std::make_unique<CurveScheme<Lagrange<3>>>(Lagrange<3>(degree));
    default:
      return std::make_unique<CurveScheme<Lagrange<0>>>(Lagrange<0>(degree));
  }
}

}  // namespace chronormal
